"""Recordings of every format and unit, read alike; what cannot be used is refused with its place."""

import gzip
import json

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from mcap.writer import Writer
from scipy.io import savemat

from harness.errors import InputError
from harness.recording import quality_table, read_recording, read_recordings
from harness.recording.recording import LINEAR_UNITS
from harness.recording.recording import UNITS as SI
from harness.recording.units import factor_to_si
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

TIME = np.arange(200) * 0.01 + 5.0
ANGLE = 0.7 * np.cos(3.0 * TIME)
SPEED = -2.1 * np.sin(3.0 * TIME)
EFFORT = 0.2 * np.sin(2.0 * TIME)


@pytest.fixture
def system():
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0, 1, 0]))
    slide = Joint("slide", JointType.PRISMATIC, "rod", "carriage")
    tool = Joint("flange", JointType.FIXED, "carriage", "tool")
    return System("s", (pivot, slide, tool), (Link("rod", 1.0), Link("carriage", 1.0), Link("tool", 0.1)))


def csv_text(header="time,pivot.position,pivot.velocity,pivot.effort", columns=(TIME, ANGLE, SPEED, EFFORT), mark=","):
    rows = [mark.join(repr(float(c[k])) for c in columns) for k in range(len(columns[0]))]
    return header.replace(",", mark) + "\n" + "\n".join(rows) + "\n"


def write_csv(folder):
    (folder / "run.csv").write_text(csv_text())
    return folder / "run.csv"


def write_gz(folder):
    file = folder / "run.csv.gz"
    file.write_bytes(gzip.compress(csv_text().encode()))
    return file


def write_semicolons_with_decimal_commas(folder):
    file = folder / "run.txt"
    file.write_text("﻿# exported\n" + csv_text(mark=";").replace(".", ",").replace("pivot,", "pivot."))
    return file


def write_tabs(folder):
    file = folder / "run.dat"
    file.write_text(csv_text(mark="\t"))
    return file


def write_parquet(folder):
    file = folder / "run.parquet"
    columns = {"time": TIME, "pivot.position": ANGLE, "pivot.velocity": SPEED, "pivot.effort": EFFORT}
    pq.write_table(pa.table(columns), file)
    return file


def write_hdf5(folder):
    file = folder / "run.h5"
    with h5py.File(file, "w") as out:
        out["time"] = TIME * 1e3
        out["time"].attrs["unit"] = "ms"
        out["pivot/position"] = np.degrees(ANGLE)
        out["pivot/position"].attrs["units"] = "deg"
        out["pivot/velocity"] = SPEED.reshape(-1, 1)
        out["pivot/effort"] = EFFORT
        out["comment"] = "a swing"
    return file


def write_hdf5_with_wrong_ending(folder):
    return write_hdf5(folder).rename(folder / "run.csv")


def write_matlab(folder):
    file = folder / "run.mat"
    pivot = {"position": ANGLE, "velocity": SPEED[:, None], "effort": EFFORT[None, :]}
    savemat(file, {"time": TIME, "pivot": pivot, "note": "a swing"})
    return file


def write_matlab73(folder):
    # MATLAB 7.3 is an HDF5 file behind a text block of 512 bytes.
    file = folder / "run73.mat"
    with h5py.File(file, "w", userblock_size=512) as out:
        out["time"] = TIME[None, :]
        group = out.create_group("pivot")
        for name, values in (("position", ANGLE), ("velocity", SPEED), ("effort", EFFORT)):
            group[name] = values[None, :]
    with file.open("r+b") as out:
        out.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return file


def write_mcap(folder, encoding="json"):
    file = folder / "run.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", encoding, schema)
        for k, t in enumerate(TIME):
            stamp = round(float(t) * 1e9)
            message = {
                "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}},
                "name": ["slide", "pivot"],
                "position": [0.0, ANGLE[k]],
                "velocity": [0.0, SPEED[k]],
                "effort": [0.0, EFFORT[k]],
            }
            writer.add_message(channel, log_time=k, data=json.dumps(message).encode(), publish_time=k)
        writer.finish()
    return file


