"""What of a model acts in a diagnosis, held against MuJoCo stepping the same file: servos, motors, limits, joints that follow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.diagnose.problem.acting import acting, coupled, feedback
from harness.effects.lanes import lane_model, lane_row
from harness.errors import InputError, UnsupportedError
from harness.recording import Recording, read_recording
from harness.system import System
from harness.system.lowering import freed

ARM = """<mujoco><compiler angle="radian"/><option timestep="0.0002" integrator="RK4"/><worldbody><body name="arm" {arm}>
<joint name="pivot" axis="0 1 0" damping="{damping}" armature="0.01" {joint}/>
<inertial pos="0 0 -.3" mass=".5" diaginertia=".004 .004 .0001"/></body></worldbody>
<actuator>{actuator}</actuator></mujoco>"""
SERVO = '<position name="a" joint="pivot" kp="8" kv="0.2" gear="1.5" {range}/>'
RATE, DURATION, NOISE = 100, 5.0, 1e-3


def asked(time: float) -> float:
    return float(0.9 * np.sign(np.sin(2.2 * time)) + 0.3 * np.sin(5.0 * time))


def recorded(
    folder: Path,
    model: str,
    *,
    column: str = "pivot.command",
    start: float = 0.0,
    scale: float = 1.0,
    noise: float = NOISE,
) -> Path:
    """Nothing but MuJoCo's own stepping of the file, with noise on top."""
    theirs = mujoco.MjModel.from_xml_string(model)
    data = mujoco.MjData(theirs)
    data.qpos[0] = start
    rows = []
    for k in range(round(DURATION * RATE) + 1):
        data.ctrl[:] = asked(k / RATE)
        rows.append((k / RATE, data.qpos[0], scale * asked(k / RATE)))
        mujoco.mj_step(theirs, data, round(1.0 / RATE / theirs.opt.timestep))
    table = np.array(rows)
    table[:, 1] += noise * np.random.default_rng(1).standard_normal(len(table))
    file = folder / "run.csv"
    header = f"time,pivot.position,{column}"
    np.savetxt(file, table, delimiter=",", header=header, comments="", fmt="%.9f")
    return file


def written(folder: Path, **parts: str) -> Path:
    path = folder / "arm.xml"
    path.write_text(ARM.format(**{"arm": "", "joint": "", "actuator": "", "damping": "0.02", **parts}))
    return path


CASES = pytest.mark.parametrize(
    ("reach", "joint", "allowed"),
    [("", "", 1e-6), ('forcerange="-1.2 1.2"', "", 1e-5), ('forcerange="-1.2 0.9"', 'range="-.6 .5"', 2e-3)],
    ids=["free", "bounded", "limited"],
)


@CASES
def test_what_a_diagnosis_runs_is_what_mujoco_steps(tmp_path: Path, reach: str, joint: str, allowed: float) -> None:
    """The servo saturates most of the time. MuJoCo's own steps of 0.2 ms fall where saturation and limits set in, ours do not."""
    path = written(tmp_path, joint=joint, actuator=SERVO.format(range=reach))
    system = harness.load(path)
    file = recorded(tmp_path, path.read_text(), noise=0.0)
    theirs = np.loadtxt(file, delimiter=",", skiprows=1)[:, 1]
    read = read_recording(file, system=system)
    whole, (driven,) = acting(system, [read])
    lanes = lane_model(whole)
    tau = driven.efforts[0].values[:, None]
    course = lanes.simulate(lane_row(lanes, whole), theirs[:1], np.zeros(1), read.time, tau=tau, hold="zero")[0][
        0, :, 0
    ]
    assert np.abs(course - theirs).max() < allowed
    assert sum("meets its limit" in note for note in whole.notes) == (2 if joint else 0)


@pytest.mark.slow
@CASES
def test_a_servo_acts_by_its_recorded_command(tmp_path: Path, reach: str, joint: str, allowed: float) -> None:
    """What the model lacks is damping of 0.04 N·m·s/rad."""
    servo = SERVO.format(range=reach)
    file = recorded(tmp_path, ARM.format(arm="", joint=joint, actuator=servo, damping="0.06"))
    model = written(tmp_path, joint=joint, actuator=servo)
    found = harness.diagnose([file], model, only=["viscous_damping", "coulomb_friction", "payload_mass"])
    assert found.verdict == "explained"
    (finding,) = found.findings
    assert finding["effect"] == "viscous_damping"
    damping = finding["parameters"]["coefficient"]
    assert abs(damping["value"] - 0.04) < 4.0 * damping["std"]
    assert any("by its recorded command" in note for note in found.notes)
    assert not any("left out" in note for note in found.notes)


