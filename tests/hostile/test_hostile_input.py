"""Whatever a file holds, reading it ends in what it means or in one line: never in a defect, a hang or a dead process."""

from __future__ import annotations

import errno
import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from attempts import KINDS, PENDULUM, READ, attempt, tried, valid_file
from damage import ANGLE, RECORDINGS, TIME

import harness
from harness.cases.results import read_results
from harness.errors import InputError
from harness.recording import read_recording
from harness.recording.formats import apart, reader_process
from harness.recording.units import factor_to_si
from harness.system import audit, mjcf_trial
from harness.system.read_mjcf import compiled

MANY = 60


@pytest.mark.parametrize("kind", KINDS)
def test_damage_is_told_in_one_line(kind: str, tmp_path: Path) -> None:
    valid = valid_file(kind, tmp_path)
    assert attempt(kind, valid, tmp_path).outcome == "read"
    outcomes = [tried(kind, seed, valid, tmp_path) for seed in range(MANY)]
    defects = {seed: one for seed, one in enumerate(outcomes) if one.outcome == "defect"}
    assert not defects
    assert sum(one.outcome == "refused" for one in outcomes) > MANY // 8  # the damage is real


@pytest.mark.parametrize("kind", [kind for kind in RECORDINGS if kind not in ("csv", "csv.gz")])
def test_the_other_process_reads_what_this_one_would(kind: str, tmp_path: Path) -> None:
    """Only numbers go between the two: time and angle as they were written, to the last digit of what holds them."""
    valid_file(kind, tmp_path)
    recording = read_recording(tmp_path / f"valid.{kind}", system=PENDULUM)
    angle = next(c for c in recording.channels if c.name == "pivot.position").values
    assert np.allclose(recording.time, TIME, rtol=0.0, atol=2e-9)  # logs hold nanoseconds
    assert np.array_equal(angle, ANGLE)


def kill_itself(path: Path, file: Path) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def sleep(path: Path, file: Path) -> None:
    time.sleep(60.0)


def swell(path: Path, file: Path) -> None:
    np.ones(2**27)  # 1 GiB


def stumble(path: Path, file: Path) -> None:
    raise KeyError("what a library's last line raises")


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> str:
    """The reader process finds the functions above by the name of a format."""
    monkeypatch.setitem(apart.KINDS, "hostile_reader", "strange file")
    process = apart.ReaderProcess()
    monkeypatch.setattr(apart, "_process", lambda own: process)
    code = f"import sys; sys.path[:] = {__import__('sys').path!r}; import {__name__} as own; "
    code += (
        "from harness.recording.formats import apart, reader_process; apart.KINDS['hostile_reader'] = 'strange file'; "
    )
    code += "sys.modules['harness.recording.formats.hostile_reader'] = own; reader_process.work()"
    monkeypatch.setattr(apart, "START", code)
    return "hostile_reader"


def told(module: str, reader: str, tmp_path: Path) -> str:
    file = tmp_path / "strange.bin"
    file.write_bytes(b"?")
    with pytest.raises(InputError) as failure:
        apart.read_apart(module, reader, file, file)
    return str(failure.value)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="signals of Unix")
def test_a_crash_of_a_library_is_one_line(here: str, tmp_path: Path) -> None:
    assert "strange.bin: damaged strange file: the library that reads it crashed (SIGSEGV)" in told(
        here, "kill_itself", tmp_path
    )
    assert "KeyError" in told(here, "stumble", tmp_path) or "last line" in told(here, "stumble", tmp_path)


def test_a_reader_that_hangs_is_ended(here: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "LEAST_TIME", 3.0)
    begin = time.perf_counter()
    assert "was not read within 3 s" in told(here, "sleep", tmp_path)
    assert time.perf_counter() - begin < 20.0


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is limited where /proc tells what is used")
def test_a_reader_that_swells_is_told(here: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "LEAST_MEMORY", 2**28)
    assert "needs more than 0.25 GiB of memory" in told(here, "swell", tmp_path)


