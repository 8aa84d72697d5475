"""What acts in a single run beside the description: drives, limits, keyframes; against MuJoCo's run of the file itself."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from click.testing import CliRunner

import harness
from harness.cases.acting import bounded, driven, keyframe
from harness.cases.single_run import run_once
from harness.cli.simulate import simulate
from harness.errors import InputError
from harness.system import random_chain, write

TIME = np.linspace(0.0, 2.0, 1001)
BODY = """<mujoco><compiler angle="radian"/><option timestep="1e-4" integrator="RK4"/><worldbody><body name="p">
<joint name="h" axis="0 1 0" {joint}/><inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></worldbody>
{rest}</mujoco>"""
KEY = '<keyframe><key name="up" qpos="1.1" qvel="-0.5" ctrl="0.3"/></keyframe>'


def load(folder: Path, joint: str = "", rest: str = "") -> tuple[harness.System, mujoco.MjModel]:
    text = BODY.format(joint=joint, rest=rest)
    (folder / "model.xml").write_text(text)
    return harness.load(folder / "model.xml"), mujoco.MjModel.from_xml_string(text)


def theirs(model: mujoco.MjModel, q: float, qd: float, command: float = 0.0) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.ctrl[:] = q, qd, command
    run = [q]
    for _ in TIME[1:]:
        mujoco.mj_step(model, data, nstep=20)
        run.append(float(data.qpos[0]))
    return np.array(run)


DRIVES = {
    "servo": ('kp="17.8" kv="0.5" gear="2"', "position", 1e-7),
    "servo within a range": ('kp="17.8" gear="2" forcerange="-1 1"', "position", 1e-6),
    "servo within an uneven range": ('kp="17.8" kv="0.2" forcerange="-0.5 2"', "position", 1e-6),
    "velocity": ('kv="0.7"', "velocity", 1e-7),
    "back-EMF": ('nominal="12 1 100" gear="10"', "dcmotor", 1e-7),
}


@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize("runner", ["denoc", "mujoco", "pinocchio"])
@pytest.mark.parametrize("command", [0.6])
def test_a_drive_moves_its_joint_as_in_mujoco(tmp_path: Path, name: str, runner: str, command: float) -> None:
    attributes, kind, allowed = DRIVES[name]
    system, model = load(tmp_path, 'damping="0.1"', f'<actuator><{kind} name="a" joint="h" {attributes}/></actuator>')
    run = run_once(system, TIME, {"h": 1.0}, {"h": 0.4}, engine=runner, command={"a": command})
    found = np.abs(run.columns["h.position"] - theirs(model, 1.0, 0.4, command)).max()
    assert found < (
        10.0 * allowed if runner == "mujoco" else allowed
    )  # a fixed step of 0.1 ms, or 1 ms without a range
    assert any(f"its command held at {command:g}" in note for note in run.notes)


def test_without_actuators_nothing_drives(tmp_path: Path) -> None:
    system, _ = load(tmp_path, "", '<actuator><position joint="h" kp="30"/></actuator>')
    _, plain = load(tmp_path)
    run = run_once(system, TIME, {"h": 1.0}, {}, command=None)
    assert np.abs(run.columns["h.position"] - theirs(plain, 1.0, 0.0)).max() < 1e-7


def test_a_given_effort_takes_the_drives_place(tmp_path: Path) -> None:
    system, _ = load(tmp_path, "", '<actuator><position name="a" joint="h" kp="30"/></actuator>')
    run = run_once(system, TIME, {"h": 1.0}, {}, tau=np.zeros((len(TIME), 1)), command={})
    assert any("'a' is left out: the effort of joint 'h' is given" in note for note in run.notes)


def test_two_drives_of_one_joint_that_no_spring_is_act_each_within_its_range(tmp_path: Path) -> None:
    rest = '<actuator><position joint="h" kp="3" forcerange="-1 1"/><position joint="h" kp="4" forcerange="-1 1"/></actuator>'
    system, model = load(tmp_path, "", rest)
    assert len(driven(system, {})[0].drives) == 2
    for runner in ("denoc", "pinocchio"):
        run = run_once(system, TIME, {"h": 1.0}, {}, engine=runner, command={})
        assert np.abs(run.columns["h.position"] - theirs(model, 1.0, 0.0)).max() < 1e-6


LIMITS = {
    "both ends": ('range="-0.35 0.35"', 4.0, 0.0),
    "softer": ('range="-0.5 0.3" solreflimit="0.05 0.7" solimplimit="0.8 0.8 0.001"', -5.0, 0.1),
    "stiffness and damping outright": ('range="-0.4 0.4" solreflimit="-900 -30"', 4.0, 0.0),
    "not about zero": ('range="0.3 1.2"', -3.0, 0.6),
}


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("runner", ["denoc", "mujoco"])
def test_limits_hold_as_softly_as_mujocos(tmp_path: Path, name: str, runner: str) -> None:
    """Ours have one impedance; MuJoCo's grows over the first thousandth of a radian, worth a tenth of a milliradian or two."""
    joint, speed, start = LIMITS[name]
    system, model = load(tmp_path, joint)
    run = run_once(system, TIME, {"h": start}, {"h": speed}, engine=runner, command={}, limits=True)
    reference = theirs(model, start, speed)
    low, high = model.jnt_range[0]
    assert reference.max() > high or reference.min() < low  # the limit is met
    assert np.abs(run.columns["h.position"] - reference).max() < 1e-3
    assert sum("reaches its limit" in note for note in run.notes) == 1


