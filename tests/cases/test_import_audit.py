"""What a reader passes over costs what the field's own law says; each reader is asked, none is believed."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from click.testing import CliRunner

import harness
from harness.cases.import_audit import Ignored, audit_import
from harness.cases.import_audit.ignored import DURATION, SAMPLES, random_states, start
from harness.cli.validate import validate

MASS, ARM, INERTIA, GRAVITY = 1.0, 0.2, 0.01, 9.81
URDF = """<robot name="x"><link name="base"/><link name="a"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>{dynamics}</joint>{rest}</robot>"""
ROTOR = """<transmission><joint name="j"/><actuator name="m"><drake:gear_ratio value="50"/><drake:rotor_inertia value="1e-5"/>
</actuator></transmission>"""
SPRING = '<gazebo reference="j"><springStiffness>2.0</springStiffness><springReference>0.3</springReference></gazebo>'
BODY = """<mujoco><worldbody><body name="p" {body}><joint name="h" axis="0 1 0" {joint}/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></worldbody>{rest}</mujoco>"""


def file(folder: Path, text: str, name: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def found(path: Path) -> dict[str, Ignored]:
    return {row.field: row for row in audit_import(path)}


def mujoco_run(system: harness.System, **changes: float) -> np.ndarray:
    """The same pendulum, built here from its numbers, by MuJoCo's RK4."""
    joint = " ".join(f'{name}="{value!r}"' for name, value in changes.items())
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler angle="radian"/><option timestep="0.0005" integrator="RK4"/><worldbody><body>
        <joint axis="0 1 0" {joint}/>
        <inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qpos[:] = start(system)
    run = [float(data.qpos[0])]
    for _ in range(SAMPLES - 1):
        mujoco.mj_step(model, data, nstep=round(DURATION / 0.0005 / (SAMPLES - 1)))
        run.append(float(data.qpos[0]))
    return np.array(run)


def test_a_rotor_behind_a_gear(tmp_path: Path) -> None:
    path = file(tmp_path, URDF.format(dynamics="", rest=ROTOR), "x.urdf")
    row, system = found(path)["drake:rotor_inertia"], harness.load(path)
    assert set(row.readers.values()) == {"ignored"}
    armature = 1e-5 * 50**2
    assert row.force == pytest.approx(armature * np.abs(random_states(system)[2]).max(), rel=1e-9)
    apart = np.abs(mujoco_run(system, armature=armature) - mujoco_run(system)).max()
    assert row.motion == pytest.approx(apart, rel=1e-6)


def test_a_spring_of_gazebo(tmp_path: Path) -> None:
    path = file(tmp_path, URDF.format(dynamics="", rest=SPRING), "x.urdf")
    row, system = found(path)["gazebo springStiffness"], harness.load(path)
    assert row.force == pytest.approx(2.0 * np.abs(random_states(system)[0] - 0.3).max(), rel=1e-9)
    apart = np.abs(mujoco_run(system, stiffness=2.0, springref=0.3) - mujoco_run(system)).max()
    assert row.motion == pytest.approx(apart, rel=1e-6)


def test_damping_that_pinocchio_keeps_and_never_applies(tmp_path: Path) -> None:
    text = URDF.format(dynamics='<dynamics damping="0.05"/>', rest="")
    row = found(file(tmp_path, text, "x.urdf"))["dynamics damping"]
    assert row.readers == {"denoc": "acts", "pinocchio": "kept, never acts", "mujoco": "acts"}
    # What the table says of the two, asked of them.
    theirs = pin.buildModelFromXML(text)
    one = np.ones(1)
    q = pin.neutral(theirs)
    assert theirs.damping[0] == 0.05
    assert pin.rnea(theirs, theirs.createData(), q, one, 0.0 * one)[0] == pytest.approx(0.0, abs=1e-15)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qvel[:] = 1.0
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[0] == pytest.approx(-0.05)


