"""One motion in every format that recordings come in, written by the format's own library, read, and held against the motion."""

from __future__ import annotations

import gzip
import json
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.rotor import system
from harness.errors import InputError, missing_package
from harness.recording import read_recording
from harness.recording.formats import read_table

TIME = np.linspace(0.0, 2.0, 401)  # s
ANGLE = 0.7 * np.sin(5.0 * TIME + 0.4)  # rad
SPEED = 3.5 * np.cos(5.0 * TIME + 0.4)  # rad/s
EFFORT = 0.3 * np.sin(3.0 * TIME) + 0.05  # N·m
CHANNELS = {"hub.position": ANGLE, "hub.velocity": SPEED, "hub.effort": EFFORT}


def _csv(mark: str = ",") -> str:
    """Degrees, turns a minute, milliseconds and newton centimetres."""
    head = ["time [ms]", "hub.position [deg]", "hub.velocity [rpm]", "hub.effort [N*cm]"]
    columns = [TIME * 1e3, np.degrees(ANGLE), SPEED * 60.0 / (2.0 * np.pi), EFFORT * 100.0]
    rows = [mark.join(map(repr, map(float, row))) for row in zip(*columns, strict=True)]
    return "\n".join([mark.join(head), *rows]) + "\n"


def write_csv(file: Path) -> None:
    file.write_text(_csv(), encoding="utf-8")


def write_decimal_commas(file: Path) -> None:
    file.write_text(_csv(";").replace(".", ",").replace("hub,", "hub."), encoding="utf-8")


def write_packed_csv(file: Path) -> None:
    file.write_bytes(gzip.compress(_csv().encode()))


def write_hdf5(file: Path) -> None:
    import h5py

    with h5py.File(file, "w") as out:
        out["time"] = TIME * 1e3
        out["time"].attrs["unit"] = "ms"
        out["hub/position"] = np.degrees(ANGLE)
        out["hub/position"].attrs["units"] = "deg"
        # Whole numbers with a scale and an offset, as instruments write them.
        counts = np.round(SPEED * 1e6).astype(np.int32)
        out["hub/velocity"] = counts - 1000
        out["hub/velocity"].attrs["scale_factor"], out["hub/velocity"].attrs["add_offset"] = 1e-6, 1e-3
        out["hub/effort"] = EFFORT


def write_matlab(file: Path) -> None:
    from scipy.io import savemat

    savemat(file, {"time": TIME, "hub": {"position": ANGLE, "velocity": SPEED[:, None], "effort": EFFORT[None, :]}})


def write_numpy(file: Path) -> None:
    with file.open("wb") as stream:
        named: dict[str, Any] = {"time": TIME, **CHANNELS}
        np.savez(stream, **named)


def write_netcdf(file: Path) -> None:
    from scipy.io import netcdf_file

    with netcdf_file(str(file), "w") as out:
        out.createDimension("time", len(TIME))
        for name, values, unit in (
            ("time", TIME, "s"), ("hub.position", np.degrees(ANGLE), "degrees"), ("hub.velocity", SPEED, "rad/s"),
            ("hub.effort", EFFORT, "N*m"),
        ):  # fmt: skip
            variable = out.createVariable(name, "d", ("time",))
            variable[:], variable.units = values, unit


def write_mcap(file: Path) -> None:
    """Messages of ROS in JSON, another joint before ours."""
    from mcap.writer import Writer

    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", "json", schema)
        for k, (t, x, v, f) in enumerate(zip(TIME, ANGLE, SPEED, EFFORT, strict=True)):
            seconds, nanoseconds = divmod(round(float(t) * 1e9), 10**9)
            message = {
                "header": {"stamp": {"sec": seconds, "nanosec": nanoseconds}},
                "name": ["other", "hub"], "position": [9.0, x], "velocity": [8.0, v], "effort": [7.0, f],
            }  # fmt: skip
            writer.add_message(channel, log_time=k, data=json.dumps(message).encode(), publish_time=k)
        writer.finish()