WRITERS = [
    write_csv, write_gz, write_semicolons_with_decimal_commas, write_tabs, write_parquet, write_hdf5,
    write_hdf5_with_wrong_ending, write_matlab, write_matlab73, write_mcap,
]  # fmt: skip


@pytest.mark.parametrize("writer", WRITERS, ids=lambda f: f.__name__)
def test_every_format_gives_the_same_recording(tmp_path, writer, system):
    recording = read_recording(writer(tmp_path), system=system)
    assert np.allclose(recording.time, TIME - TIME[0], rtol=0, atol=2e-9)
    assert recording.time[0] == 0.0
    assert np.allclose(recording.channel("pivot.position").values, ANGLE, rtol=0, atol=1e-12)
    assert np.allclose(recording.channel("pivot.velocity").values, SPEED, rtol=0, atol=1e-12)
    assert [effort.name for effort in recording.efforts][-1] == "pivot.effort"
    assert np.allclose(recording.efforts[-1].values, EFFORT, rtol=0, atol=1e-12)
    assert recording.name.startswith("run")
    assert not recording.channels[0].values.flags.writeable


def test_the_files_own_clock_is_kept(tmp_path):
    assert read_recording(write_csv(tmp_path)).start == pytest.approx(5.0)


# Factors from the definitions of the units: 1 turn = 2π rad, rpm = turn/min, standard gravity 9.80665 m/s² (CGPM 1901).
UNITS = [
    ("pivot.position [deg]", np.pi / 180.0, "rad"),
    ("pivot.position [turn]", 2 * np.pi, "rad"),
    ("pivot.position (mrad)", 1e-3, "rad"),
    ("pivot.position [2*pi/4096 rad]", 2 * np.pi / 4096, "rad"),
    ("pivot.velocity [deg/s]", np.pi / 180.0, "rad/s"),
    ("pivot.velocity [rpm]", 2 * np.pi / 60.0, "rad/s"),
    ("slide.position [mm]", 1e-3, "m"),
    ("slide.velocity [cm/s]", 1e-2, "m/s"),
    ("rod.tip_deflection [mm]", 1e-3, "m"),
    ("rod.tip_deflection[um]", 1e-6, "m"),
    ("rod.root_strain [microstrain]", 1e-6, "1"),
    ("rod.root_strain [µε]", 1e-6, "1"),
    ("rod.root_strain [percent]", 1e-2, "1"),
    ("rod.tip_acceleration [g]", 9.80665, "m/s**2"),
    ("rod.tip_acceleration [m/s²]", 1.0, "m/s**2"),
]


@pytest.mark.parametrize(("header", "factor", "unit"), UNITS)
def test_units(tmp_path, system, header, factor, unit):
    file = tmp_path / "run.csv"
    wave = np.sin(3 * TIME)
    file.write_text(csv_text(f"time [ms],{header}", (TIME * 1e3, wave)))
    channel = read_recording(file, system=system).channels[0]
    assert channel.unit == unit
    assert np.allclose(channel.values, wave * factor, rtol=1e-12)


@pytest.mark.parametrize("quantity", ["time", *SI])
@pytest.mark.parametrize("prismatic", [None, False, True])
@pytest.mark.parametrize("unit", sorted({"s", *SI.values(), *LINEAR_UNITS.values()}))
def test_plain_si_is_what_the_table_of_units_says(quantity, prismatic, unit):
    def answer(text):
        try:
            return factor_to_si(text, quantity, prismatic=prismatic)
        except InputError:
            return None

    # With a factor it is looked up.
    assert answer(unit) == answer(f"1.0 {unit}")


def test_effort_units(tmp_path, system):
    file = tmp_path / "run.csv"
    file.write_text(csv_text("time,pivot.position,pivot.effort [mN*m]", (TIME, ANGLE, EFFORT)))
    assert np.allclose(read_recording(file, system=system).efforts[0].values, EFFORT * 1e-3)