def test_a_command_in_degrees_of_a_motor_is_an_effort(tmp_path: Path) -> None:
    """A motor has no feedback: gear times command, kept within its ranges."""
    motor = '<motor name="m" joint="pivot" gear="3" ctrlrange="-1 1" ctrllimited="true" forcerange="-.9 .9"/>'
    path = written(tmp_path, actuator=motor)
    system = harness.load(path)
    read = read_recording(
        recorded(tmp_path, ARM.format(arm="", joint="", actuator=motor, damping="0.02")), system=system
    )
    whole, (driven,) = acting(system, [read])
    assert not whole.drives
    (effort,) = driven.efforts
    assert effort.name == "pivot.effort" and effort.unit == "N*m"
    expected = [float(np.clip(3.0 * np.clip(asked(t), -1.0, 1.0), -2.7, 2.7)) for t in read.time]
    assert np.allclose(effort.values, expected, atol=1e-6)
    assert feedback(whole, np.zeros((1, 1)), np.zeros((1, 1)), None) == pytest.approx(0.0)


def test_commands_come_in_units_and_by_the_actuators_name(tmp_path: Path) -> None:
    path = written(tmp_path, actuator=SERVO.format(range=""))
    system = harness.load(path)
    model = path.read_text()
    plain = read_recording(recorded(tmp_path, model), system=system)
    turned = read_recording(recorded(tmp_path, model, column="a.command [deg]", scale=180.0 / np.pi), system=system)
    assert np.allclose(turned.commands[0].values, plain.commands[0].values, atol=1e-6)
    (_, (by_joint,)), (_, (by_name,)) = acting(system, [plain]), acting(system, [turned])
    assert np.allclose(by_name.efforts[0].values, by_joint.efforts[0].values, atol=1e-5)
    # kp · gear · command, in MuJoCo's terms: the command is compared with gear times the position.
    assert np.allclose(by_joint.efforts[0].values, 12.0 * plain.commands[0].values)
    with pytest.raises(InputError, match="does not fit a command"):
        read_recording(recorded(tmp_path, model, column="pivot.command [kg]"), system=system)
    # A model without actuators leaves the column out, and tells.
    bare = harness.load(written(tmp_path))
    left = read_recording(recorded(tmp_path, model), system=bare)
    assert not left.commands
    assert any("no actuator" in note.what for note in left.quality)


def test_without_a_command_a_servo_holds_at_zero_and_says_so(tmp_path: Path) -> None:
    path = written(tmp_path, actuator=SERVO.format(range='forcerange="-1 1"'))
    system = harness.load(path)
    read = read_recording(recorded(tmp_path, path.read_text()), system=system)
    whole, _ = acting(system, [replace(read, commands=())])
    assert any("held at 0: no recording has its command (pivot.command)" in note for note in whole.notes)
    assert len(whole.drives) == 1
    # 8 · 1.5² · 0.02 and 0.2 · 1.5² · 0.1 N·m; its range is 1.5 times as wide.
    q, qd = np.array([[0.02], [1.0]]), np.array([[0.1], [0.0]])
    assert feedback(whole, q, qd, None)[:, 0] == pytest.approx([-0.36 - 0.045, -1.5])
    assert acting(system, [replace(read, commands=())], actuators=False)[0].drives == ()


def test_a_recorded_effort_is_all_that_is_applied(tmp_path: Path) -> None:
    path = written(tmp_path, actuator=SERVO.format(range=""))
    system = harness.load(path)
    read = read_recording(recorded(tmp_path, path.read_text(), column="pivot.effort"), system=system)
    whole, (same,) = acting(system, [read])
    assert whole.joint("pivot").stiffness == 0.0 and not whole.drives
    assert same.efforts == read.efforts
    assert any("is left out: the effort of joint 'pivot' is given" in note for note in whole.notes)