def test_a_packed_file_that_swells_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import gzip

    monkeypatch.setattr(apart, "LEAST_MEMORY", 2**20)
    file = tmp_path / "bomb.csv.gz"
    file.write_bytes(gzip.compress(b"0" * 2**22))
    with pytest.raises(InputError, match=r"bomb\.csv\.gz: unpacks to more than"):
        read_recording(file)


@pytest.mark.parametrize(
    "unit", ["10**10**10 rad", "rad^9^9^9", "(((9**99)**99)**99)*rad", "(" * 4000, "9" * 4000 + " rad"]
)
def test_a_tower_of_powers_is_no_unit(unit: str) -> None:
    begin = time.perf_counter()
    with pytest.raises(InputError):
        factor_to_si(unit, "position", prismatic=False)
    assert time.perf_counter() - begin < 5.0  # the table of units is loaded in a second


def test_powers_that_people_write_are_units() -> None:
    assert factor_to_si("2*pi/2**14 rad", "position", prismatic=False)[0] == pytest.approx(2 * np.pi / 16384)
    assert factor_to_si("1e-3*rad", "position", prismatic=False) == (1e-3, "rad")
    assert factor_to_si("kg*(m/s)^2", "effort", prismatic=False) == (1.0, "N*m")


CARRIED = '[[joint]]\nname="j"\ntype="revolute"\nparent="base"\nchild="l"\naxis=[0,1,0]\n[[link]]\nname="l"\n'
RIGID = CARRIED + "mass = {}\ncom = [0, 0, -1]\n"
BEAM = CARRIED + (
    "length = {}\ndirection = [0, 0, -1]\nbending = [1, 0, 0]\nsection = {{ width = {}, thickness = {} }}\n"
    "material = {{ youngs_modulus = 2e11, density = 7850 }}\nmodes = 1\n"
)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (RIGID.format("1" + "0" * 400), "model.toml:9: not valid TOML: 'mass' is a whole number beyond 64 bits"),
        (RIGID.format("1" + "0" * 5000), "not valid TOML"),
        (RIGID.format("1e101"), "model.toml:9: link 'l': 'mass' is 1e+101, beyond any mechanism"),
        (RIGID.format("1e16"), "model.toml:7: link 'l': mass of 1e+16 kg is beyond any mechanism"),
        (RIGID.format("1e-31"), "mass of 1e-31 kg is beyond any mechanism"),
        (RIGID.format("[" * 3000), "nested too deeply"),
        (BEAM.format("1", "1e300", "1"), "'width' is 1e+300, beyond any mechanism"),
        (BEAM.format("1", "1", "1e-300"), "'thickness' is 1e-300, beyond any mechanism"),
        (BEAM.format("1e-20", "1", "1"), "length of 1e-20 m is beyond any mechanism"),
    ],
)
def test_numbers_beyond_any_mechanism_are_refused(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "model.toml"
    file.write_text(text)
    with pytest.raises(InputError) as failure:
        harness.load(file)
    assert words in str(failure.value)


URDF = (
    '<robot name="r"><link name="base"/><link name="l"><inertial><mass value="{}"/><origin xyz="0 0 {}"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="j" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint></robot>'
)


@pytest.mark.parametrize(("mass", "height"), [("1e101", "1"), ("1", "1e10")])
def test_other_formats_refuse_them_as_well(tmp_path: Path, mass: str, height: str) -> None:
    file = tmp_path / "model.urdf"
    file.write_text(URDF.format(mass, height))
    with pytest.raises(InputError, match="beyond any mechanism"):
        harness.load(file)


MJCF = '<mujoco><worldbody><body quat="{}"><joint type="hinge" axis="{}"/><geom size="0.1" mass="1"/></body></worldbody></mujoco>'
TURNED = (
    '<robot name="r" version="1.1"><link name="base"/><link name="l"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous">'
    '<parent link="base"/><child link="l"/><origin quat_xyzw="{}"/><axis xyz="{}"/></joint></robot>'
)


@pytest.mark.parametrize(
    ("name", "text", "keys"), [("m.xml", MJCF, ("quat", "axis")), ("m.urdf", TURNED, ("quat_xyzw", "xyz"))]
)
def test_directions_whose_squares_overflow_are_refused(
    tmp_path: Path, name: str, text: str, keys: tuple[str, ...]
) -> None:
    """MuJoCo makes a quaternion of zeros of one such, and an axis of zeros of the other, and says nothing."""
    file = tmp_path / name
    for turn, axis, said in (("1 0 0 1e300", "0 1 0", keys[0]), ("1 0 0 0", "0 -1e300 1", keys[1])):
        file.write_text(text.format(turn, axis))
        with pytest.raises(InputError, match=f"{said}.*beyond any mechanism"):
            harness.load(file)


@pytest.mark.parametrize(
    ("length", "width", "thickness"), [("1", "1e300", "1"), ("1", "1", "1e-300"), ("1e-200", "1", "1")]
)
def test_an_audit_refuses_what_overflows(tmp_path: Path, length: str, width: str, thickness: str) -> None:
    """It reads tables that no system is made of, and undoes slips of a billion on top."""
    file = tmp_path / "model.toml"
    file.write_text(BEAM.format(length, width, thickness))
    with pytest.raises(InputError, match=r"link 'l': .* is beyond any mechanism"):
        audit(file)


def written(path: Path, time_: np.ndarray, angle: np.ndarray) -> Path:
    rows = "".join(f"{t!r},{q!r}\n" for t, q in zip(time_.tolist(), angle.tolist(), strict=True))
    path.write_text("time,pivot.position\n" + rows)
    return path


def test_readings_beyond_any_measurement(tmp_path: Path) -> None:
    angle = ANGLE.copy()
    angle[[7, 40]] = 1e24, 3.4e38
    recording = read_recording(written(tmp_path / "run.csv", TIME, angle))
    (note,) = [note for note in recording.quality if note.kind == "absurd"]
    assert note.count == 2
    assert "1e+24 rad" in note.what
    assert np.isnan(recording.channels[0].values[[7, 40]]).all()
    with pytest.raises(InputError, match=r"run.csv:2, column pivot.position: .* is beyond any measurement"):
        read_recording(written(tmp_path / "run.csv", TIME, ANGLE * 1e30))


@pytest.mark.parametrize(("factor", "words"), [(1e299, "time spans"), (1e-12, "time spans")])
def test_time_of_no_recording(tmp_path: Path, factor: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_recording(written(tmp_path / "run.csv", TIME * factor, ANGLE))
    late = TIME.copy()
    late[-1] = 1e299
    with pytest.raises(InputError, match=r"run.csv:121, column time"):
        read_recording(written(tmp_path / "run.csv", late, ANGLE))


def test_stamps_that_no_clock_tells_apart_are_one(tmp_path: Path) -> None:
    """Of 1e-310 s an interval has no inverse."""
    time_ = TIME.copy()
    time_[1] = 1e-310
    recording = read_recording(written(tmp_path / "run.csv", time_, ANGLE))
    assert len(recording.time) == len(TIME) - 1


def test_messages_hold_nothing_that_a_terminal_obeys() -> None:
    told_ = str(InputError("\x1b[2J" + 5000 * "a", mend="mend it"))
    assert "\x1b" not in told_
    assert len(told_) < 1100
    assert told_.endswith("(mend it)")


def test_no_room_to_unpack(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import gzip

    from harness.recording.formats import detect

    def full(file: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setitem(detect.PACKED, b"\x1f\x8b", ("gzip file", full))
    file = tmp_path / "run.csv.gz"
    file.write_bytes(gzip.compress(b"time,pivot.position\n"))
    with pytest.raises(InputError, match="there is no room to unpack it"):
        read_recording(file)


def test_the_kinds_are_all_read() -> None:
    """Every reader of ``detect`` that damage can reach has a kind here."""
    assert set(READ) | set(RECORDINGS) == set(KINDS)
    assert {"parquet", "hdf5", "matlab", "netcdf", "numpy_arrays", "mcap", "rosbag"} == set(apart.KINDS)
    assert set(reader_process.KINDS) == set(apart.KINDS)


GROWN = (
    '<mujoco>{}<worldbody><body name="b"><joint axis="0 1 0"/><geom size="0.1" mass="1" pos="0 0 -1"/>{}</body></worldbody>'
    "</mujoco>"
)


def mjcf(tmp_path: Path, top: str = "", body: str = "") -> Path:
    file = tmp_path / "model.xml"
    file.write_text(GROWN.format(top, body))
    return file


THREE = '<replicate count="3" offset="1 0 0"><body><joint axis="0 1 0"/><geom size="0.1"/></body></replicate>'


@pytest.mark.parametrize(
    ("instead", "said"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", r"MuJoCo crashes on it \(SIGSEGV\)"),
        ("import time; time.sleep(60)", "MuJoCo does not load it within 1 s"),
    ],
)
def test_a_trial_that_crashes_or_never_ends_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, instead: str, said: str
) -> None:
    """In the place of a document that ends MuJoCo, something that ends the trial's process."""
    monkeypatch.setattr(mjcf_trial, "LONGEST", 1)
    monkeypatch.setattr(mjcf_trial, "_START", instead)
    with pytest.raises(InputError, match=rf"model\.xml: {said}"):
        harness.load(mjcf(tmp_path, body=THREE))


def test_models_that_grow_a_little_are_read(tmp_path: Path) -> None:
    assert len(harness.load(mjcf(tmp_path, body=THREE)).coordinate_names) == 4


def test_painted_textures_are_not_made(tmp_path: Path) -> None:
    """Nothing moves otherwise for them, and their sizes are what a file asks for."""
    painted = '<asset><texture name="t" type="2d" builtin="flat" width="64" height="64"/></asset>'
    assert compiled(mjcf(tmp_path, painted)).ntex == 0


@pytest.mark.parametrize(
    "geom", ['size="1e200" density="1"', 'size="0.1" mass="1" pos="nan 0 0"', 'size="0.1" density="1e300"']
)
def test_mjcf_of_what_no_body_has_is_refused(tmp_path: Path, geom: str) -> None:
    file = tmp_path / "model.xml"
    file.write_text(f'<mujoco><worldbody><body><joint axis="0 1 0"/><geom {geom}/></body></worldbody></mujoco>')
    with pytest.raises(InputError, match=r"beyond any mechanism|NaN or infinite"):
        harness.load(file)


@pytest.mark.parametrize("mass", ["1_0", "\u0661", "0x10", "1,5"])
def test_numbers_that_no_other_reader_takes(tmp_path: Path, mass: str) -> None:
    """Python reads 1_0 as ten; urdfdom and MuJoCo do not."""
    file = tmp_path / "model.urdf"
    file.write_text(URDF.format(mass, "1"), encoding="utf-8")
    with pytest.raises(InputError, match="is not a number"):
        harness.load(file)


@pytest.mark.parametrize("cell", ["\u0660.\u0667", "0_1.7"])
def test_what_python_alone_reads_is_no_number_of_a_table(tmp_path: Path, cell: str) -> None:
    file = written(tmp_path / "run.csv", TIME, ANGLE)
    file.write_text(file.read_text().replace("0.7", cell, 1), encoding="utf-8")
    with pytest.raises(InputError, match="is not a number"):
        read_recording(file)


def test_what_stands_twice_in_a_urdf_is_told(tmp_path: Path) -> None:
    file = tmp_path / "model.urdf"
    file.write_text(URDF.format("1", "1").replace("<mass", '<mass value="1"/><mass', 1))
    assert "link 'l': of 2 <mass> the first counts" in harness.load(file).notes


def test_an_archive_in_an_archive_ends_somewhere(tmp_path: Path) -> None:
    import gzip

    content = b"time,pivot.position\n"
    for _ in range(1200):
        content = gzip.compress(content, 1, mtime=0)
    file = tmp_path / "run.csv.gz"
    file.write_bytes(content)
    with pytest.raises(InputError, match=r"run\.csv\.gz: is packed more than 4 times over"):
        read_recording(file)


def test_half_a_letter_in_json(tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    valid = valid_file("results.json", tmp_path).decode()
    file.write_text(valid.replace('"note": ""', '"note": "\\ud83d\\ude00"', 1))
    assert read_results(file).rows[0].note == "\U0001f600"
    file.write_text(valid.replace('"note": ""', '"note": "\\ud800"', 1))
    with pytest.raises(InputError, match="half a letter"):
        read_results(file)
