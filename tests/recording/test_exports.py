"""What other programs write: titles, rows of units, index columns, text, stamps of the calendar, headers of several rows."""

import bz2
import lzma

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file, savemat

from harness.errors import InputError
from harness.recording import read_recording
from harness.recording.formats.stamps import nanoseconds
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

TIME = np.arange(120) * 0.01
ANGLE = 0.7 * np.cos(3.0 * TIME)
SPEED = -2.1 * np.sin(3.0 * TIME)


@pytest.fixture
def system():
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0, 1, 0]))
    slide = Joint("slide", JointType.PRISMATIC, "rod", "carriage")
    tool = Joint("flange", JointType.FIXED, "carriage", "tool")
    return System("s", (pivot, slide, tool), (Link("rod", 1.0), Link("carriage", 1.0), Link("tool", 0.1)))


def rows(*columns, mark=","):
    return "".join(mark.join(str(cell) for cell in row) + "\n" for row in zip(*columns, strict=True))


def iso(seconds, form="2024-05-01T12:00:{:09.6f}"):
    return [form.format(s) for s in seconds]


NUMBERS = [f"{t:.3f}" for t in TIME], [repr(float(a)) for a in ANGLE]
INDEX = list(range(len(TIME)))
COMMA = [cell.replace(".", ",") for cell in NUMBERS[0]], [cell.replace(".", ",") for cell in NUMBERS[1]]
STAMPS = [1_695_196_914_311_943_473 + round(t * 1e9) for t in TIME]

DRESSES = {
    "pandas": ",time,pivot.position\n" + rows(INDEX, *NUMBERS),
    "pandas with text": "time,pivot.position,state,note\n" + rows(*NUMBERS, ["running"] * 120, ["a; b"] * 120),
    "a title": "Run 12, second try\n\ntime,pivot.position\n" + rows(*NUMBERS),
    "a title of a spreadsheet": "Run 12;;\n;;\ntime;pivot.position;\n" + rows(*COMMA, [""] * 120, mark=";"),
    "keys above": "Rate,100\nOperator,someone\nChannels,2\ntime,pivot.position\n" + rows(*NUMBERS),
    "units below": "time,pivot.position\nms,deg\n" + rows([f"{1e3 * t:.0f}" for t in TIME], np.degrees(ANGLE)),
    "units in brackets": "time,pivot.position\n[ms],[deg]\n" + rows([f"{1e3 * t:.0f}" for t in TIME], np.degrees(ANGLE)),
    "some units": "time\tpivot.position\tstate\ns\tdeg\t-\n" + rows(NUMBERS[0], np.degrees(ANGLE), ["on"] * 120, mark="\t"),
    "units and an empty row": "time;pivot.position\ns;rad\n;\n" + rows(*COMMA, mark=";"),
    "LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\nDate\t2024/05/01\n***End_of_Header***\t\n\t\nSamples\t120\t\t\n"
    "Delta_X\t0.01\t\t\n***End_of_Header***\t\t\t\ntime\tpivot.position\tComment\n"
    + rows(*NUMBERS, [""] * 120, mark="\t"),
    "month after day": "time,pivot.position\n" + rows([f"13/05/2024 12:00:{t:06.3f}" for t in TIME], ANGLE),
    "ISO stamps": "time,pivot.position\n" + rows(iso(TIME), ANGLE),
    "ISO stamps of a zone": "time,pivot.position\n" + rows(iso(TIME, "2024-05-01 12:00:{:06.3f}+02:00"), ANGLE),
    "stamps over midnight": "time,pivot.position\n"
    + rows(
        [f"2024-05-01 23:59:59.{40 + k}" if k < 60 else f"2024-05-02 00:00:00.{k - 60:02d}" for k in INDEX], ANGLE
    ),
    "stamps of a clock": "time;pivot.position\n" + rows([f"12:00:{t:06.3f}".replace(".", ",") for t in TIME], COMMA[1], mark=";"),
    "a clock over midnight": "time,pivot.position\n"
    + rows([f"23:59:59.{40 + k}" if k < 60 else f"00:00:00.{k - 60:02d}" for k in INDEX], ANGLE),
    "MATLAB's stamps": "time,pivot.position\n" + rows([f"01-May-2024 12:00:{t:06.3f}" for t in TIME], ANGLE),
    "a spreadsheet's afternoon": "time,pivot.position\n" + rows([f"5/1/2024 01:00:{t:06.3f} PM" for t in TIME], ANGLE),
    "a day after the twelfth": "time,pivot.position\n"
    + rows(
        [f"12.01.2024 23:59:59.{40 + k}" if k < 60 else f"13.01.2024 00:00:00.{k - 60:02d}" for k in INDEX], ANGLE
    ),
    "the fifth's midnight": "time,pivot.position\n"
    + rows([f"05/05/2024 23:59:59.{40 + k}" if k < 60 else f"06/05/2024 00:00:00.{k - 60:02d}" for k in INDEX], ANGLE),
    "German stamps": "time;pivot.position\n" + rows([f"01.05.2024 12:00:{t:06.3f}" for t in TIME], COMMA[1], mark=";"),
    "epoch in nanoseconds": "time [ns],pivot.position\n" + rows(STAMPS, ANGLE),
    "numpy.savetxt": "# time pivot.position\n" + rows(*NUMBERS, mark=" "),
    "MATLAB's comment": "% time, pivot.position\n" + rows(*NUMBERS),
    "write.table of R": '"time" "pivot.position"\n' + rows([f'"{k + 1}"' for k in INDEX], *NUMBERS, mark=" ").replace("'", ""),
    "capitals": "Time (Seconds),pivot.position [Deg]\n" + rows(NUMBERS[0], np.degrees(ANGLE)),
    "decimal commas and blanks": "time pivot.position\n" + rows(*COMMA, mark=" "),
    "PlotJuggler": "__time,/joint_states/header/stamp,/joint_states/pivot/position,/joint_states/elbow/position\n"
    + rows([f"{1695196914 + t:.6f}" for t in TIME], TIME, ANGLE, SPEED),
    "further joints": "time,pivot.position,elbow.position,elbow.velocity,gripper.effort,flange.position\n"
    + rows(*NUMBERS, SPEED, SPEED, SPEED, 0.0 * TIME),
    "no efforts": "time,pivot.position,pivot.effort\n" + rows(*NUMBERS, ["nan"] * 120),
    "a cell of none": "time,pivot.position,spare\n" + rows(*NUMBERS, [""] * 120),
    "two spare columns of one name": "time,pivot.position,X,X\n" + rows(*NUMBERS, SPEED, SPEED),
    "a column of large numbers": "time,pivot.position,serial\n" + rows(*NUMBERS, STAMPS),
}  # fmt: skip