def test_headers_are_mapped_on_the_command_line(tmp_path, system):
    file = tmp_path / "run.csv"
    file.write_text(csv_text("t (ms),theta_meas,u", (TIME * 1e3, np.degrees(ANGLE), EFFORT)))
    rules = ["t=time", "theta_meas=-pivot.position[deg]", "u=pivot.effort[N*m]"]
    recording = read_recording(file, mapping=rules, system=system)
    assert np.allclose(recording.time, TIME - TIME[0])
    assert np.allclose(recording.channels[0].values, -ANGLE)
    assert recording.channels[0].column == "theta_meas"


@pytest.mark.parametrize("name", ["run.csv.toml", "run.toml", "columns.toml"])
def test_headers_are_mapped_by_a_file_beside(tmp_path, name):
    file = tmp_path / "run.csv"
    file.write_text(csv_text("t,theta_meas,spare", (TIME, np.degrees(ANGLE), EFFORT)))
    (tmp_path / name).write_text(
        '[columns]\nt = "time"\ntheta_meas = "pivot.position [deg]"\nelsewhere = "pivot.velocity"\n'
    )
    recording = read_recording(file)
    assert np.allclose(recording.channels[0].values, ANGLE)
    assert [note.channel for note in recording.quality if note.kind == "ignored_column"] == ["spare"]