def test_ends_far_from_zero_are_the_same_ends_moved(tmp_path: Path) -> None:
    """In the native runs a range that does not enclose zero is moved; seen from a frame turned by as much, it does."""
    system, _ = load(tmp_path, 'range="0.3 1.2" ref="0.9"')
    moved, _ = load(tmp_path, 'range="-0.6 0.3"')
    a = run_once(system, TIME, {"h": 1.0}, {"h": 2.0}, command={}, limits=True).columns["h.position"]
    b = run_once(moved, TIME, {"h": 0.1}, {"h": 2.0}, command={}, limits=True).columns["h.position"]
    np.testing.assert_allclose(a - 0.9, b, atol=1e-7)


def test_few_samples_make_no_other_motion(tmp_path: Path) -> None:
    """Where a joint crosses its whole range between two samples, the run looks closer by itself."""
    system, _ = load(tmp_path, 'range="-0.1 0.1"')
    fine = run_once(system, TIME, {}, {"h": 6.0}, command={}, limits=True).columns["h.position"]
    coarse = run_once(system, TIME[::50], {}, {"h": 6.0}, command={}, limits=True).columns["h.position"]
    np.testing.assert_allclose(coarse, fine[::50], atol=1e-6)


def test_limits_of_several_joints(tmp_path: Path) -> None:
    """A chain whose file says nothing of softness has MuJoCo's defaults, in both engines."""
    path = tmp_path / "chain.urdf"
    system = random_chain(3, seed=11, prismatic=0.0, armature=False, damping=True)
    for joint in system.joints:
        system = system.replace_joint(replace(joint, lower=-0.4, upper=0.5))
    write(system, path)
    system = harness.load(path)
    runs = [
        run_once(system, TIME, {}, {}, engine=name, command={}, limits=True, step=2e-5 if name == "mujoco" else None)
        for name in ("denoc", "mujoco")
    ]
    for name in system.joint_names:
        course = [run.columns[f"{name}.position"] for run in runs]
        assert np.abs(course[0] - course[1]).max() < 2e-3
        assert course[0].max() < 0.7
        assert course[0].min() > -0.6
    assert len(bounded(system).stops) == 3