def test_what_a_diagnosis_does_not_hold_is_refused(tmp_path: Path) -> None:
    bounded = SERVO.format(range='forcerange="-1 1"')
    two = harness.load(written(tmp_path, actuator=bounded + bounded.replace('"a"', '"b"')))
    read = read_recording(
        recorded(tmp_path, ARM.format(arm="", joint="", actuator=bounded, damping="0.02")), system=two
    )
    with pytest.raises(UnsupportedError, match=r"several actuators of joint 'pivot'.*--no-actuators"):
        acting(two, [read])
    one = harness.load(written(tmp_path, actuator=bounded))
    with pytest.raises(InputError, match="has no command of actuator 'a'"):
        acting(one, [read, replace(read, commands=(), name="other")])
    lifted = one.replace_link(replace(one.links[0], gravcomp=0.5))
    with pytest.raises(UnsupportedError, match="gravcomp carries weight of some bodies"):
        acting(lifted, [read])


def test_limits_that_act_and_those_that_do_not(tmp_path: Path) -> None:
    loose = read_recording(recorded(tmp_path, ARM.format(arm="", joint="", actuator="", damping="0.02"), start=1.0))
    far = harness.load(written(tmp_path, joint='range="-1.2 1.3"'))
    through = harness.load(written(tmp_path, joint='range="-.4 .4"'))
    meets = harness.load(written(tmp_path, joint='range="-1.2 1.02"'))
    assert acting(far, [loose])[0].stops == () and acting(far, [loose])[0].notes == far.notes
    whole = acting(through, [loose])[0]
    assert whole.stops == () and any("runs through its limit" in note for note in whole.notes)
    whole = acting(meets, [loose])[0]
    assert [stop.joint for stop in whole.stops] == ["pivot"] and any(
        "meets its limit of 1.02" in n for n in whole.notes
    )
    assert acting(meets, [loose], limits=False)[0].stops == ()
    # A URDF states where software stops a joint, and nothing of what it runs into.
    bare = acting(replace(meets, limits=()), [loose])[0]
    assert bare.stops == () and any("none acts" in note for note in bare.notes)


GRIPPER = """<robot name="m"><link name="base"/>
<link name="rod"><inertial><origin xyz="0 0 -0.3"/><mass value="0.5"/>
<inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.0001"/></inertial></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
{fingers}</robot>"""
FINGER = """<link name="f{k}"><inertial><origin xyz="0 0 -0.02"/><mass value="0.01"/>
<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>
<joint name="g{k}" type="prismatic"><parent link="rod"/><child link="f{k}"/><origin xyz="0 0 -0.3"/><axis xyz="{x} 0 0"/>
<limit lower="0" upper="0.04" effort="5" velocity="1"/>{mimic}</joint>"""


def test_joints_that_follow_are_held_where_they_are_still(tmp_path: Path) -> None:
    path = tmp_path / "gripper.urdf"
    fingers = FINGER.format(k=1, x=1, mimic="") + FINGER.format(k=2, x=-1, mimic='<mimic joint="g1" multiplier="0.5"/>')
    path.write_text(GRIPPER.format(fingers=fingers))
    system = harness.load(path)
    time = np.arange(400) * 0.01
    table = np.stack([time, np.cos(5.0 * time), 0.02 + 1e-4 * np.sin(70.0 * time)], axis=1)

    def read(grip: float) -> tuple[System, list[Recording]]:
        table[:, 2] = 0.02 + grip * np.sin(7.0 * time)
        np.savetxt(tmp_path / "r.csv", table, delimiter=",", header="time,pivot.position,g1.position", comments="")
        loose = freed(system)
        return coupled(system, loose, [read_recording(tmp_path / "r.csv", system=loose)])

    whole, (kept,) = read(1e-4)
    assert whole.joint_names == ("pivot",) and kept.channel_names == ("pivot.position",)
    # The fingers stand where they are: 2 cm one way, half of that the other.
    assert whole.joint("g1").xyz == pytest.approx([0.02, 0.0, -0.3], abs=1e-4)
    assert whole.joint("g2").xyz == pytest.approx([-0.01, 0.0, -0.3], abs=1e-4)
    assert sum("is held at" in note for note in whole.notes) == 2
    whole, (kept,) = read(0.01)
    assert whole.joint_names == ("pivot", "g1", "g2") and kept.channel_names == ("pivot.position", "g1.position")
    assert [(loop.joint, loop.leader, loop.coefficients[:2]) for loop in whole.loops] == [("g2", "g1", (0.0, 0.5))]


