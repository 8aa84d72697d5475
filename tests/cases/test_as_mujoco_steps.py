"""Single runs of an MJCF against MuJoCo stepping the file itself by RK4 with a small step: what acts there acts here."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.cases.acting import keyframe
from harness.cases.single_run import run_once
from harness.errors import UnsupportedError

RATE, DURATION, STEP = 100, 0.6, 5e-5
CHAIN = """<mujoco><compiler angle="radian"/><worldbody><body name="a" {a}><joint name="h" axis="0 1 0" {h}/>
<inertial pos="0 0 -.1" mass="1" diaginertia=".01 .01 .001"/><body name="b" pos="0 0 -.2" {b}><joint name="i" axis="0 1 0" {i}/>
<inertial pos="0 .01 -.1" mass=".5" diaginertia=".004 .004 .0005"/><body name="c" pos="0 0 -.2">
<joint name="s" type="slide" axis="0 0 1" stiffness="200" damping="1" {s}/>
<inertial pos="0 0 -.03" mass=".2" diaginertia=".001 .001 .0005"/></body></body></body></worldbody>{rest}</mujoco>"""
KEY = '<keyframe><key name="k" qpos="0.4 -0.3 0.02" qvel="0.1 0.2 0" ctrl="{ctrl}"/></keyframe>'


def write(folder: Path, **parts: str) -> Path:
    path = folder / "model.xml"
    path.write_text(CHAIN.format(**{**dict.fromkeys(("a", "b", "h", "i", "s", "rest"), ""), **parts}))
    return path


def theirs(path: Path, key: str | None = None, **start: float) -> tuple[mujoco.MjModel, np.ndarray]:
    """MuJoCo's positions (T, nq) of the file; start: positions by joint where no keyframe says so."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, STEP
    data = mujoco.MjData(model)
    if key is not None:
        mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    for name, value in start.items():
        data.qpos[model.joint(name).qposadr[0]] = value
    run = [np.array(data.qpos)]
    for _ in range(round(DURATION * RATE)):
        mujoco.mj_step(model, data, nstep=round(1 / RATE / STEP))
        run.append(np.array(data.qpos))
    return model, np.array(run)


def apart(path: Path, engine: str, key: str | None = None, **start: float) -> float:
    """Largest difference of a joint's position [rad or m] between a single run of ours and MuJoCo's own."""
    system = harness.load(path)
    frame = keyframe(system, key or "qpos0")
    time = np.arange(round(DURATION * RATE) + 1) / RATE
    position = {**(frame.position if key else {}), **{n: v for n, v in start.items() if n in system.coordinate_names}}
    command = frame.command if key else {}
    run = run_once(system, time, position, frame.velocity, engine=engine, command=command, limits=True)
    model, course = theirs(path, key, **start)
    columns = {model.joint(k).name: int(model.jnt_qposadr[k]) for k in range(model.njnt)}
    assert np.ptp(course, axis=0).max() > 0.05  # it moves
    return max(float(np.abs(run.columns[f"{name}.position"] - course[:, at]).max()) for name, at in columns.items())


ACTS = {
    "compensation by body": {"a": 'gravcomp="1"', "b": 'gravcomp="0.5"'},
    "more than its weight, and less than none": {"a": 'gravcomp="1.5"', "b": 'gravcomp="-0.3"'},
    "polynomials": {
        "h": 'damping=".05 .02 .01" stiffness=".5 .4 .3" springref=".3"',
        "i": 'damping=".01 0 .005" stiffness="0 .6 .5"',
        "s": "",
    },
    "drag that feeds energy in": {"h": 'damping="0.3 -0.02 0"'},
    "two servos with ranges at a joint": {
        "rest": '<actuator><position name="p" joint="h" kp="8" forcerange="-2 2"/>'
        '<velocity name="v" joint="h" kv=".3" forcerange="-1 1"/></actuator>'
    },
    "a range of all actuators of a joint": {
        "h": 'actuatorfrcrange="-.7 .9"',
        "rest": '<actuator><position name="p" joint="h" kp="8"/><velocity name="v" joint="h" kv=".3"/></actuator>',
    },
    "a bias": {
        "rest": '<actuator><general name="g" joint="i" gainprm="2" biastype="affine" biasprm=".3 -1 -.1" '
        'gear="-2" forcerange="-.5 .4"/></actuator>'
    },
    "a gain that changes with position and velocity": {
        "rest": '<actuator><general name="g" joint="i" gaintype="affine" gainprm="2 .8 -.3" biastype="affine" '
        'biasprm=".3 -1 -.1" gear="-1.5"/><damper name="d" joint="h" kv=".4" ctrlrange="0 1"/></actuator>'
    },
    "all at once": {
        "a": 'gravcomp="1"',
        "h": 'damping=".05 .02 .01" stiffness=".5 .4 .3"',
        "rest": '<actuator><position name="p" joint="h" kp="8" forcerange="-1 1"/></actuator>',
    },
}