@pytest.mark.parametrize("name", DRESSES)
def test_the_dress_makes_no_difference(tmp_path, system, name):
    file = tmp_path / "run.csv"
    file.write_text(DRESSES[name])
    recording = read_recording(file, system=system)
    assert recording.channel_names == ("pivot.position",) and not recording.efforts
    # The coarsest stamps here, of seconds since 1970 to a microsecond, are kept to a quarter of one.
    assert np.allclose(recording.time, TIME, rtol=0.0, atol=5e-7)
    assert np.allclose(recording.channels[0].values, ANGLE, rtol=0.0, atol=1e-12)


TOLD = {
    "pandas": ("not_read", "column 1 has no name"),
    "pandas with text": ("ignored_column", "is no column of ours"),
    "a title": ("not_read", "line 1 is above the header"),
    "keys above": ("not_read", "lines 1 to 3 are above the header"),
    "further joints": ("ignored_column", "is of a joint that the model has not"),
    "no efforts": ("empty_column", "holds no number"),
}


@pytest.mark.parametrize("name", TOLD)
def test_what_was_left_out_is_told(tmp_path, system, name):
    file = tmp_path / "run.csv"
    file.write_text(DRESSES[name])
    kind, words = TOLD[name]
    found = [note for note in read_recording(file, system=system).quality if note.kind == kind]
    assert found and all(words in note.what for note in found if kind != "ignored_column") and words in found[0].words()