def test_joints_that_are_polynomials_of_others_are_held_where_they_are_still(tmp_path: Path) -> None:
    """A gripper of two slides, one the square of the other, and a joint that an equality locks."""
    path = tmp_path / "gripper.xml"
    path.write_text(
        """<mujoco><compiler angle="radian"/><worldbody><body name="rod"><joint name="pivot" axis="0 1 0"/>
        <inertial pos="0 0 -.3" mass=".5" diaginertia=".004 .004 .0001"/>
        <body name="f1" pos="0 0 -.3"><joint name="g1" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass=".01"
        diaginertia="1e-5 1e-5 1e-5"/></body><body name="f2" pos="0 0 -.3"><joint name="g2" type="slide" axis="-1 0 0"/>
        <inertial pos="0 0 0" mass=".01" diaginertia="1e-5 1e-5 1e-5"/></body><body name="f3" pos="0 0 -.3">
        <joint name="g3" axis="0 1 0"/><inertial pos="0 0 0" mass=".01" diaginertia="1e-5 1e-5 1e-5"/></body></body></worldbody>
        <equality><joint joint1="g2" joint2="g1" polycoef="0 0 20"/><joint joint1="g3" polycoef=".2"/></equality></mujoco>"""
    )
    system = harness.load(path)
    loose = replace(system, loops=())
    time = np.arange(400) * 0.01

    def read(column: str, amplitude: float, middle: float) -> tuple[System, list[Recording]]:
        table = np.stack([time, np.cos(5.0 * time), middle + amplitude * np.sin(7.0 * time)], axis=1)
        np.savetxt(tmp_path / "r.csv", table, delimiter=",", header=f"time,pivot.position,{column}", comments="")
        return coupled(system, loose, [read_recording(tmp_path / "r.csv", system=loose)])

    # 20 · 0.02² = 0.008 m; and the other way round, from what is recorded of the follower.
    for column, middle in (("g1.position", 0.02), ("g2.position", 0.008)):
        whole, (kept,) = read(column, 1e-5, middle)
        assert whole.joint_names == ("pivot",) and kept.channel_names == ("pivot.position",) and not whole.loops
        assert abs(whole.joint("g1").xyz[0]) == pytest.approx(0.02, abs=1e-4)
        assert whole.joint("g2").xyz[0] == pytest.approx(-0.008, abs=1e-4)
        turned = np.asarray(whole.joint("g3").rotation)
        assert turned[0, 0] == pytest.approx(np.cos(0.2)) and turned[0, 2] == pytest.approx(np.sin(0.2))
        assert sum("is held at" in note for note in whole.notes) == 3
    # Those that move follow as the file says; the locked one stays where it is.
    whole, _ = read("g1.position", 0.01, 0.02)
    assert whole.joint_names == ("pivot", "g1", "g2")
    assert [(loop.joint, loop.leader, loop.coefficients[2]) for loop in whole.loops] == [("g2", "g1", 20.0)]
    with pytest.raises(UnsupportedError, match="joint 'g3' is locked by the model, and g3 moves"):
        read("g3.position", 0.1, 0.2)


VARYING = '<general name="a" joint="pivot" gaintype="affine" gainprm="1 .8 -.3" biastype="affine" biasprm="0 -6 -.1" gear="1.5"/>'


def test_a_gain_that_changes_with_the_motion_is_held_under_a_constant_command(tmp_path: Path) -> None:
    """(1 + 0.8 l − 0.3 l̇) · u − 6 l − 0.1 l̇ with l = 1.5 q and u = 0.4, times the gear."""
    path = written(tmp_path, actuator=VARYING)
    system = harness.load(path)
    file = recorded(tmp_path, path.read_text(), noise=0.0)
    read = read_recording(file, system=system)
    with pytest.raises(
        UnsupportedError, match=r"gain of actuator 'a' changes with the motion.*record the effort of joint 'pivot'"
    ):
        acting(system, [read])
    (command,) = read.commands
    held = replace(read, commands=(replace(command, values=np.full_like(command.values, 0.4)),))
    whole, (driven,) = acting(system, [held])
    assert not driven.efforts
    joint = whole.joint("pivot")
    assert joint.stiffness == pytest.approx(1.5**2 * (6.0 - 0.8 * 0.4))
    assert joint.damping == pytest.approx(0.02 + 1.5**2 * (0.1 + 0.3 * 0.4))
    assert joint.stiffness * joint.rest_position == pytest.approx(1.5 * 0.4)
    assert any("its command held at 0.4" in note for note in whole.notes)
    assert not any("no recording has its command" in note for note in whole.notes)
