"""MJCF means here what it means in MuJoCo: mass matrices and body poses against MuJoCo itself."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from jacobian_mechanics import mass_matrix, poses

import harness
from harness.errors import InputError
from harness.system import random_chain, write

# Degrees, classes, fromto, inertia from geoms, several joints on a body with offsets and ref, welded bodies, euler.
RICH = """<mujoco model="rich">
  <compiler angle="degree" autolimits="true" eulerseq="zyx"/>
  <option gravity="0.5 0 -3.7"/>
  <default>
    <joint armature="0.003"/>
    <default class="dry"><joint damping="0.25" frictionloss="0.02"/><geom density="500"/></default>
  </default>
  <worldbody>
    <body name="a" pos="0.1 0.2 0.3" euler="10 -20 30">
      <joint name="a1" type="hinge" axis="1 2 3" pos="0.1 0 -0.2" ref="25"/>
      <joint name="a2" type="slide" axis="0 1 1" ref="0.2" stiffness="4" springref="0.3"/>
      <joint name="a3" type="hinge" axis="0 1 0" pos="0 0.1 0.1" range="-90 45"/>
      <geom type="capsule" fromto="0 0 0 0.1 0.2 0.4" size="0.03"/>
      <body name="weld" pos="0 0.1 0" quat="1 1 0 0">
        <geom type="box" size="0.05 0.06 0.07" pos="0.1 0 0"/>
        <body name="b" pos="0.2 0 0.1" axisangle="0 0 1 40" childclass="dry">
          <joint name="b1" type="hinge" axis="-1 0 1" pos="0 0.02 0" actuatorfrcrange="-3 3"/>
          <geom type="cylinder" size="0.04 0.1"/>
          <geom type="sphere" size="0.05" pos="0.1 0.1 0"/>
        </body>
      </body>
      <body name="c" pos="0 0 0.4">
        <joint type="slide" axis="1 0 0"/>
        <inertial pos="0.01 0.02 0.03" mass="0.7" fullinertia="0.01 0.011 0.012 0.001 -0.002 0.0005"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def load_text(folder: Path, text: str, name: str = "model.xml", **options: object) -> harness.System:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return harness.load(path, **options)


def test_mass_matrix_and_poses_are_mujocos(tmp_path: Path) -> None:
    system = load_text(tmp_path, RICH)
    model = mujoco.MjModel.from_xml_string(RICH)
    data = mujoco.MjData(model)
    assert system.joint_names == ("a1", "a2", "a3", "b1", "c__joint")
    rng = np.random.default_rng(4)
    for _ in range(5):
        q = rng.uniform(-1.5, 1.5, model.nq)
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        theirs = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, theirs)
        np.testing.assert_allclose(mass_matrix(system, q), theirs, rtol=0, atol=1e-13)
        placed = poses(system, q)
        for link in system.links:
            if "__" in link.name:
                continue  # a massless link of a joint chain has no body there
            rotation, origin = placed[link.name]
            np.testing.assert_allclose(rotation, data.body(link.name).xmat.reshape(3, 3), atol=1e-14)
            np.testing.assert_allclose(origin + rotation @ link.com, data.body(link.name).xipos, atol=1e-14)


def test_joint_properties_come_through_defaults_and_units(tmp_path: Path) -> None:
    system = load_text(tmp_path, RICH)
    b1, a2, a3 = system.joint("b1"), system.joint("a2"), system.joint("a3")
    assert (b1.damping, b1.friction, b1.armature, b1.effort) == (0.25, 0.02, 0.003, 3.0)
    assert (a2.stiffness, a2.rest_position) == (4.0, 0.3)
    np.testing.assert_allclose((a3.lower, a3.upper), (-np.pi / 2, np.pi / 4), rtol=1e-15)
    np.testing.assert_array_equal(system.gravity, [0.5, 0.0, -3.7])


def test_what_acts_there_and_not_here_is_noted(tmp_path: Path) -> None:
    text = """<mujoco><option density="1.2"/><worldbody><geom type="plane" size="1 1 1"/><body name="b" gravcomp="1">
      <joint name="j" axis="0 1 0" damping="0.1 0.2 0.3" stiffness="4 5 0"/><geom size="0.1" pos="0 0 -1"/>
      <body><joint name="k" axis="0 1 0"/><geom size="0.1" pos="0 0 -1"/></body></body></worldbody>
      <actuator><motor joint="j"/></actuator>
      <equality><joint joint1="j"/></equality></mujoco>"""
    notes = " | ".join(load_text(tmp_path, text).notes)
    # The cubic damping acts (test_mjcf_own_forms holds it against MuJoCo), and is therefore not among what is left out.
    assert "0.3 v³" not in notes
    for word in ("stiffness 5 x²", "actuator", "equality", "contacts", "gravcomp", "fluid"):
        assert word in notes