def test_the_clock_of_a_calendar_is_kept(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text(DRESSES["ISO stamps of a zone"])
    # 2024-05-01 10:00:00 UTC, by `date -u -d @1714557600`.
    assert read_recording(file).start == pytest.approx(1714557600.0, abs=1e-6)


STAMPED = {  # by `date -u -d STAMP +%s`
    "2024-05-01T12:00:00Z": 1714564800,
    "2024-05-01 12:00:00+05:30": 1714545000,
    "01-May-2024 12:00:00": 1714564800,
    "29.02.2024 00:00": 1709164800,
    "2024-02-29": 1709164800,
    "12/31/2023 11:59:59 PM": 1704067199,
}


@pytest.mark.parametrize("stamp", STAMPED)
def test_stamps_are_read_to_the_second(stamp):
    assert nanoseconds([stamp]) == [STAMPED[stamp] * 10**9]


@pytest.mark.parametrize(
    "text", ["1.2.3", "2024-13-01", "30/02/2024", "25:00:00", "13:00 PM", "12", "", "2024-05-01 noon"]
)
def test_what_is_no_stamp_is_none(text):
    assert nanoseconds([text]) is None


def test_headers_of_several_rows(tmp_path):
    # As motion capture writes them: what repeats is told apart by what stands over it.
    file = tmp_path / "take.csv"
    head = (
        "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,100\n\n"
        ",,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,,Arm,Arm,Arm,Arm\n,,17,17,17,17\n"
        ",,Rotation,Rotation,Position,Position\nFrame,Time (Seconds),X,Y,X,Y\n"
    )
    file.write_text(head + rows(INDEX, NUMBERS[0], np.degrees(ANGLE), SPEED, SPEED, SPEED))
    recording = read_recording(file, mapping=["Rotation.X=pivot.position[deg]"])
    assert np.allclose(recording.channels[0].values, ANGLE, rtol=0.0, atol=1e-12)
    # A single rule is a list of one.
    alone = read_recording(file, mapping="Rotation.X=pivot.position[deg]")
    assert np.array_equal(alone.channels[0].values, recording.channels[0].values)


def test_names_over_the_first_of_their_columns_and_units_below(tmp_path):
    # Another system's: frames for time, a marker's name over the first of its three columns, a row of units.
    file = tmp_path / "trajectories.csv"
    head = "Trajectories\n100\n,,Rig:arm,,,Rig:tip,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
    file.write_text(head + rows(INDEX, [0] * 120, 1e3 * ANGLE, SPEED, SPEED, SPEED, SPEED, SPEED))
    recording = read_recording(file, mapping=["Frame=time[0.01 s]", "Rig:arm.X=slide.position"])
    assert recording.channels[0].unit == "m"
    assert np.allclose(recording.channels[0].values, ANGLE, rtol=0.0, atol=1e-12)
    assert np.allclose(recording.time, TIME, rtol=0.0, atol=1e-12)


def test_a_bad_cell_in_the_first_row_is_no_header(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text("time,pivot.position\n0.0,oops\n" + rows(TIME + 0.01, ANGLE))
    with pytest.raises(InputError, match=r":2, column pivot\.position: 'oops' is not a number"):
        read_recording(file)


def test_ignored_by_the_map(tmp_path, system):
    file = tmp_path / "run.csv"
    file.write_text(
        "time,theta,pivot.position,slide.position,slide.velocity\n" + rows(TIME, ANGLE, SPEED, SPEED, SPEED)
    )
    rules = ["theta=pivot.position", "pivot.position=ignore", "slide=ignore"]
    recording = read_recording(file, mapping=rules, system=system)
    assert recording.channel_names == ("pivot.position",) and np.array_equal(recording.channels[0].values, ANGLE)
    assert sum(note.what == "is mapped to ignore" for note in recording.quality) == 3
    with pytest.raises(InputError, match=r"there is no column 'tetha' to map to ignore .*did you mean 'theta'"):
        read_recording(file, mapping=["tetha=ignore"], system=system)


@pytest.mark.parametrize(
    ("header", "words"),
    [
        # Of two that could be meant, neither is taken for the other.
        ("time,pivot.position,slyde.position", r"did you mean 'slide'.*--map 'slyde=ignore'"),
        ("time,pivot.position,rod.velocity", None),
        ("time,slide.position,rod.position", "'rod' is a link; its joint is 'pivot'"),
        ("time,pivot.effort,elbow.position", "no movable joint 'elbow'"),
        ("time,pivot.position,pivot.position", "two columns are named"),
        ("time,pivot.position,pivot.velocity", "'1.2.3' is not a number"),
    ],
)
def test_what_may_be_a_slip_is_refused(tmp_path, system, header, words):
    file = tmp_path / "run.csv"
    third = ["1.2.3" if "1.2.3" in str(words) and k == 7 else s for k, s in enumerate(SPEED)]
    file.write_text(header + "\n" + rows(TIME, ANGLE, third))
    if words is None:
        assert read_recording(file, system=system).channel_names == ("pivot.position",)
        return
    with pytest.raises(InputError, match=words):
        read_recording(file, system=system)


@pytest.mark.parametrize("pack", [bz2.compress, lzma.compress])
def test_other_packings(tmp_path, pack):
    file = tmp_path / "run.csv.packed"
    file.write_bytes(pack(DRESSES["pandas"].encode()))
    assert np.allclose(read_recording(file).channels[0].values, ANGLE, rtol=0.0, atol=1e-12)
    file.write_bytes(pack(DRESSES["pandas"].encode())[:-20])
    with pytest.raises(InputError, match="damaged"):
        read_recording(file)


def packed_angle():
    """Angles in sixteen bits: value = stored · scale + offset, and one that stands for none."""
    scale, offset = 1e-4, 0.25
    stored = np.round((ANGLE - offset) / scale).astype(np.int16)
    stored[17] = -32768
    return stored, scale, offset


def check_unpacked(recording):
    assert np.allclose(recording.time, np.delete(TIME, 17), rtol=0.0, atol=1e-12)
    left = recording.channel("pivot.position").values - np.delete(ANGLE, 17)
    assert 1e-6 < np.abs(left).max() <= 0.5e-4 + 1e-9
    assert {"packed", "fill_value"} <= {note.kind for note in recording.quality}


def test_packed_numbers_of_hdf5(tmp_path):
    file = tmp_path / "run.nc"
    stored, scale, offset = packed_angle()
    with h5py.File(file, "w") as out:
        out["time"] = TIME
        out["time"].attrs["units"] = "seconds since 2024-05-01 12:00:00"
        data = out.create_dataset("pivot/position", data=stored)
        data.attrs.update({"scale_factor": scale, "add_offset": offset, "_FillValue": np.int16(-32768), "units": "rad"})
    check_unpacked(read_recording(file))


def test_packed_numbers_of_netcdf(tmp_path):
    file = tmp_path / "run.nc"
    stored, scale, offset = packed_angle()
    with netcdf_file(file, "w") as out:
        out.createDimension("time", len(TIME))
        out.createVariable("time", "f8", ("time",))[:] = TIME
        out.variables["time"].units = b"seconds since 2024-05-01"
        angle = out.createVariable("pivot.position", "i2", ("time",))
        angle[:] = stored
        angle.scale_factor, angle.add_offset, angle._FillValue = scale, offset, np.int16(-32768)
        angle.units = b"rad"
    check_unpacked(read_recording(file))


@pytest.mark.parametrize("classic", [True, False], ids=["netcdf", "hdf5"])
def test_unsigned_numbers_in_signed_columns(tmp_path, classic):
    # NetCDF User's Guide, _Unsigned: the bits are those of an unsigned number, and the fill value's too. All of 16 bits occur:
    # ANGLE moves about mid-scale, where the signed number jumps from 32767 to -32768.
    file = tmp_path / "run.nc"
    scale, offset = 1e-4, -3.2768
    counts = np.round((ANGLE - offset) / scale).astype(np.uint16)
    assert counts.min() < 32768 < counts.max()
    stored = counts.view(np.int16)
    stored[17] = -1
    attributes = {"scale_factor": scale, "add_offset": offset, "_FillValue": np.int16(-1)}
    if classic:
        with netcdf_file(file, "w") as out:
            out.createDimension("time", len(TIME))
            out.createVariable("time", "f8", ("time",))[:] = TIME
            angle = out.createVariable("pivot.position", "i2", ("time",))
            angle[:] = stored
            for key, value in {**attributes, "_Unsigned": b"true", "units": b"rad"}.items():
                setattr(angle, key, value)
    else:
        with h5py.File(file, "w") as out:
            out["time"] = TIME
            data = out.create_dataset("pivot/position", data=stored)
            data.attrs.update({**attributes, "_Unsigned": "true", "units": "rad"})
    check_unpacked(read_recording(file))


def test_numpy_files(tmp_path):
    file = tmp_path / "run.npz"
    np.savez(file, time=TIME, theta=ANGLE, note=np.array("a swing"))
    recording = read_recording(file, mapping=["theta=pivot.position"])
    assert np.array_equal(recording.channels[0].values, ANGLE)
    table = np.zeros(len(TIME), dtype=[("time", float), ("pivot.position", float)])
    table["time"], table["pivot.position"] = TIME, ANGLE
    np.save(tmp_path / "run.npy", table)
    assert np.array_equal(read_recording(tmp_path / "run.npy").channels[0].values, ANGLE)
    np.save(tmp_path / "run.npy", ANGLE)
    with pytest.raises(InputError, match="array without names of columns"):
        read_recording(tmp_path / "run.npy")


def simulink(values, label):
    return {"values": values, "dimensions": 1.0, "label": label, "blockName": "model/Scope"}


def test_simulinks_structures_with_time(tmp_path):
    file = tmp_path / "run.mat"
    savemat(file, {"out": {"time": TIME, "signals": simulink(ANGLE, "pivot.position"), "blockName": "model/Scope"}})
    assert np.array_equal(read_recording(file).channels[0].values, ANGLE)
    several = np.array([simulink(ANGLE, "theta"), simulink(SPEED, "omega")], dtype=object)
    savemat(file, {"out": {"time": TIME, "signals": several}})
    recording = read_recording(file, mapping=["theta=pivot.position", "omega=pivot.velocity"])
    assert np.array_equal(recording.channel("pivot.velocity").values, SPEED)


def test_a_matrix_is_its_columns(tmp_path):
    # Simulink's To File: time in the first row, signals in the others.
    file = tmp_path / "run.mat"
    savemat(file, {"ans": np.stack([TIME, ANGLE, SPEED])})
    rules = ["ans[0]=time", "ans[1]=pivot.position", "ans[2]=pivot.velocity"]
    recording = read_recording(file, mapping=rules)
    assert np.array_equal(recording.channel("pivot.position").values, ANGLE)
    assert np.array_equal(recording.channel("pivot.velocity").values, SPEED)