def test_mimic_is_an_equality_in_mujoco_and_free_in_pinocchio(tmp_path: Path) -> None:
    second = """<link name="b"><inertial><mass value="1"/><origin xyz="0 0 -.2"/>
    <inertia ixx=".01" ixy="0" ixz="0" iyy=".01" iyz="0" izz=".01"/></inertial></link>
    <joint name="k" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
    <mimic joint="j" multiplier="-1"/></joint>"""
    text = URDF.format(dynamics="", rest=second)
    row = found(file(tmp_path, text, "x.urdf"))["mimic"]
    assert mujoco.MjModel.from_xml_string(text).neq == 1
    assert pin.buildModelFromXML(text).nv == 2
    assert pin.buildModelFromXML(text, True).nv == 1
    assert row.motion > 0.1


def test_what_only_mujoco_does_with_an_mjcf(tmp_path: Path) -> None:
    rest = '<actuator><position name="a" joint="h" kp="3" gear="2"/></actuator>'
    path = file(tmp_path, BODY.format(body='gravcomp="1"', joint='damping="0 .5 0"', rest=rest), "x.xml")
    rows, system = found(path), harness.load(path)
    q, qd, _ = random_states(system)
    assert rows["gravcomp"].force == pytest.approx(MASS * GRAVITY * ARM * np.abs(np.sin(q)).max(), rel=1e-9)
    assert rows["damping, v|v|"].force == pytest.approx(0.5 * (qd**2).max(), rel=1e-9)
    assert rows["actuator, no command"].force == pytest.approx(3.0 * 2.0**2 * np.abs(q).max(), rel=1e-9)
    assert rows["gravcomp"].readers["pinocchio"] == "ignored"
    theirs = pin.buildModelFromMJCF(str(path))
    pulled = pin.computeGeneralizedGravity(theirs, theirs.createData(), np.array([0.5]))
    assert abs(pulled[0]) == pytest.approx(MASS * GRAVITY * ARM * np.sin(0.5), rel=1e-9)


def test_a_joint_that_is_a_polynomial_of_another_acts_here_and_not_in_pinocchio(tmp_path: Path) -> None:
    path = tmp_path / "m.xml"
    path.write_text(
        """<mujoco><compiler angle="radian"/><worldbody><body name="a"><joint name="h" axis="0 1 0"/>
        <inertial pos="0 0 -.1" mass="1" diaginertia=".01 .01 .001"/><body name="b" pos="0 0 -.2"><joint name="i" axis="0 1 0"/>
        <inertial pos="0 .01 -.1" mass=".5" diaginertia=".004 .004 .0005"/></body></body></worldbody>
        <equality><joint joint1="i" joint2="h" polycoef=".1 -.5 .4"/></equality></mujoco>"""
    )
    row = found(path)["equality"]
    assert row.readers["denoc"] == "acts, joints follow" and row.readers["pinocchio"] == "ignored"
    assert row.motion > 0.1


def test_a_file_that_all_read_alike_has_no_rows(tmp_path: Path) -> None:
    assert audit_import(file(tmp_path, URDF.format(dynamics="", rest=""), "x.urdf")) == ()


def test_the_verb_prints_and_writes_it(tmp_path: Path) -> None:
    path = file(tmp_path, URDF.format(dynamics="", rest=ROTOR), "x.urdf")
    result = CliRunner().invoke(validate, [str(path), "--audit-import"], standalone_mode=False)
    assert result.exception is None
    assert "drake:rotor_inertia at j: 1e-05 kg·m² × 50²" in result.stdout
    result = CliRunner().invoke(validate, [str(path), "--audit-import", "--json", "-"], standalone_mode=False)
    document = json.loads(result.stdout)
    assert document["schema"] == "denoc.import/1"
    assert document["models"][0]["rows"][0]["readers"]["mujoco"] == "ignored"


def test_toml_is_no_file_of_another_engine() -> None:
    from harness.errors import InputError

    with pytest.raises(InputError, match="no URDF or MJCF"):
        audit_import(Path(__file__).parents[2] / "models" / "toml" / "flexible_pendulum.toml")