THROWN = """<mujoco><worldbody><body name="torso" pos="1 2 3" quat="0 1 0 0"><freejoint name="root"/><geom size="0.1"/>
  <body pos="0.2 0 0"><joint name="hip" type="ball" pos="0 0.1 0" damping="0.3" stiffness="2" range="0 40" limited="true"/>
  <geom size="0.05"/></body></body></worldbody>
  <keyframe><key name="up" qpos="4 5 6 1 0 0 0 0 1 0 0" qvel="1 2 3 4 5 6 7 8 9"/></keyframe></mujoco>"""


def test_free_and_ball_joints_have_mujoco_s_positions_and_velocities(tmp_path: Path) -> None:
    system = load_text(tmp_path, THROWN)
    assert [str(joint.type) for joint in system.joints] == ["free", "ball"]
    up, rest = system.keyframes
    assert list(up.position.values()) == [4, 5, 6, 1, 0, 0, 0, 0, 1, 0, 0]
    assert tuple(up.position) == system.position_names and tuple(up.velocity) == system.coordinate_names
    assert list(up.velocity.values()) == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    # As the file places the body.
    assert list(rest.position.values()) == [1, 2, 3, 0, 1, 0, 0, 1, 0, 0, 0]
    notes = " | ".join(system.notes)
    assert "'hip': its spring of stiffness 2 is left out" in notes and "its limit of 0.698132 rad is left out" in notes
    model, theirs = harness.Denoc(system), mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    theirs.jnt_stiffness[:] = 0.0
    theirs.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(theirs)
    rng = np.random.default_rng(0)
    data.qpos[:], data.qvel[:] = rng.standard_normal(11), rng.standard_normal(9)
    data.qpos[:] = model.integrate(data.qpos, np.zeros(9))
    mujoco.mj_forward(theirs, data)
    np.testing.assert_allclose(model.forward_dynamics(data.qpos, data.qvel), data.qacc, rtol=1e-11, atol=1e-11)


