"""Effort files: time from their first sample, in any dress of a recording, and what never acts is told."""

import numpy as np
import pytest

from harness.cases.single_run import drive_from, run_once
from harness.cli.main import status_of
from harness.errors import InputError
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

MASS = 2.0
SLIDER = System(
    "slider",
    (Joint("rail", JointType.PRISMATIC, "base", "cart", axis=constant([1.0, 0.0, 0.0])),),
    (Link("cart", MASS, constant([0.0, 0.0, 0.0]), constant(0.01 * np.eye(3))),),
)
TIME = np.arange(2001) / 1000.0


def write(folder, start, header="time,rail.effort", low=0.5, high=1.5, force=3.0):
    file = folder / "effort.csv"
    stamps = 0.01 * np.arange(201)
    values = np.where((stamps >= low - 1e-9) & (stamps < high - 1e-9), force, 0.0)
    file.write_text(header + "\n" + "".join(f"{start + t:.4f},{v}\n" for t, v in zip(stamps, values, strict=True)))
    return file


@pytest.mark.parametrize("start", [0.0, 12.34, -5.0, 1695196914.0])
def test_time_is_counted_from_the_first_sample(tmp_path, start):
    drive = drive_from(write(tmp_path, start), TIME, SLIDER)
    run = run_once(SLIDER, TIME, {}, {}, tau=drive.tau)
    # A force F for 1 s: m v = F · 1 s.
    assert run.columns["rail.velocity"][-1] == pytest.approx(3.0 / MASS, abs=1e-9)
    assert drive.notes == ()


def test_a_foreign_unit_and_a_further_column(tmp_path):
    file = write(tmp_path, 0.0, "Time [s],rail.effort [kN]")
    assert drive_from(file, TIME, SLIDER).tau.max() == 3000.0


def test_what_never_acts_is_told(tmp_path):
    drive = drive_from(write(tmp_path, 0.0, force=0.0), TIME, SLIDER)
    assert [note.words() for note in drive.notes] == ["rail.effort: is 0 throughout; the joint is not driven"]
    drive = drive_from(write(tmp_path, 0.0), TIME[:401], SLIDER)
    assert [note.words() for note in drive.notes] == [
        "rail.effort: is 0 until 0.5 s, after the run of 0.4 s has ended; the joint is not driven"
    ]
    drive = drive_from(write(tmp_path, 0.0), np.arange(3001) / 1000.0, SLIDER)
    assert [note.words() for note in drive.notes] == [
        "time: the file ends at 2 s, the run at 3 s; no effort after that"
    ]


def test_what_cannot_be_used_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"has no column <joint>\.effort"):
        drive_from(write(tmp_path, 0.0, "time,rail.position"), TIME, SLIDER)
    with pytest.raises(InputError, match="no movable joint 'nowhere'"):
        drive_from(write(tmp_path, 0.0, "time,nowhere.effort"), TIME, SLIDER)
    with pytest.raises(InputError, match=r"unit 'N\*m' does not fit an effort"):
        drive_from(write(tmp_path, 0.0, "time,rail.effort [N*m]"), TIME, SLIDER)


@pytest.mark.parametrize("rate", [0.5, 1.0, 3.0, 7.0, 1000.0])
@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_few_samples_of_a_run_leave_out_nothing_of_its_efforts(tmp_path, rate, hold):
    """3 N from 0.5 to 1.5 s on 2 kg: 1.5 m/s then; 0.75 m by then, and 1.5 m at 2 s. Straight edges begin 10 ms earlier."""
    early = 0.005 if hold == "linear" else 0.0  # [s] on the mean
    force, end = write(tmp_path, 0.0), tmp_path / "run.csv"
    model = tmp_path / "slider.toml"
    model.write_text(
        '[[joint]]\nname = "rail"\ntype = "prismatic"\nparent = "base"\nchild = "cart"\naxis = [1, 0, 0]\n'
        '[[link]]\nname = "cart"\nmass = 2.0\ninertia = [0.01, 0.01, 0.01]\n'
    )
    assert status_of(
        ["simulate", str(model), "--effort", str(force), "--hold", hold, "--duration", "2", "--rate", str(rate), "--out", str(end)]
    ) == 0  # fmt: skip
    run = np.genfromtxt(end, delimiter=",", names=True)
    assert len(run) == int(2.0 * rate) + 1
    last = run["time"][-1]
    assert run["railvelocity"][-1] == pytest.approx(1.5, abs=1e-9)
    assert run["railposition"][-1] == pytest.approx(1.5 - 1.5 * (2.0 - last) + 1.5 * early, abs=1e-9)