def test_the_command_line_goes_before_the_file_beside(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text(csv_text("time,theta", (TIME, ANGLE)))
    (tmp_path / "columns.toml").write_text('[columns]\ntheta = "pivot.position [deg]"\n')
    assert np.allclose(read_recording(file, mapping=["theta=pivot.position"]).channels[0].values, ANGLE)


def refusal(file, words, **options):
    with pytest.raises(InputError) as caught:
        read_recording(file, **options)
    message = str(caught.value)
    assert words in message, message
    assert "\n" not in message
    return message


REFUSED_TEXT = [
    ("", "the file is empty"),
    ("\n\n", "the file is empty"),
    ("# only a comment\n", "holds comments only"),
    ("time,pivot.position\n", "has a header but no samples"),
    ("1.0,2.0\n1.1,2.1\n", "the first line is numbers, not a header"),
    ("t,pivot.position\n1,2\n", "--map 't=time[s]'"),
    ("time,pivot.position,pivot.position\n1,2,3\n", "two columns are named 'pivot.position'"),
    ("time,temperature\n1,2\n2,3\n", "no column besides time is known"),
    ("time,pivot.postion\n1,2\n2,3\n", "did you mean 'position'?"),
    ("time,pivot.torque\n1,2\n2,3\n", "no quantity of a recording"),
    ("time,pivott.position\n1,2\n2,3\n", "did you mean 'pivot'?"),
    ("time,rod.position\n1,2\n2,3\n", "'rod' is a link; its joint is 'pivot'"),
    ("time,pivot.tip_deflection\n1,2\n2,3\n", "'pivot' is a joint; its link is 'rod'"),
    ("time,flange.position\n1,2\n2,3\n", "that joint is fixed"),
    ("time,pivot.position [mm]\n1,2\n2,3\n", "unit 'mm' does not fit a position"),
    ("time,slide.position [deg]\n1,2\n2,3\n", "unit 'deg' does not fit a position"),
    ("time,pivot.position [dge]\n1,2\n2,3\n", "'dge' is not a unit"),
    ("time,pivot.velocity [Hz]\n1,2\n2,3\n", "could mean turns or radians"),
    ("time [m],pivot.position\n1,2\n2,3\n", "unit 'm' does not fit a time"),
]


@pytest.mark.parametrize(("text", "words"), REFUSED_TEXT)
def test_refused_text(tmp_path, system, text, words):
    file = tmp_path / "run.csv"
    padded = text + "".join(f"{k},{k}\n" for k in range(3, 60)) if text.count("\n") == 3 else text
    file.write_text(padded)
    assert str(file) in refusal(file, words, system=system)


def test_bad_cells_are_named_with_line_and_column(tmp_path):
    file = tmp_path / "run.csv"
    lines = csv_text().splitlines()
    lines[41] = lines[41].replace(",", ",oops", 1)
    file.write_text("# a comment\n\n" + "\n".join(lines))
    message = refusal(file, "is not a number")
    assert f"{file}:44, column pivot.position" in message
    lines = csv_text().splitlines()
    lines[10] += ",3.0"
    file.write_text("\n".join(lines))
    assert f"{file}:11: has 5 cells where the header has 4" in refusal(file, "cells")


def test_a_cut_off_last_line_is_left_out_and_told(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text(csv_text().rstrip("\n").rsplit(",", 2)[0])
    recording = read_recording(file)
    assert recording.samples == 199
    assert any(note.kind == "cut_off" for note in recording.quality)


REFUSED_BYTES = [
    (bytes(range(256)) * 8, "is not text and no format that is known"),
    (b"PK\x03\x04" + b"\x00" * 64, "damaged zip archive"),
    (gzip.compress(csv_text().encode())[:200], "damaged gzip file"),
    (b"PAR1" + b"\x01" * 300, "damaged Parquet file"),
    (b"\x89HDF\r\n\x1a\n" + b"\x01" * 300, "damaged HDF5 file"),
    (b"\x89MCAP0\r\n" + b"\x01" * 300, "damaged MCAP file"),
    (b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"\x07" * 90, "MATLAB file"),
    (b"#ROSBAG V2.0\n" + b"\x00" * 64, "damaged or unknown bag"),
    (b"SQLite format 3\x00" + b"\x00" * 500, "damaged or unknown bag"),
    (b"CDF\x01" + b"\x07" * 90, "damaged netCDF file"),
    (b"\x93NUMPY" + b"\x07" * 90, "damaged NumPy file"),
]


@pytest.mark.parametrize(("content", "words"), REFUSED_BYTES, ids=[words for _, words in REFUSED_BYTES])
def test_refused_bytes(tmp_path, content, words):
    file = tmp_path / "run.csv"
    file.write_bytes(content)
    refusal(file, words)


def test_mcap_of_another_encoding_is_refused_by_name(tmp_path):
    refusal(write_mcap(tmp_path, encoding="protobuf"), "topic '/joint_states' is encoded as 'protobuf'")
    # JSON behind the name of another encoding.
    refusal(write_mcap(tmp_path, encoding="cdr"), "200 messages are damaged (/joint_states)")


def test_missing_file_and_directory(tmp_path):
    refusal(tmp_path / "none.csv", "no such file")
    refusal(tmp_path, "is a directory")


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        ("theta", "is not of the form"),
        ("theta=", "is not of the form"),
        ("theta=pivot", "is no column of a recording"),
        ("theta=pivot.angle", "is no column of a recording"),
        ("thetta=pivot.position", "did you mean 'theta'?"),
        ("theta=pivot.position[parsec]", "does not fit"),
    ],
)
def test_bad_rules(tmp_path, rule, words, system):
    file = tmp_path / "run.csv"
    file.write_text(csv_text("time,theta", (TIME, ANGLE)))
    refusal(file, words, mapping=[rule], system=system)


def test_bad_file_beside(tmp_path):
    file = write_csv(tmp_path)
    (tmp_path / "columns.toml").write_text("columns = [")
    refusal(file, "not valid TOML")
    (tmp_path / "columns.toml").write_text("[colums]\n")
    refusal(file, "has no table [columns]")


def test_several_recordings(tmp_path):
    first = write_csv(tmp_path)
    second = tmp_path / "second.csv"
    second.write_text(csv_text("time,pivot.position", (TIME, ANGLE)))
    assert [r.name for r in read_recordings([second, first])] == ["second", "run"]
    with pytest.raises(InputError, match="no recording given"):
        read_recordings([])
    with pytest.raises(InputError, match="given twice"):
        read_recordings([first, tmp_path / "." / "run.csv"])
    second.write_text(csv_text("time,elbow.position", (TIME, ANGLE)))
    with pytest.raises(InputError, match="nothing that run measures"):
        read_recordings([first, second])


def test_the_quality_table_speaks_of_every_channel(tmp_path):
    rows = quality_table(read_recording(write_csv(tmp_path)))
    assert [row["channel"] for row in rows[:4]] == ["time", "pivot.position", "pivot.velocity", "pivot.effort"]
    assert all(isinstance(text, str) for row in rows for text in row.values())