def test_a_linear_joint_equality_is_a_mimic_and_any_other_is_a_loop(tmp_path: Path) -> None:
    text = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="a" ref="0.2"/><geom size="0.1" pos="1 0 0"/>
      <body><joint name="b" ref="0.1"/><geom size="0.1" pos="1 0 0"/><body><joint name="c"/><geom size="0.1" pos="1 0 0"/>
      </body></body></body></worldbody><equality><joint joint1="b" joint2="a" polycoef="0.5 -2 0 0 0"/>
      <joint name="bent" joint1="c" joint2="b" polycoef="0 1 1 0 0"/></equality></mujoco>"""
    system = load_text(tmp_path, text)
    mimic = system.joint("b").mimic
    assert mimic is not None and (mimic.joint, mimic.multiplier) == ("a", -2.0)
    # b - 0.1 = 0.5 - 2 (a - 0.2), equalities being about what is beyond qpos0.
    assert mimic.offset == pytest.approx(0.1 + 0.5 + 0.4, rel=1e-15)
    assert (system.nq, system.nv) == (2, 2)
    # c = (b - 0.1) + (b - 0.1)², and b what a makes it: said of a.
    (bent,) = system.loops
    assert isinstance(bent, harness.system.Coupling) and (bent.joint, bent.leader) == ("c", "a")
    b = mimic.multiplier * 0.3 + mimic.offset - 0.1
    assert bent.value(0.3)[0] == pytest.approx(b + b * b, rel=1e-14)
    assert any("'bent' holds exactly here, MuJoCo holds it softly" in note for note in system.notes)
    assert "1 loop: 1 condition, independent; 1 of 2 degrees of freedom is left" in system.notes


@pytest.mark.parametrize(
    ("snippet", "message"),
    [
        ('<include file="../secret.xml"/>', "outside the model's folder"),
        ('<include file="/etc/passwd"/>', "outside the model's folder"),
    ],
)
def test_files_outside_the_folder_are_refused(tmp_path: Path, snippet: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_text(tmp_path, f"<mujoco>{snippet}<worldbody/></mujoco>")


@pytest.mark.parametrize(
    "snippet",
    [
        '<asset><mesh name="m" file="../m.stl"/></asset>',
        '<compiler meshdir="../meshes"/><asset><mesh name="m" file="m.stl"/></asset>',
        '<asset><texture name="t" type="cube" fileup="../up.png"/></asset>',
        '<asset><hfield name="f" file="../f.png" size="1 1 1 1"/></asset>',
    ],
)
def test_shapes_outside_the_folder_are_not_opened(tmp_path: Path, snippet: str) -> None:
    (tmp_path / "in").mkdir()
    for name in ("m.stl", "meshes/m.stl", "up.png", "f.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("no shape, which MuJoCo would say if it opened this")
    body = '<worldbody><body name="b"><joint name="j"/><geom size="0.1" pos="0 0 -1"/></body></worldbody>'
    assert load_text(tmp_path / "in", f"<mujoco>{snippet}{body}</mujoco>").joint_names == ("j",)


def test_an_include_that_includes_from_outside_is_refused(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text('<mujoco><include file="../../other.xml"/></mujoco>')
    with pytest.raises(InputError, match=r"part\.xml:1: <include> names"):
        load_text(tmp_path, '<mujoco><include file="part.xml"/><worldbody/></mujoco>')


def test_an_include_inside_the_folder_is_read(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text('<mujoco><option gravity="0 0 -1.6"/></mujoco>')
    text = """<mujoco><include file="part.xml"/><worldbody><body name="b"><joint name="j" axis="0 1 0"/>
      <geom size="0.1" pos="0 0 -1"/></body></worldbody></mujoco>"""
    assert load_text(tmp_path, text).gravity[2] == -1.6


@pytest.mark.parametrize(
    ("joint", "inertial", "message"),
    [
        ('damping="-1"', 'pos="0 0 -1" mass="1"', r"model\.xml:1: joint 'j': damping -1 is negative"),
        ('frictionloss="-1"', 'pos="0 0 -1" mass="1"', r"joint 'j': friction -1 is negative"),
        ('pos="0 nan 0"', 'pos="0 0 -1" mass="1"', r"NaN or infinite|MuJoCo refuses"),
        ('axis="0 0 0"', 'pos="0 0 -1" mass="1"', r"MuJoCo refuses it: axis too small in joint \('j'\)"),
        ("", 'pos="0 0 -1" mass="-1"', r"model\.xml:1: MuJoCo refuses it: mass and inertia .* \('b'\)"),
        ("", 'pos="0 0 -1" mass="nan"', r"NaN or infinite|MuJoCo refuses"),
    ],
)
def test_impossible_numbers_are_refused(tmp_path: Path, joint: str, inertial: str, message: str) -> None:
    text = f'<mujoco><worldbody><body name="b"><joint name="j" {joint}/><inertial {inertial} diaginertia="1 1 1"/>'
    with pytest.raises(InputError, match=message):
        load_text(tmp_path, text + "</body></worldbody></mujoco>")


def test_nesting_too_deep_for_mjcf_is_told(tmp_path: Path) -> None:
    write(random_chain(300, 1), tmp_path / "long.xml")
    with pytest.raises(InputError, match="nested more than 256 deep"):
        harness.load(tmp_path / "long.xml")


def test_mujocos_own_refusal_is_one_line(tmp_path: Path) -> None:
    text = "<mujoco>\n<worldbody>\n<bdy/>\n</worldbody></mujoco>"
    with pytest.raises(InputError, match=r"model\.xml:3: MuJoCo refuses it: .*bdy") as caught:
        load_text(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_reading_leaves_no_log_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    load_text(tmp_path, RICH, "model.mjcf")
    assert [p.name for p in tmp_path.iterdir()] == ["model.mjcf"]


@pytest.mark.parametrize(
    ("joint", "rest", "told"),
    [
        (
            "",
            '<contact><pair geom1="floor" geom2="g"/></contact>',
            "contacts of 1 pair(s) of geoms that the file names left out",
        ),
        ('frictionloss="1" solreffriction="0.5 1"', "", "joint 'j': how soft its dry friction is"),
        ('frictionloss="1" solimpfriction="0.1 0.2 0.01"', "", "joint 'j': how soft its dry friction is"),
        ('frictionloss="1"', "", None),
        ('solreffriction="0.5 1"', "", None),
    ],
)
def test_named_contacts_and_soft_friction_are_told(tmp_path: Path, joint: str, rest: str, told: str | None) -> None:
    system = load_text(
        tmp_path,
        f"""<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" contype="0" conaffinity="0"/><body pos="0 0 1">
        <joint name="j" type="slide" axis="0 0 1" {joint}/><geom name="g" size=".1" contype="0" conaffinity="0"/></body></worldbody>
        {rest}</mujoco>""",
    )
    assert [note[: len(told or "")] for note in system.notes] == ([] if told is None else [told])
