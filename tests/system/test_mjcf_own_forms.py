"""MuJoCo's own forms of damping, stiffness, drives and compensation: what comes over acts as there, the rest is told."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.cases.acting import keyframe
from harness.engines.registry import engine
from harness.errors import InputError

BODY = """<mujoco><worldbody><body name="p" {body}><joint name="h" axis="0 1 0" {joint}/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></worldbody>{rest}</mujoco>"""
STATES = [(0.4, 1.0), (-0.7, -2.0), (1.3, 0.5)]


def load(folder: Path, *, body: str = "", joint: str = "", rest: str = "") -> tuple[harness.System, mujoco.MjModel]:
    text = BODY.format(body=body, joint=joint, rest=rest)
    path = folder / "model.xml"
    path.write_text(text)
    return harness.load(path), mujoco.MjModel.from_xml_string(text)


def acceleration(model: mujoco.MjModel, q: float, qd: float, command: float = 0.0) -> float:
    """What MuJoCo makes of the file itself."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.ctrl[:] = q, qd, command
    mujoco.mj_forward(model, data)
    return float(data.qacc[0])


# A gear of 3 counts squared for every coefficient of the actuator's damping: 0.5 · 9 v|v|, not 0.5 · 27.
COME_OVER = {
    "quadratic damping": {"joint": 'damping="0.3 0.5 0"'},
    "cubic stiffness": {"joint": 'stiffness="4 0 5"'},
    "armature and damping of a motor": {
        "rest": '<actuator><motor joint="h" gear="3" armature=".02" damping=".3 .5 0"/></actuator>'
    },
    "gravity compensation": {"body": 'gravcomp="0.7"'},
    "cubic damping": {"joint": 'damping=".1 0 2"'},
    "damping that feeds energy in": {"joint": 'damping=".1 -.3 .2"'},
    "one-sided stiffness": {"joint": 'stiffness="4 5 0"'},
    "a polynomial spring slack elsewhere": {"joint": 'stiffness="4 3 5" springref="10"'},
    "no linear term": {"joint": 'stiffness="0 3 -5" springref="-20"'},
}


@pytest.mark.parametrize("name", COME_OVER)
@pytest.mark.parametrize("runner", ["denoc", "mujoco", "pinocchio"])
def test_what_comes_over_acts_as_in_mujoco(tmp_path: Path, name: str, runner: str) -> None:
    system, theirs = load(tmp_path, **COME_OVER[name])
    ours = engine(runner).build(system)
    for q, qd in STATES:
        found = ours.forward_dynamics(np.array([q]), np.array([qd]), np.zeros(1))
        assert float(found[0]) == pytest.approx(acceleration(theirs, q, qd), rel=1e-11)


TOLD = {
    "one-sided stiffness": (
        {"joint": 'stiffness="4 5 0"'},
        "stiffness 5 x², x = position - 0, pulls to one side alone",
    ),
    "position servo": ({"rest": '<actuator><position joint="h" kp="17.8" gear="2"/></actuator>'}, "-71.2 · position"),
    "back-EMF": (
        {"rest": '<actuator><dcmotor joint="h" nominal="12 1 100" gear="10"/></actuator>'},
        "-1 · velocity",  # K²/R = 0.12² / 1.44 N·m·s/rad (stall 1 N·m at 12 V, 100 rad/s idle), times the gear squared
    ),
    "motor": ({"rest": '<actuator><motor joint="h"/></actuator>'}, "do nothing without a command"),
    # Times the gear squared: 0.5 · 3² v|v| (MuJoCo's own acceleration agrees, see "armature and damping of a motor").
    "motor with damping of its own": (
        {"rest": '<actuator><motor joint="h" gear="3" armature=".02" damping="0 .5 0"/></actuator>'},
        "without a command too, with damping -4.5 · v|v| (v: velocity of the joint) and armature 0.18 of its own",
    ),
    "activation": (
        {"rest": '<actuator><intvelocity joint="h" kp="3" actrange="-1 1"/></actuator>'},
        "a state of its own",
    ),
    "muscle": ({"rest": '<actuator><muscle joint="h" lengthrange="-1 1"/></actuator>'}, "left out"),
}


def test_a_motor_with_damping_is_not_said_to_do_nothing(tmp_path: Path) -> None:
    system, _ = load(tmp_path, rest='<actuator><motor name="m" joint="h" damping="0 .5 0"/></actuator>')
    assert not any("do nothing without a command" in note for note in system.notes)


@pytest.mark.parametrize("name", TOLD)
def test_what_does_not_is_told(tmp_path: Path, name: str) -> None:
    parts, words = TOLD[name]
    system, _ = load(tmp_path, **parts)
    assert any(words in note for note in system.notes), system.notes


def test_an_actuator_is_what_mujoco_makes_of_it(tmp_path: Path) -> None:
    rest = '<actuator><position name="a" joint="h" kp="17.8" kv="0.5" gear="2" forcerange="-3 5"/></actuator>'
    system, theirs = load(tmp_path, rest=rest)
    (actuator,) = system.actuators
    inertia = 0.01 + 1.0 * 0.2**2
    for q, qd, command in ((0.01, 0.1, 0.0), (0.9, -0.4, 0.2), (-0.9, 0.0, 0.0)):
        force = actuator.offset + actuator.gain * command - actuator.stiffness * q - actuator.damping * qd
        force = min(max(force, actuator.lower), actuator.upper)
        expected = (force - 1.0 * 9.81 * 0.2 * np.sin(q)) / inertia
        assert acceleration(theirs, q, qd, command) == pytest.approx(expected, rel=1e-9)
    assert (actuator.lower, actuator.upper) == (-6.0, 10.0)


