"""What a file or a mapping says twice, or says of itself otherwise than it is taken: read where it agrees, else refused or told."""

import json
import math

import numpy as np
import pytest
from mcap.writer import Writer

from harness.errors import InputError
from harness.recording import read_recording
from harness.system import load

ANGLE = [0.8 * math.cos(0.05 * k) for k in range(300)]  # rad
DEGREES = np.degrees(ANGLE)


def written(tmp_path, head, rows, name="run.csv"):
    (tmp_path / name).write_text(head + "\n" + "\n".join(",".join(str(cell) for cell in row) for row in rows) + "\n")
    return tmp_path / name


def every_hundredth(values):
    return [(0.01 * k, value) for k, value in enumerate(values)]


@pytest.mark.parametrize("unit", ["", "[deg]", "[degrees]", "[pi/180 rad]"])
def test_a_mapping_may_repeat_the_unit_of_the_header(tmp_path, unit):
    file = written(tmp_path, "time,theta [deg]", every_hundredth(DEGREES))
    recording = read_recording(file, mapping=f"theta=pivot.position{unit}")
    np.testing.assert_allclose(recording.channels[0].values, ANGLE, atol=1e-12)
    assert not [note for note in recording.quality if note.kind == "unit"]


@pytest.mark.parametrize("head", ["time,theta [deg]", "time,theta\ns,deg"])
def test_two_units_of_one_column_are_refused(tmp_path, head):
    file = written(tmp_path, head, every_hundredth(DEGREES))
    with pytest.raises(InputError, match=r"column theta.*: is in 'deg' by the file itself, and 'rad' is said of it"):
        read_recording(file, mapping="theta=pivot.position[rad]")


def test_a_header_and_the_row_of_units_below_it_are_two(tmp_path):
    file = written(tmp_path, "time,pivot.position [deg]\ns,rad", every_hundredth(DEGREES))
    with pytest.raises(InputError, match=r"is in 'rad' by the file itself, and 'deg' is said of it"):
        read_recording(file)


def test_what_a_volt_stands_for_is_told(tmp_path):
    file = written(tmp_path, "time,theta [V]", every_hundredth(np.array(ANGLE) / 0.5))
    recording = read_recording(file, mapping="theta=pivot.position[0.5 rad]")
    np.testing.assert_allclose(recording.channels[0].values, ANGLE, atol=1e-12)
    assert [note.what for note in recording.quality if note.kind == "unit"] == [
        "is in V by the file, and mapped as 0.5 rad"
    ]


def test_two_mappings_of_one_column_are_refused(tmp_path):
    file = written(tmp_path, "time,theta", every_hundredth(ANGLE))
    with pytest.raises(InputError, match=r"column theta: is mapped to pivot.position\[deg\] and to -pivot.position"):
        read_recording(file, mapping=["theta=pivot.position[deg]", "theta=-pivot.position"])
    recording = read_recording(file, mapping=["theta=pivot.position", "theta=pivot.position"])
    np.testing.assert_allclose(recording.channels[0].values, ANGLE, atol=1e-12)


def states(file, messages):
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", "json", schema)
        for k, message in enumerate(messages):
            writer.add_message(channel, k * 10_000_000, message.encode(), k * 10_000_000)
        writer.finish()
    return file


def test_a_joint_that_one_message_names_twice_is_refused_where_it_is_wanted(tmp_path):
    twice = [json.dumps({"name": ["pivot", "elbow", "elbow"], "position": [x, x, -x]}) for x in ANGLE]
    file = states(tmp_path / "run.mcap", twice)
    with pytest.raises(InputError, match="column /joint_states/elbow/position: is stated twice in one message"):
        read_recording(file)
    recording = read_recording(file, mapping="/joint_states/elbow/position=ignore")
    assert [channel.name for channel in recording.channels] == ["pivot.position"]
    np.testing.assert_array_equal(recording.channels[0].values, ANGLE)


def test_a_message_with_two_members_of_one_name_is_damaged(tmp_path):
    file = states(
        tmp_path / "run.mcap", [f'{{"name": ["pivot"], "position": [{x}], "position": [0.1]}}' for x in ANGLE]
    )
    with pytest.raises(InputError, match="300 messages are damaged"):
        read_recording(file)


