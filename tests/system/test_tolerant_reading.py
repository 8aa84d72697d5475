"""Files that the tools of their format read are read here, and mean the same; what cannot be is named."""

from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import harness
from harness.errors import InputError, UnsupportedError
from harness.system.xml_source import parse_xml

ARM = """<link name="base"/>
<link name="arm"><inertial><origin xyz="0.2 0 0" {com}/><mass value="1.5"/>
  <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.021"/></inertial>{more}</link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.1" {turn}/><axis xyz="0 1 1"/>
  <limit lower="-2" upper="2" effort="5" velocity="5"/></joint>"""
TURN = 'quat_xyzw="0.7071067811865476 0 0 0.7071067811865476"'
COM = 'quat_xyzw="0 0 0.3826834323650898 0.9238795325112867"'


def urdf(robot: str = "", **parts: str) -> str:
    filled = {"com": "", "turn": "", "more": "", **parts}
    return f'<robot name="q" {robot}>{ARM.format(**filled)}</robot>'


def read(folder: Path, text: str | bytes, name: str = "model.urdf", **options: object) -> harness.System:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return harness.load(path, **options)


@pytest.mark.parametrize("robot", ["", 'version="1.0"', 'version="1.1"', 'version="1.2"'])
def test_quaternions_count_from_version_1_1_as_for_urdfdom(tmp_path: Path, robot: str) -> None:
    text = urdf(robot, com=COM, turn=TURN)
    system = read(tmp_path, text)
    theirs = pin.buildModelFromXML(text)  # Pinocchio hands the text to urdfdom
    np.testing.assert_allclose(system.joints[0].rotation, theirs.jointPlacements[1].rotation, atol=1e-14)
    np.testing.assert_allclose(system.links[0].inertia, theirs.inertias[1].inertia, atol=1e-15)
    ours = harness.Denoc(system).gravity(np.array([0.3]))
    np.testing.assert_allclose(
        ours, pin.computeGeneralizedGravity(theirs, theirs.createData(), np.array([0.3])), rtol=1e-12
    )
    assert any("quat_xyzw is left out" in note for note in system.notes) == ("1.1" not in robot and "1.2" not in robot)


def test_a_rotation_said_twice_is_refused_as_by_urdfdom(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="both rpy and quat_xyzw"):
        read(tmp_path, urdf('version="1.1"', turn=f'rpy="0 0 1" {TURN}'))


def test_undeclared_prefixes_where_nothing_is_read(tmp_path: Path) -> None:
    more = "<collision><drake:proximity_properties drake:x='1'><drake:rigid/></drake:proximity_properties></collision>"
    assert read(tmp_path, urdf(more=more)).joint_names == ("j",)
    # Any other fault of the document is still one.
    with pytest.raises(InputError, match="broken XML"):
        read(tmp_path, urdf(more=more + "<unclosed>"))


def test_an_undeclared_xacro_is_still_named(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match="xacro:macro"):
        read(tmp_path, urdf(more="<xacro:macro/>"))


def test_default_namespaces_and_comments_in_other_encodings(tmp_path: Path) -> None:
    assert read(tmp_path, urdf('xmlns="https://drake.mit.edu"')).joint_names == ("j",)
    body = urdf().encode()
    assert read(tmp_path, b'<?xml version="1.0" encoding="utf-8"?>\n<!-- \xb9\xd8\xbd\xda -->' + body).joint_names == (
        "j",
    )
    with pytest.raises(InputError, match="UTF-8"):
        read(tmp_path, body.replace(b'name="q"', b'name="\xb9\xd8"'))
    mjcf = b'<!-- \xb9\xd8 --><mujoco><worldbody><body><joint name="h"/><geom size=".1"/></body></worldbody></mujoco>'
    assert read(tmp_path, mjcf, "model.xml").joint_names == ("h",)
    assert read(tmp_path, mjcf, "model.mjcf").joint_names == ("h",)


def test_lines_survive_what_was_tolerated() -> None:
    root = parse_xml(b'<!-- \xb9\n\xd8 -->\n<robot xmlns="x">\n<link drake:a="1"/>\n</robot>')
    assert root[0].sourceline == 4


def test_joints_of_another_vocabulary_are_named(tmp_path: Path) -> None:
    foreign = (
        '<drake:joint name="u" type="universal"><parent link="arm"/><child link="b"/></drake:joint><link name="b"/>'
    )
    for robot in ("", 'xmlns:drake="http://drake.mit.edu"'):
        with pytest.raises(UnsupportedError, match="joint 'u': <drake:joint> of type 'universal'"):
            read(tmp_path, urdf(robot).replace("</robot>", foreign + "</robot>"))
    with pytest.raises(UnsupportedError, match="type 'screw' is not modelled"):
        read(tmp_path, urdf().replace('"revolute"', '"screw"'))