def write_rosbag(file: Path) -> None:
    """A bag of ROS 1, stamps of the messages apart from when they were logged."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store, kind = get_typestore(Stores.ROS1_NOETIC), "sensor_msgs/msg/JointState"
    types = store.types
    with Writer(file) as writer:
        connection = writer.add_connection("/joint_states", kind, typestore=store)
        for k, (t, x, v, f) in enumerate(zip(TIME, ANGLE, SPEED, EFFORT, strict=True)):
            stamp = 100 * 10**9 + round(float(t) * 1e9)  # a stamp of zero is none to ROS
            seconds, nanoseconds = divmod(stamp, 10**9)
            when = types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=nanoseconds)
            message = types[kind](
                header=types["std_msgs/msg/Header"](seq=k, stamp=when, frame_id=""),
                name=["other", "hub"],
                position=np.array([9.0, x]),
                velocity=np.array([8.0, v]),
                effort=np.array([7.0, f]),
            )
            writer.write(connection, stamp + 3_000_000, store.serialize_ros1(message, kind))


def write_parquet(file: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table({"time": TIME, "hub.position [deg]": np.degrees(ANGLE)} | _but_position()), file)


def _but_position() -> dict[str, Array]:
    return {name: values for name, values in CHANNELS.items() if not name.endswith(".position")}


#: By name of the row: ending of the file and what writes it; speeds of HDF5 are whole micro-radians a second.
FORMATS: dict[str, tuple[str, Callable[[Path], None], float]] = {
    "csv": (".csv", write_csv, 1e-12),
    "decimal_commas": (".csv", write_decimal_commas, 1e-12),
    "packed_csv": (".csv.gz", write_packed_csv, 1e-12),
    "hdf5": (".h5", write_hdf5, 1e-6),
    "matlab": (".mat", write_matlab, 1e-12),
    "numpy": (".npz", write_numpy, 1e-12),
    "netcdf": (".nc", write_netcdf, 1e-12),
    "mcap": (".mcap", write_mcap, 1e-12),
    "rosbag": (".bag", write_rosbag, 1e-12),
    "parquet": (".parquet", write_parquet, 1e-12),
}


def formats(bench: Bench) -> Iterable[Row | Series]:
    """Every format: the largest difference of time or a channel, over the channel's largest value."""
    for name, (ending, write, allowed) in FORMATS.items():
        quantity = f"recording_{name}"
        try:
            apart = _apart(write, ending, bench)
        except ImportError as error:
            absent = missing_package(error)
            if absent is None:
                raise
            yield bench.skipped(quantity, (NATIVE, "analytic"), f"{absent.package} is not installed: {absent.mend}")
            continue
        except InputError as error:
            note = f"the reader of {name.replace('_', ' ')} refuses it: {error.what}"
            about = {"term": f"reader of {name.replace('_', ' ')}"}
            if channel := _misread(write, ending):
                note, about = f"{note}; {channel} is not read as it was written", about | {"channel": channel}
            yield bench.row(
                quantity, (NATIVE, "analytic"), np.nan, allowed, why="conversions of units", note=note, about=about
            )
            continue
        worst = max(apart, key=lambda channel: apart[channel])
        yield bench.row(
            quantity,
            (NATIVE, "analytic"),
            apart[worst],
            allowed,
            why="conversions of units" if allowed < 1e-9 else "whole numbers of 1e-6 rad/s in the file",
            note="" if apart[worst] <= allowed else f"the reader of {name.replace('_', ' ')} differs at {worst}",
            about={"term": f"reader of {name.replace('_', ' ')}", "channel": worst},
            source="the motion that was written, by the format's own library",
        )


def _apart(write: Callable[[Path], None], ending: str, bench: Bench) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"run{ending}"
        write(file)
        recording = read_recording(file, system=bench.system)
    found: dict[str, Any] = {"time": recording.time} | {
        one.name: one.values for one in (*recording.channels, *recording.efforts)
    }
    apart = {}
    for name, true in ({"time": TIME} | CHANNELS).items():
        values = np.asarray(found.get(name, ()), dtype=np.float64)
        same = len(values) == len(true) and bool(np.isfinite(values).all())
        # What is not there is as far apart as can be.
        apart[name] = float(np.abs(values - true).max() / np.abs(true).max()) if same else 1.0
    return apart


def _misread(write: Callable[[Path], None], ending: str) -> str:
    """The first column of a file that is refused whose course, whatever its unit, is not the one written; empty if all are."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"run{ending}"
        write(file)
        try:
            columns = read_table(file).columns
        except InputError:
            return ""
    for name, true in ({"time": TIME} | CHANNELS).items():
        values = next((v for key, v in columns.items() if key == name or key.startswith(f"{name} ")), np.zeros(0))
        # From their mean and over their spread: units are a factor, clocks an offset.
        courses = [(x - x.mean()) / (np.ptp(x) or 1.0) for x in (values, true) if len(x)]
        if len(values) != len(true) or not np.abs(courses[0] - courses[1]).max() <= 1e-6:
            return name
    return ""


CASE = Case(
    name="recording_files",
    title="One motion in every format of recordings",
    source="the motion that was written, by the format's own library",
    system=system,
    checks=(Measured("recording_files", formats),),
    group="lanes",
    engines=(NATIVE,),
)