def test_rostopic_names_a_joint_twice(tmp_path):
    rows = [(10**18 + k * 10**7, 0, "pivot", "pivot", x, -x) for k, x in enumerate(ANGLE)]
    head = "%time,field.header.stamp,field.name0,field.name1,field.position0,field.position1"
    with pytest.raises(InputError, match=r"column pivot.position: is stated twice in one message"):
        read_recording(written(tmp_path, head, rows))


# 1 May 2024, noon UTC, is 1714564800 s after 1970 and day 45413.5 of a spreadsheet, whose first is 31 December 1899.
@pytest.mark.parametrize(
    ("first", "step", "unit", "said"),
    [
        (1714564800000, 10, "ms", "milliseconds since 1970"),
        (1714564800000000, 10_000, "us", "microseconds since 1970"),
        (1714564800000000000, 10_000_000, "ns", "nanoseconds since 1970"),
        (45413.5, 0.01 / 86400, "day", "days of a spreadsheet"),
    ],
)
def test_stamps_that_are_no_seconds_are_not_taken_for_seconds(tmp_path, first, step, unit, said):
    rows = [(repr(first + step * k), x) for k, x in enumerate(ANGLE)]
    with pytest.raises(InputError) as told:
        read_recording(written(tmp_path, "time,pivot.position", rows))
    assert f"which are {said}, not seconds (write time [{unit}] in the header)" in str(told.value)
    recording = read_recording(written(tmp_path, f"time [{unit}],pivot.position", rows))
    np.testing.assert_allclose(recording.time, 0.01 * np.arange(300), atol=2e-6)


def test_seconds_since_1970_and_since_the_machine_started_are_seconds(tmp_path):
    for first in (1714564800, 45413.5):
        rows = [(repr(first + 0.01 * k), x) for k, x in enumerate(ANGLE)]
        recording = read_recording(written(tmp_path, "time,pivot.position", rows))
        np.testing.assert_allclose(recording.time, 0.01 * np.arange(300), atol=1e-6)


@pytest.mark.parametrize("samples", [30, 75])
def test_short_recordings_in_one_file_are_no_rounded_clock(tmp_path, samples):
    rows = [(0.01 * (k % samples), x) for k, x in enumerate(ANGLE)]
    with pytest.raises(InputError, match=rf"run.csv:{samples + 2}, column time: time jumps back"):
        read_recording(written(tmp_path, "time,pivot.position", rows))


def test_a_mapping_may_be_a_dictionary(tmp_path):
    file = written(tmp_path, "t=,theta [deg]", every_hundredth(DEGREES))
    recording = read_recording(file, mapping={"t=": "time", "theta": "-pivot.position"})
    np.testing.assert_allclose(recording.channels[0].values, np.negative(ANGLE), atol=1e-12)
    with pytest.raises(InputError, match=r"mapping: mapping of 'theta': 'pivot.pos' is no column of a recording"):
        read_recording(file, mapping={"theta": "pivot.pos"})


SIDES = """
[[joint]]
name = "left/pivot"
type = "revolute"
parent = "base"
child = "a"
axis = [0, 1, 0]
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "b"
axis = [0, 1, 0]
[[link]]
name = "a"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-6]
[[link]]
name = "b"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-6]
"""


@pytest.mark.parametrize(
    "left", ["left/pivot.position", "/joint_states/left/pivot/position", "/joint_states/left/pivot.position"]
)
@pytest.mark.parametrize("right", ["pivot.position", "/joint_states/pivot/position"])
def test_a_joint_with_a_slash_in_its_name_is_not_another_that_has_its_last_part(tmp_path, left, right):
    (tmp_path / "rig.toml").write_text(SIDES)
    rows = [(0.01 * k, x, -x) for k, x in enumerate(ANGLE)]
    recording = read_recording(written(tmp_path, f"time,{left},{right}", rows), system=load(tmp_path / "rig.toml"))
    assert [channel.name for channel in recording.channels] == ["left/pivot.position", "pivot.position"]
    np.testing.assert_allclose(recording.channels[0].values, ANGLE)