@pytest.mark.parametrize("name", ACTS)
@pytest.mark.parametrize("engine", ["denoc", "mujoco", "pinocchio"])
def test_what_acts_in_the_file_acts_here(tmp_path: Path, name: str, engine: str) -> None:
    assert apart(write(tmp_path, **ACTS[name]), engine, h=1.0, i=-0.5) < 1e-6


@pytest.mark.parametrize("engine", ["denoc", "mujoco", "pinocchio"])
def test_commands_of_a_keyframe_are_kept_within_their_range(tmp_path: Path, engine: str) -> None:
    """A motor that is told 2.5 and may have 1 gives its gear's worth of 1."""
    rest = (
        '<actuator><position name="p" joint="h" kp="8" kv=".5" gear="1.5" forcerange="-2 2"/>'
        '<velocity name="v" joint="i" kv=".3" gear="-2"/><motor name="t" joint="s" gear="3" ctrlrange="-1 1"/></actuator>'
    )
    path = write(tmp_path, rest=rest + KEY.format(ctrl="0.5 1 2.5"))
    assert apart(path, engine, "k") < 1e-7


@pytest.mark.parametrize("engine", ["denoc", "mujoco", "pinocchio"])
def test_a_gain_that_changes_with_the_motion_acts_under_a_keyframes_command(tmp_path: Path, engine: str) -> None:
    """A negative spring, a damper, and a range of force that is met: (2 + 0.8 l − 0.3 l̇) · u + bias, l = gear · q."""
    rest = (
        '<actuator><general name="g" joint="i" gaintype="affine" gainprm="2 .8 -.3" biastype="affine" biasprm=".3 -1 -.1" '
        'gear="-1.5" forcerange="-2 1.5"/><damper name="d" joint="h" kv=".4" ctrlrange="0 .8"/></actuator>'
    )
    path = write(tmp_path, rest=rest + KEY.format(ctrl="1.7 1.5"))
    system = harness.load(path)
    assert sum("a gain that changes with the motion" in note for note in system.notes) == 2
    assert apart(path, engine, "k") < 1e-6


FOLLOWS = (
    '<equality><joint joint1="i" joint2="h" polycoef=".1 -.7 0 0 0" solref=".001 1" '
    'solimp=".9999 .9999 .001"/></equality>'
)


@pytest.mark.parametrize("engine", ["denoc", "mujoco", "pinocchio"])
def test_a_joint_equality_holds_as_a_constraint_on_coordinates(tmp_path: Path, engine: str) -> None:
    """MuJoCo's gives by what its impedance of 0.9999 leaves; ours is exact."""
    assert apart(write(tmp_path, rest=FOLLOWS), engine, h=0.5, i=0.1 - 0.7 * 0.5) < 2e-4


@pytest.mark.parametrize("engine", ["denoc", "mujoco"])
def test_a_coupled_gripper_has_its_servo_and_limits(tmp_path: Path, engine: str) -> None:
    """A servo at the leader, the follower's own limit met: what MuJoCo lets give is a milliradian or less."""
    rest = f'<actuator><position name="p" joint="h" kp="8" kv=".4" forcerange="-2 2"/></actuator>{FOLLOWS}'
    path = write(tmp_path, h='range="-1 1"', i='range="-0.1 0.4"', rest=rest)
    assert apart(path, engine, h=0.25, i=0.1 - 0.7 * 0.25) < 2e-3