def test_compensation_that_differs_by_body_acts_and_is_told(tmp_path: Path) -> None:
    system, _ = load(tmp_path, body='gravcomp="1"')
    assert not np.any(system.gravity)
    text = (tmp_path / "model.xml").read_text().replace("</body>", '<body name="o"><geom size=".1"/></body></body>')
    (tmp_path / "model.xml").write_text(text)
    other = harness.load(tmp_path / "model.xml")
    assert other.gravity[2] == -9.81
    assert [link.gravcomp for link in other.links] == [1.0, 0.0]
    assert any("gravcomp of 'p' 1" in note for note in other.notes)
    # The ball of 4/3 π r³ · 1000 kg/m³ at the hinge has no arm: nothing pulls at the hinge.
    for runner in ("denoc", "mujoco", "pinocchio"):
        model = engine(runner).build(other)
        assert float(model.gravity(np.array([0.7]))[0]) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize(
    ("key", "why"),
    [
        ('qpos="0 0 1 0 0 0 0 1 0 0 0"', "the quaternion of joint 'root' in it has length zero"),
        ('qpos="0 0 1 1 0 0 0 0 0 0 0"', "the quaternion of joint 'ball' in it has length zero"),
        (
            'qpos="0 0 1 1 0 0 0 1 0"',
            r"its qpos has 9 numbers \(as many as there are velocities, nv\) where the model has 11 \(nq\)",
        ),
        ('qvel="0 0 1"', r"its qvel has 3 numbers where the model has 9 \(nv\)"),
    ],
)
def test_keyframes_that_say_no_state_are_left_out(key: str, why: str, tmp_path: Path) -> None:
    """MuJoCo 4.0 fills up what is too short, and makes of a quaternion of length zero no rotation, without a word."""
    path = tmp_path / "model.xml"
    path.write_text(
        f"""<mujoco><worldbody><body name="t"><joint name="root" type="free"/><geom size=".1"/>
        <body name="u" pos=".3 0 0"><joint name="ball" type="ball"/><geom size=".1" pos=".1 0 0"/></body></body></worldbody>
        <keyframe><key name="good" qpos="0 0 1 1 0 0 0 1 0 0 0" qvel="1 0 0 0 0 0 0 0 0"/><key name="bad" {key}/></keyframe>
        </mujoco>"""
    )
    system = harness.load(path)
    assert [frame.name for frame in system.keyframes] == ["good", "qpos0"]
    (note,) = (note for note in system.notes if "keyframe" in note)
    assert re.fullmatch(f"keyframe 'bad' left out: {why}", note)
    with pytest.raises(InputError, match=f"keyframe 'bad': {why}"):
        keyframe(system, "bad")


def test_keyframes_are_kept_by_name(tmp_path: Path) -> None:
    rest = """<actuator><position name="a" joint="h" kp="1"/></actuator>
    <keyframe><key name="up" qpos="1.5" qvel="0.2" ctrl="0.7"/><key qpos="0.1"/></keyframe>"""
    system, _ = load(tmp_path, rest=rest)
    up, second, start = system.keyframes
    assert (start.name, start.position) == ("qpos0", {"h": 0.0})
    assert (up.name, up.position, up.velocity, up.command) == ("up", {"h": 1.5}, {"h": 0.2}, {"a": 0.7})
    assert (second.name, second.position) == ("key2", {"h": 0.1})


# A motor shorted by having no command, one of two commands, one of one: three actuators, three commands, of other actuators.
MIXED = """<actuator><dcmotor name="brake" joint="h" motorconst="0.5" resistance="2" gear="3" input="none"/>
    <pid name="two" joint="h" kp="3" kv="1" input="pos vel"/>
    <position name="one" joint="h" kp="4" gear="2" ctrlrange="-9 9"/></actuator>
    <keyframe><key name="home" ctrl="0.1 0.2 0.7"/></keyframe>"""


def test_actuators_are_not_counted_by_their_commands(tmp_path: Path) -> None:
    system, theirs = load(tmp_path, rest=MIXED)
    assert (theirs.nactuator, theirs.nu) == (3, 3)
    brake, one = system.actuators
    # K²/R times the gear squared, and kp times the gear, and times its square.
    assert (brake.name, brake.gain, brake.damping) == ("brake", 0.0, pytest.approx(0.5**2 / 2 * 3**2))
    assert (one.name, one.gain, one.stiffness) == ("one", pytest.approx(4 * 2), pytest.approx(4 * 2**2))
    assert any("actuator 'two' left out: it takes 2 commands at once" in note for note in system.notes)
    assert system.keyframes[0].command == {"one": 0.7}


@pytest.mark.parametrize(
    ("rest", "names"),
    [
        ('<actuator><pid name="a" joint="h" kp="3" input="pos vel"/><motor name="b" joint="h"/></actuator>', ["b"]),
        (
            '<actuator><dcmotor name="a" joint="h" motorconst="1" resistance="1" input="none"/>'
            '<motor name="b" joint="h" gear="5"/></actuator>',
            ["a", "b"],
        ),
        ('<actuator><dcmotor name="a" joint="h" motorconst="1" resistance="1" input="none"/></actuator>', ["a"]),
    ],
    ids=["more commands than actuators", "fewer", "none"],
)
def test_a_command_more_or_less_loses_no_actuator(tmp_path: Path, rest: str, names: list[str]) -> None:
    system, theirs = load(tmp_path, rest=rest)
    assert theirs.nu != theirs.nactuator
    assert [actuator.name for actuator in system.actuators] == names
    assert any("'a'" in note for note in system.notes)
