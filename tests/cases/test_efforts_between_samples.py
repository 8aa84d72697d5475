"""Efforts that hold between samples, and efforts that run straight, against the speed of a free mass."""

import numpy as np
import pytest

from harness.cases.single_run import drive_from, run_once
from harness.errors import InputError
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

MASS, RISE, COARSE = 2.0, 3.0, 0.1  # kg, N/s, s between the file's samples
SLIDER = System(
    "slider",
    (Joint("rail", JointType.PRISMATIC, "base", "cart", axis=constant([1.0, 0.0, 0.0])),),
    (Link("cart", MASS, constant([0.0, 0.0, 0.0]), constant(0.01 * np.eye(3))),),
)


@pytest.fixture
def ramp(tmp_path):
    """A force that grows as ``RISE`` · t, sampled coarsely."""
    file = tmp_path / "effort.csv"
    file.write_text("time,rail.effort\n" + "".join(f"{COARSE * k:.1f},{RISE * COARSE * k:.1f}\n" for k in range(11)))
    return file


@pytest.mark.parametrize("engine", ["denoc", "mujoco", "pinocchio"])
@pytest.mark.parametrize("rate", [10, 100])
def test_a_measured_effort_runs_straight_between_its_samples(ramp, engine, rate):
    time = np.arange(rate + 1) / rate
    tau = drive_from(ramp, time, SLIDER, hold="linear").tau
    assert np.allclose(tau[:, 0], RISE * time, rtol=0.0, atol=1e-12)
    run = run_once(SLIDER, time, {}, {}, engine=engine, tau=tau, hold="linear", step=1e-3)
    # m v = RISE t²/2, whatever the samples; what is recorded is the effort itself.
    assert np.allclose(run.columns["rail.velocity"], RISE * time**2 / (2.0 * MASS), rtol=0.0, atol=1e-9)
    assert np.array_equal(run.columns["rail.effort"], tau[:, 0])


def test_a_command_holds_until_the_next(ramp):
    time = np.arange(101) / 100
    tau = drive_from(ramp, time, SLIDER).tau
    run = run_once(SLIDER, time, {}, {}, tau=tau)
    # Each of the ten is held for 0.1 s: m v(1 s) = RISE · 0.1² · (0 + 1 + … + 9).
    assert run.columns["rail.velocity"][-1] == pytest.approx(RISE * COARSE**2 * 45.0 / MASS, abs=1e-9)


def test_what_has_no_such_joint_is_refused(ramp):
    ramp.write_text("time,nowhere.effort\n0,1\n1,1\n")
    with pytest.raises(InputError, match="no movable joint 'nowhere'"):
        drive_from(ramp, np.arange(2.0), SLIDER, hold="linear")