def test_a_motion_inside_its_limits_is_the_one_without(tmp_path: Path) -> None:
    system, _ = load(tmp_path, 'range="-2 2"')
    a, b = (run_once(system, TIME, {"h": 1.0}, {}, command={}, limits=limits) for limits in (True, False))
    np.testing.assert_array_equal(a.columns["h.position"], b.columns["h.position"])


def test_an_engine_without_limits_says_so(tmp_path: Path) -> None:
    system, _ = load(tmp_path, 'range="-0.3 0.3"')
    run = run_once(system, TIME, {}, {"h": 4.0}, engine="pinocchio", command={}, limits=True)
    assert any("the motion runs through them: Pinocchio cannot express limits" in note for note in run.notes)


def test_the_verb_starts_where_the_file_says(tmp_path: Path) -> None:
    rest = f'<actuator><position name="a" joint="h" kp="3"/></actuator>{KEY}'
    _, model = load(tmp_path, "", rest)
    arguments = [str(tmp_path / "model.xml"), "--duration", "2", "--rate", "500", "--json", "-"]
    result = CliRunner().invoke(simulate, [*arguments, "--keyframe", "up"], standalone_mode=False)
    assert result.exception is None
    document = json.loads(result.stdout)
    assert document["final"]["h.position"] == pytest.approx(theirs(model, 1.1, -0.5, 0.3)[-1], abs=1e-7)
    assert any(note.startswith("starts from keyframe 'up', h = 1.1, d(h)/dt = -0.5") for note in document["notes"])
    assert "denoc: note: starts from keyframe 'up'" in result.stderr
    plain = json.loads(CliRunner().invoke(simulate, arguments, standalone_mode=False).stdout)
    assert plain["final"]["h.position"] == 0.0
    with pytest.raises(InputError, match="no keyframe is named 'down'"):
        keyframe(harness.load(tmp_path / "model.xml"), "down")


def test_qpos0_is_the_models_own_start(tmp_path: Path) -> None:
    system, _ = load(tmp_path, 'ref="0.4"')
    assert keyframe(system, "qpos0").position == {"h": 0.4}


FOLLOWED = """<mujoco><compiler angle="radian"/><option timestep="2e-5"/><worldbody>
<body name="p"><joint name="h" axis="0 1 0" damping=".05"/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/><body name="q" pos="0 0 -.4"><joint name="i" axis="0 1 0"/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></body></worldbody><equality><joint joint1="i" joint2="h"
polycoef="0.1 -1.5 0 0 0" solref="0.0005 1" solimp=".9999 .9999 .001"/></equality><keyframe><key name="on" qpos="0.4 -0.5"
qvel="1 -1.5"/><key name="off" qpos="0.4 0.3"/></keyframe></mujoco>"""


def test_a_run_begins_with_a_keyframe_of_joints_that_follow(tmp_path: Path) -> None:
    """As MuJoCo's run from it does; one that does not keep to the equality is told where it begins."""
    path, out = tmp_path / "model.xml", tmp_path / "run.csv"
    path.write_text(FOLLOWED)
    options = [str(path), "--duration", "1", "--rate", "10", "--out", str(out), "--keyframe"]
    assert CliRunner().invoke(simulate, [*options, "on"]).exit_code == 0
    run = np.genfromtxt(out, delimiter=",", names=True)
    model = mujoco.MjModel.from_xml_string(FOLLOWED)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=50000)
    assert run["hposition"][[0, -1]] == pytest.approx([0.4, data.qpos[0]], abs=2e-4)
    assert run["iposition"][[0, -1]] == pytest.approx([-0.5, data.qpos[1]], abs=2e-4)
    said = CliRunner().invoke(simulate, [*options, "off"])
    assert said.exit_code == 0
    assert "keyframe 'off' has joint 'i' at 0.3 rad; it follows joint 'h' and begins at -0.5" in said.output
    assert CliRunner().invoke(simulate, [*options, "qpos0"]).exit_code == 0