CURVE = (
    '<equality><joint joint1="i" joint2="h" polycoef=".1 -.5 .4 .3 -.2" solref=".001 1" '
    'solimp=".9999 .9999 .001"/></equality>'
)
SERVO = '<actuator><position name="p" joint="h" kp="8" kv=".4" forcerange="-2 2"/></actuator>'
CURVED = {
    "alone": ({}, 2e-4),
    "a servo": ({"rest": SERVO}, 2e-4),
    "polynomials": ({"h": 'damping=".05 .02 .01" stiffness=".5 .4 .3"', "i": 'damping=".01 0 .005"'}, 2e-4),
    "limits of both": ({"h": 'range="-.45 1"', "i": 'range="-0.1 0.4"', "rest": SERVO}, 2e-3),
    "dry friction of both": ({"h": 'frictionloss=".05"', "i": 'frictionloss=".03"'}, 2e-3),
}


@pytest.mark.parametrize("name", CURVED)
@pytest.mark.parametrize("engine", ["denoc", "mujoco"])
def test_a_joint_that_is_a_quartic_of_another_moves_as_in_mujoco(tmp_path: Path, name: str, engine: str) -> None:
    """MuJoCo's equality gives by what its impedance of 0.9999 leaves, and pulls back; ours is exact."""
    parts, allowed = CURVED[name]
    path = write(tmp_path, **{**parts, "rest": parts.get("rest", "") + CURVE})
    start = 0.5
    follows = 0.1 - 0.5 * start + 0.4 * start**2 + 0.3 * start**3 - 0.2 * start**4
    assert apart(path, engine, h=start, i=follows) < allowed


def test_a_joint_that_an_equality_locks_stays(tmp_path: Path) -> None:
    """An equality of one joint alone; the servo of another acts beside it."""
    lock = '<equality><joint joint1="i" polycoef="-.3" solref=".001 1" solimp=".9999 .9999 .001"/></equality>'
    path = write(tmp_path, rest=SERVO + lock)
    assert apart(path, "denoc", h=0.5, i=-0.3) < 2e-4


def test_servo_limits_and_damping_beside_a_free_joint(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(
        """<mujoco><compiler angle="radian"/><worldbody><body name="a"><freejoint name="r"/>
        <inertial pos="0 0 0" mass="1" diaginertia=".01 .01 .02"/><body name="b">
        <joint name="h" axis="0 1 0" range="-.3 .3" damping=".01 0 .01"/>
        <inertial pos="0 0 -.1" mass=".3" diaginertia=".001 .001 .001"/></body></body></worldbody>
        <actuator><position name="p" joint="h" kp="1" forcerange="-.2 .2"/></actuator></mujoco>"""
    )
    system = harness.load(path)
    time = np.arange(round(DURATION * RATE) + 1) / RATE
    _, course = theirs(path, h=0.29)
    for engine, allowed in (("denoc", 1e-8), ("mujoco", 1e-7)):
        run = run_once(system, time, {"h": 0.29}, {}, engine=engine, command={}, limits=True)
        assert np.abs(run.columns["h.position"] - course[:, 7]).max() < allowed
    thrown = run_once(system, time, {"h": 0.29}, {"h": 3.0}, command={}, limits=True)
    assert thrown.columns["h.position"].max() < 0.4
    assert any("reaches its limit" in note for note in thrown.notes)


def test_dry_friction_where_the_lanes_do_not_go_is_mujocos(tmp_path: Path) -> None:
    """A constraint as soft as MuJoCo's by default, beside a joint that follows and beside carried weight."""
    coupled = write(tmp_path, h='frictionloss=".3"', rest=FOLLOWS)
    system = harness.load(coupled)
    time = np.arange(round(DURATION * RATE) + 1) / RATE
    _, course = theirs(coupled, h=0.5, i=-0.25)
    for engine in ("mujoco", "pinocchio"):
        run = run_once(system, time, {"h": 0.5}, {}, engine=engine, command={}, limits=True)
        assert np.abs(run.columns["h.position"] - course[:, 0]).max() < 2e-3
    assert apart(write(tmp_path, a='gravcomp="1"', h='frictionloss=".3"'), "denoc", h=0.5, i=-0.4) < 2e-3


def test_what_a_bending_link_has_not_is_refused() -> None:
    from dataclasses import replace

    system = harness.load(Path("models/toml") / sorted(p.name for p in Path("models/toml").glob("*flexible*"))[0])
    lifted = system.replace_link(replace(system.links[0], gravcomp=0.5))
    with pytest.raises(UnsupportedError, match="gravity compensation"):
        harness.Denoc(lifted)
