"""ROS recordings of every container: bags of ROS 1 and 2, MCAP with CDR, and what ``rostopic echo -p`` prints."""

import json
import struct

import numpy as np
import pytest
from mcap.writer import CompressionType, Writer
from rosbags.rosbag1 import Writer as Bag1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from harness.errors import InputError
from harness.recording import read_recording
from harness.recording.efforts import read_efforts
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

TIME = np.arange(100) * 0.005
START = 1_695_196_914_311_943_473
STAMPS = START + np.round(TIME * 1e9).astype(np.int64)
ANGLE = 0.7 * np.cos(3.0 * TIME)
SPEED = -2.1 * np.sin(3.0 * TIME)
EFFORT = 0.2 * np.sin(2.0 * TIME)
LATE = 3_000_000  # ns from stamp to logging


@pytest.fixture
def system():
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0, 1, 0]))
    return System("s", (pivot,), (Link("rod", 1.0),))


def cdr_joint_state(stamp, names, position, velocity, effort):
    """``sensor_msgs/JointState`` in CDR, little endian, put together by hand (OMG CDR: alignment from after the header)."""
    body = bytearray()

    def align(size):
        body.extend(b"\0" * (-len(body) % size))

    def text(word):
        align(4)
        body.extend(struct.pack("<I", len(word) + 1) + word.encode() + b"\0")

    body.extend(struct.pack("<iI", stamp // 10**9, stamp % 10**9))
    text("")
    body.extend(b"\0" * (-len(body) % 4) + struct.pack("<I", len(names)))
    for name in names:
        text(name)
    for array in (position, velocity, effort):
        align(4)
        body.extend(struct.pack("<I", len(array)))
        if len(array):
            align(8)
        body.extend(struct.pack(f"<{len(array)}d", *array))
    return b"\x00\x01\x00\x00" + bytes(body)


def states():
    """Joints in an order that changes, one of them foreign, and efforts that are not measured."""
    for k, stamp in enumerate(STAMPS):
        names = ["pivot", "gripper"] if k % 2 else ["gripper", "pivot"]
        position = [ANGLE[k], 0.1] if k % 2 else [0.1, ANGLE[k]]
        velocity = [SPEED[k], 0.0] if k % 2 else [0.0, SPEED[k]]
        yield int(stamp), names, position, velocity, [float("nan")] * 2


def mcap_by_hand(file):
    with file.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start("ros2")
        # Some recorders leave the definition empty; every ROS knows the type.
        schema = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", b"")
        channel = writer.register_channel("/joint_states", "cdr", schema)
        for stamp, *state in states():
            data = cdr_joint_state(stamp, *state)
            writer.add_message(channel, log_time=stamp + LATE, data=data, publish_time=stamp)
        writer.finish()


def message(store, stamp, names, position, velocity, effort, one=False):
    header = {"stamp": store.types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)}
    header |= {"frame_id": "", "seq": 0} if one else {"frame_id": ""}
    return store.types["sensor_msgs/msg/JointState"](
        header=store.types["std_msgs/msg/Header"](**header),
        name=names,
        position=np.array(position),
        velocity=np.array(velocity),
        effort=np.array(effort),
    )


def bag1(file):
    store = get_typestore(Stores.ROS1_NOETIC)
    with Bag1(file) as writer:
        connection = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for stamp, *state in states():
            data = store.serialize_ros1(message(store, stamp, *state, one=True), "sensor_msgs/msg/JointState")
            writer.write(connection, stamp + LATE, data)


def folder(path, plugin, compression=None):
    store = get_typestore(Stores.LATEST)
    writer = Bag2(path, version=9, storage_plugin=plugin)
    if compression is not None:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for stamp, *state in states():
            data = store.serialize_cdr(message(store, stamp, *state), "sensor_msgs/msg/JointState")
            writer.write(connection, stamp + LATE, data)


def rostopic(file):
    fields = ["name", "position", "velocity", "effort"]
    header = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id"]
    lines = [",".join(header + [f"field.{field}{k}" for field in fields for k in (0, 1)])]
    for k, (stamp, *state) in enumerate(states()):
        cells = [stamp + LATE, k, stamp, "", *(cell for array in state for cell in array)]
        lines.append(",".join(map(str, cells)))
    file.write_text("\n".join(lines) + "\n")


def containers(tmp_path):
    mcap_by_hand(tmp_path / "hand.mcap")
    bag1(tmp_path / "one.bag")
    folder(tmp_path / "two", StoragePlugin.SQLITE3)
    folder(tmp_path / "three", StoragePlugin.MCAP)
    folder(tmp_path / "packed", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    rostopic(tmp_path / "echo.csv")
    (tmp_path / "renamed").write_bytes((tmp_path / "two" / "two.db3").read_bytes())
    return ["hand.mcap", "one.bag", "two/two.db3", "two", "three/three.mcap", "three", "packed", "echo.csv", "renamed"]


def test_every_container_gives_the_same_recording(tmp_path, system):
    for name in containers(tmp_path):
        recording = read_recording(tmp_path / name, system=system)
        assert recording.channel_names == ("pivot.position", "pivot.velocity"), name
        assert not recording.efforts
        assert np.array_equal(recording.channel("pivot.position").values, ANGLE), name
        assert np.array_equal(recording.channel("pivot.velocity").values, SPEED), name
        assert np.allclose(recording.time, TIME, rtol=0.0, atol=1e-12), name
        # By the message's own stamp, not by when it was logged.
        assert recording.start == pytest.approx(START * 1e-9, abs=1e-6), name
        kinds = {note.kind for note in recording.quality}
        assert {"ignored_column", "empty_column"} <= kinds, name


def imu_and_strain(file):
    """An IMU, strains as an array, and a command that comes ten times more rarely, each topic at times of its own."""
    store = get_typestore(Stores.LATEST)
    types = store.types
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")

        def channel(topic, name):
            text, _ = store.generate_msgdef(name, ros_version=2)
            return writer.register_channel(topic, "cdr", writer.register_schema(name, "ros2msg", text.encode()))

        joints = channel("/joint_states", "sensor_msgs/msg/JointState")
        imu = channel("/tip/imu", "sensor_msgs/msg/Imu")
        strain = channel("/strain", "std_msgs/msg/Float64MultiArray")
        command = channel("/command", "std_msgs/msg/Float64MultiArray")
        picture = channel("/camera", "sensor_msgs/msg/Image")
        vector, layout = (
            types["geometry_msgs/msg/Vector3"],
            types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0),
        )
        header = types["std_msgs/msg/Header"]

        def at(stamp):
            return header(
                stamp=types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id=""
            )

        def add(to, stamp, name, value):
            writer.add_message(to, log_time=stamp, data=bytes(store.serialize_cdr(value, name)), publish_time=stamp)

        array = types["std_msgs/msg/Float64MultiArray"]
        for k, stamp in enumerate(map(int, STAMPS)):
            state = message(store, stamp, ["pivot"], [ANGLE[k]], [SPEED[k]], [])
            add(joints, stamp, "sensor_msgs/msg/JointState", state)
            reading = types["sensor_msgs/msg/Imu"](
                header=at(stamp + 1000),
                orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
                orientation_covariance=np.zeros(9),
                angular_velocity=vector(x=0.0, y=SPEED[k], z=0.0),
                angular_velocity_covariance=np.zeros(9),
                linear_acceleration=vector(x=2.0 * ANGLE[k], y=0.0, z=9.8),
                linear_acceleration_covariance=np.zeros(9),
            )
            add(imu, stamp + 5000, "sensor_msgs/msg/Imu", reading)
            add(
                strain,
                stamp,
                "std_msgs/msg/Float64MultiArray",
                array(layout=layout, data=np.array([0.0, 100.0 * ANGLE[k]])),
            )
            if k % 10 == 3:
                add(
                    command,
                    stamp + 2000,
                    "std_msgs/msg/Float64MultiArray",
                    array(layout=layout, data=np.array([float(k)])),
                )
            if k == 5:
                image = types["sensor_msgs/msg/Image"](
                    header=at(stamp),
                    height=10,
                    width=10,
                    encoding="mono8",
                    is_bigendian=0,
                    step=10,
                    data=np.zeros(100, np.uint8),
                )
                add(picture, stamp, "sensor_msgs/msg/Image", image)
        writer.finish()


@pytest.mark.parametrize(
    "spelling", ["/tip/imu/linear_acceleration/x", "/tip/imu.linear_acceleration.x", "linear_acceleration/x"]
)
def test_other_topics_by_the_map(tmp_path, system, spelling):
    imu_and_strain(tmp_path / "run.mcap")
    rules = [
        f"{spelling}=rod.tip_acceleration",
        "/strain/data[1]=rod.root_strain[microstrain]",
        "/command/data[0]=pivot.effort",
    ]
    recording = read_recording(tmp_path / "run.mcap", mapping=rules, system=system)
    assert set(recording.channel_names) == {
        "pivot.position", "pivot.velocity", "rod.tip_acceleration", "rod.root_strain",
    }  # fmt: skip

    def seen(name):
        values = recording.channel(name).values
        return values[np.isfinite(values)]

    assert np.array_equal(seen("pivot.position"), ANGLE)
    assert np.array_equal(seen("rod.tip_acceleration"), 2.0 * ANGLE)
    assert np.allclose(seen("rod.root_strain"), 1e-4 * ANGLE, rtol=1e-12)
    # A command acts until the next; before the first there is none.
    at_joint = recording.efforts[0].values[np.isfinite(recording.channel("pivot.position").values)]
    k = np.arange(100)
    assert np.array_equal(at_joint, np.where(k > 3, (k - 4) // 10 * 10 + 3, 0))
    (note,) = [note for note in recording.quality if note.kind == "other_clock"]
    assert note.channel == "pivot.effort" and "comes 10 times" in note.what


def test_a_command_of_a_bag_as_effort_file(tmp_path, system):
    imu_and_strain(tmp_path / "run.mcap")
    file = read_efforts(tmp_path / "run.mcap", system, mapping=["/command/data[0]=pivot.effort"])
    assert np.allclose(file.time, 0.05 * np.arange(10), rtol=0.0, atol=1e-9)
    assert np.array_equal(file.efforts[0].values, np.arange(3.0, 100.0, 10.0))


def json_states(file, topics):
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        for topic, sign in topics:
            schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
            channel = writer.register_channel(topic, "json", schema)
            for k, stamp in enumerate(map(int, STAMPS)):
                content = {"name": ["pivot"], "position": [sign * ANGLE[k]], "velocity": [None], "effort": []}
                writer.add_message(channel, log_time=stamp, data=json.dumps(content).encode(), publish_time=stamp)
        writer.finish()


def test_two_topics_of_one_joint(tmp_path, system):
    json_states(tmp_path / "run.mcap", [("/joint_states", 1.0), ("/desired", -1.0)])
    with pytest.raises(
        InputError, match=r"'/joint_states/pivot/position' and '/desired/pivot/position' are both pivot.position"
    ):
        read_recording(tmp_path / "run.mcap", system=system)
    recording = read_recording(tmp_path / "run.mcap", mapping=["/desired=ignore"], system=system)
    assert np.array_equal(recording.channels[0].values, ANGLE)


def test_a_type_of_ones_own_is_read_by_its_definition(tmp_path, system):
    definition = (
        "std_msgs/Header header\nfloat32 angle\nmine/Load[2] loads\n" + "=" * 80 + "\nMSG: mine/Load\nfloat64 torque\n"
    )
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(definition, "mine/msg/Rig"))
    types = store.types
    with (tmp_path / "run.mcap").open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        schema = writer.register_schema("mine/msg/Rig", "ros2msg", definition.encode())
        unknown = writer.register_schema("mine/msg/Other", "ros2msg", b"")
        channel, other = (
            writer.register_channel("/rig", "cdr", schema),
            writer.register_channel("/other", "cdr", unknown),
        )
        for k, stamp in enumerate(map(int, STAMPS)):
            header = types["std_msgs/msg/Header"](
                stamp=types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id="x"
            )
            loads = [types["mine/msg/Load"](torque=t) for t in (EFFORT[k], 0.0)]
            value = types["mine/msg/Rig"](header=header, angle=np.float32(ANGLE[k]), loads=loads)
            data = bytes(store.serialize_cdr(value, "mine/msg/Rig"))
            writer.add_message(channel, log_time=stamp, data=data, publish_time=stamp)
            writer.add_message(other, log_time=stamp, data=data, publish_time=stamp)
        writer.finish()
    rules = ["/rig/angle=pivot.position", "/rig/loads[0]/torque=pivot.effort"]
    recording = read_recording(tmp_path / "run.mcap", mapping=rules, system=system)
    assert np.array_equal(recording.channels[0].values, ANGLE.astype(np.float32).astype(np.float64))
    assert np.array_equal(recording.efforts[0].values, EFFORT)
    assert any("/other" in note.channel and "definition is not in the file" in note.what for note in recording.quality)


def test_damage_is_told(tmp_path, system):
    bag1(tmp_path / "one.bag")
    folder(tmp_path / "two", StoragePlugin.SQLITE3)
    mcap_by_hand(tmp_path / "hand.mcap")
    for name in ("one.bag", "two/two.db3", "hand.mcap"):
        whole = (tmp_path / name).read_bytes()
        (tmp_path / "half").write_bytes(whole[: len(whole) // 2])
        with pytest.raises(InputError, match="damaged"):
            read_recording(tmp_path / "half", system=system)


def test_what_rostopic_prints_goes_by_the_names_in_its_file(tmp_path, system):
    """A user sees ``field.effort0`` in the file, not the name that it is read by."""
    file = tmp_path / "echo.csv"
    fields = ["name", "position", "velocity", "effort"]
    lines = ["%time," + ",".join(f"field.{field}0" for field in fields)]
    lines += [f"{stamp},pivot,{a},{s},nan" for stamp, a, s in zip(STAMPS, ANGLE, SPEED, strict=True)]
    file.write_text("\n".join(lines) + "\n")
    recording = read_recording(file, system=system, mapping=["field.effort0=ignore", "field.velocity0=ignore"])
    assert recording.channel_names == ("pivot.position",)
    told = {note.channel for note in recording.quality if note.what == "is mapped to ignore"}
    assert told == {"field.effort0", "field.velocity0"}
    by_joint = read_recording(file, system=system, mapping=["pivot.velocity=ignore"])
    assert by_joint.channel_names == ("pivot.position",)
    turned = read_recording(file, system=system, mapping=["field.position0=pivot.position[deg]"])
    assert np.allclose(turned.channel("pivot.position").values, np.deg2rad(ANGLE))
