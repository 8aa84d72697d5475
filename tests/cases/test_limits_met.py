"""Which limits act in a single run, and that none is missed; against MuJoCo's run of the file itself where it is an MJCF."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.cases.single_run import SingleRun, run_once

TIME = np.linspace(0.0, 2.0, 1001)
# A pendulum of 1 kg at 0.2 m, which swings through in 1 s and is let go at 1 rad.
MJCF = """<mujoco><compiler angle="radian"/><option timestep="1e-4" integrator="RK4">{option}</option><worldbody><body name="p">
<joint name="h" axis="0 1 0" {joint}/><inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></worldbody></mujoco>"""
TOML = """
[[joint]]
name = "h"
type = "revolute"
parent = "base"
child = "p"
axis = [0, 1, 0]
limits = {{ {limits} }}
[[link]]
name = "p"
mass = 1.0
com = [0, 0, -0.2]
inertia = [0.01, 0.01, 0.001]
"""
FOLLOWER = """
[[joint]]
name = "i"
type = "revolute"
parent = "p"
child = "q"
origin = { xyz = [0, 0, -0.4] }
axis = [0, 1, 0]
mimic = { joint = "h", multiplier = -2.0, offset = 0.1 }
limits = { lower = -1.5, upper = 1.5 }
[[link]]
name = "q"
mass = 0.1
inertia = [0.001, 0.001, 0.001]
"""


def loaded(folder: Path, text: str, name: str) -> harness.System:
    (folder / name).write_text(text)
    return harness.load(folder / name)


def run(system: harness.System, time: np.ndarray = TIME) -> SingleRun:
    return run_once(system, time, {"h": 1.0}, {}, command={}, limits=True)


def mujocos(text: str) -> np.ndarray:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = 1.0
    course = [1.0]
    for _ in TIME[1:]:
        mujoco.mj_step(model, data, nstep=20)
        course.append(float(data.qpos[0]))
    return np.array(course)


@pytest.mark.parametrize(
    ("joint", "option", "lowest"),
    [
        ('range="-0.6 2" margin="0.25"', "", -0.4),  # MuJoCo pushes from -0.35 on
        ('range="-0.6 2"', '<flag limit="disable"/>', -1.0),
        ('range="-0.6 2"', '<flag constraint="disable"/>', -1.0),
    ],
)
def test_limits_act_where_mujoco_has_them_act(tmp_path: Path, joint: str, option: str, lowest: float) -> None:
    text = MJCF.format(joint=joint, option=option)
    expected = mujocos(text)
    assert expected.min() == pytest.approx(lowest, abs=0.06)
    found = run(loaded(tmp_path, text, "model.xml"))
    assert np.abs(found.columns["h.position"] - expected).max() < 1e-3
    (told,) = (note for note in found.notes if "reaches its limit" in note)
    assert ("and runs through it: the file switches limits off" in told) == (lowest == -1.0)


def test_a_margin_is_told_and_may_leave_no_range(tmp_path: Path) -> None:
    system = loaded(tmp_path, MJCF.format(joint='range="-0.6 2" margin="0.25"', option=""), "model.xml")
    assert any("its margin of 0.25 shortens its range to -0.35 … 1.75" in note for note in system.notes)
    system = loaded(tmp_path, MJCF.format(joint='range="-0.6 2" margin="1.5"', option=""), "model.xml")
    assert any("to none: its limits are left out" in note for note in system.notes)
    assert not system.limits


def test_a_limit_on_one_side_alone_acts(tmp_path: Path) -> None:
    """As one on both sides does whose other end the motion never meets."""
    both = run(loaded(tmp_path, TOML.format(limits="lower = -0.4, upper = 3.0"), "both.toml"))
    one = run(loaded(tmp_path, TOML.format(limits="lower = -0.4"), "one.toml"))
    assert -0.5 < one.columns["h.position"].min() < -0.4  # the free swing goes to -1
    np.testing.assert_allclose(one.columns["h.position"], both.columns["h.position"], atol=1e-9)
    assert one.notes == both.notes != ()


@pytest.mark.parametrize("engine", ["denoc", "mujoco"])
def test_a_limit_met_between_two_samples_is_not_missed(tmp_path: Path, engine: str) -> None:
    """Once a second the swing of one second is seen where it began, at 1 rad."""
    system = loaded(tmp_path, TOML.format(limits="lower = -0.4, upper = 3.0"), "model.toml")
    fine = run_once(system, TIME, {"h": 1.0}, {}, engine=engine, command={}, limits=True)
    coarse = run_once(system, TIME[::500], {"h": 1.0}, {}, engine=engine, command={}, limits=True)
    assert fine.columns["h.position"].min() > -0.5
    np.testing.assert_allclose(coarse.columns["h.position"], fine.columns["h.position"][::500], atol=1e-4)
    assert any("reaches its limit of -0.4 rad" in note for note in coarse.notes)


def test_efforts_are_the_same_where_limits_are_looked_for_between_samples(tmp_path: Path) -> None:
    """A torque of 5 N·m in the second half of the first of two intervals would be met nowhere else."""
    system = loaded(tmp_path, TOML.format(limits="lower = -4.0, upper = 0.3"), "model.toml")
    coarse = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    for pushed, meets in ((1, True), (4, False)):  # what begins with the last sample acts no longer
        tau = np.zeros((5, 1))
        tau[pushed] = 5.0
        found = run_once(system, coarse, {}, {}, tau=tau, limits=True)
        assert any("reaches its limit" in note for note in found.notes) == meets


def test_limits_of_a_joint_that_follows_are_told_not_to_act(tmp_path: Path) -> None:
    """From 0.1 - 2 · 1 rad at the start; -1.5 … 1.5 of the follower are 0.8 … -0.7 of its leader."""
    system = loaded(tmp_path, TOML.format(limits="lower = -3.0, upper = 3.0") + FOLLOWER, "model.toml")
    found = run(system)
    assert found.notes == (
        "joint 'i' reaches its limit of -1.5 rad at 0 s, and runs through it: it follows joint 'h', whose limits alone act",
    )
    assert not run_once(system, TIME, {"h": 0.5}, {}, limits=True).notes


def test_limits_of_one_position_are_told(tmp_path: Path) -> None:
    found = run(loaded(tmp_path, TOML.format(limits="lower = 0.0, upper = 0.0"), "model.toml"))
    assert found.notes == ("joint 'h': its limits leave no room (0 … 0) and do not act",)