def test_what_other_tools_make_of_it_is_told(tmp_path: Path) -> None:
    text = urdf(more="").replace("</joint>", '<dynamics damping="1" spring_stiffness="2"/></joint>')
    text = text.replace(
        "</robot>",
        """<gazebo reference="j"><springStiffness>2.5</springStiffness></gazebo>
        <gazebo reference="arm"><turnGravityOff>true</turnGravityOff><kp>1e6</kp></gazebo>
        <transmission><joint name="j"/><actuator name="a"><drake:gear_ratio value="100"/><drake:rotor_inertia value="1e-5"/>
        </actuator></transmission></robot>""",
    )
    notes = " | ".join(read(tmp_path, text).notes)
    # Drake reflects a rotor by its gear squared: 1e-5 kg·m² · 100².
    for word in ("spring_stiffness", "<springStiffness> 2.5", "gravity switched off", "armature of 0.1 kg·m²"):
        assert word in notes
    assert "kp" not in notes


def test_a_hinge_without_limit_is_told_as_urdfdom_refuses_it(tmp_path: Path) -> None:
    text = urdf().replace('<limit lower="-2" upper="2" effort="5" velocity="5"/>', "")
    with pytest.raises(ValueError, match="valid URDF"):
        pin.buildModelFromXML(text)
    assert any("without <limit>" in note for note in read(tmp_path, text).notes)


UNNAMED = """<mujoco><worldbody><body><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.2" size=".01"/>
<body name="body1" pos="0 0 -.2"><joint name="b" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.2" size=".01"/></body>
<body name="body1_"><geom size=".1"/></body></body></worldbody></mujoco>"""


def test_a_body_without_name_beside_one_that_has_it(tmp_path: Path) -> None:
    system = read(tmp_path, UNNAMED, "model.xml")
    assert [link.name for link in system.links] == ["body1__", "body1", "body1_"]
    model = mujoco.MjModel.from_xml_string(UNNAMED)
    np.testing.assert_allclose([link.mass for link in system.links], model.body_mass[1:], rtol=1e-15)


def test_deprecated_words_are_a_note_and_no_warning(tmp_path: Path) -> None:
    text = UNNAMED.replace("<mujoco>", '<mujoco><compiler settotalmass="2"/>')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        system = read(tmp_path, text, "model.xml")
    assert any("settotalmass" in note for note in system.notes)
    assert sum(link.mass for link in system.links) == pytest.approx(2.0, rel=1e-12)


MESH = """<mujoco><compiler meshdir="../meshes"/><asset><mesh name="l" file="link.stl"/><texture name="t" type="2d" file="t.png"/>
<material name="m" texture="t"/></asset><worldbody><geom name="w" type="mesh" mesh="l" material="m"/><body name="p">
<joint name="h" axis="0 1 0"/>
{inertial}<geom name="g" type="mesh" mesh="l"/></body></worldbody>
<contact><pair geom1="g" geom2="w"/></contact></mujoco>"""
INERTIAL = '<inertial pos="0 0 -.1" mass=".3" diaginertia=".001 .001 .0001"/>'
TETRAHEDRON = "v 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def test_meshes_are_not_opened_where_no_mass_comes_of_them(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    system = read(tmp_path / "models", MESH.format(inertial=INERTIAL), "model.xml")
    assert system.links[0].mass == 0.3
    assert any("link.stl" in note for note in system.notes)


def test_meshes_that_give_mass_are_asked_for_and_allowed(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    text = MESH.format(inertial="").replace("link.stl", "link.obj")
    with pytest.raises(InputError, match=r"body 'p' takes its mass from the mesh 'link\.obj'.*outside.*--allow-path"):
        read(tmp_path / "models", text, "model.xml")
    with pytest.raises(InputError, match="which is not there"):
        read(tmp_path / "models", text, "model.xml", allow=[meshes])
    (meshes / "link.obj").write_text(TETRAHEDRON)
    system = read(tmp_path / "models", text, "model.xml", allow=[meshes])
    # Volume of the tetrahedron 0.3³/6 m³, MuJoCo's default density 1000 kg/m³; it keeps vertices in single precision.
    assert system.links[0].mass == pytest.approx(1000.0 * 0.3**3 / 6.0, rel=1e-6)


def test_includes_stay_inside_unless_allowed(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    shared = tmp_path / "shared"
    shared.mkdir()
    (shared / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="h"/><geom size=".1"/></body></worldbody></mujoco>'
    )
    text = '<mujoco><include file="../shared/arm.xml"/></mujoco>'
    with pytest.raises(InputError, match="outside the model's folder"):
        read(tmp_path / "models", text, "model.xml")
    assert read(tmp_path / "models", text, "model.xml", allow=[shared]).joint_names == ("h",)


def test_a_table_saved_as_utf_16_is_told_to_be_no_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes('name = "x"\n'.encode("utf-16"))
    with pytest.raises(InputError, match="is not UTF-8 text"):
        harness.load(path)
    (tmp_path / "rig.urdf").write_bytes(('<?xml version="1.0" encoding="utf-16"?>' + urdf()).encode("utf-16"))
    assert harness.load(tmp_path / "rig.urdf").joint_names == ("j",)
