"""URDF means here what it means to Pinocchio, on made-up robots and on the published ones of example-robot-data."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from jacobian_mechanics import mass_matrix, poses

import harness
from harness.errors import InputError, UnsupportedError
from harness.system.lowering import freed

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="foot"><inertial><mass value="3"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 -0.2 0.3" rpy="0.3 -0.4 0.5"/>
      <mass value="1.5"/>
      <inertia ixx="0.02" ixy="0.001" ixz="-0.002" iyy="0.03" iyz="0.003" izz="0.025"/>
    </inertial>
  </link>
  <link name="flange"/>
  <link name="slider"><inertial><mass value="0.5"/><inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/>
  </inertial></link>
  <link name="wheel">
    <inertial><origin xyz="0 0.01 0"/><mass value="0.2"/>
    <inertia ixx="1e-4" ixy="0" ixz="0" iyy="2e-4" iyz="0" izz="1e-4"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="foot"/><child link="upper"/><origin xyz="0 0 1" rpy="0.1 0.2 0.3"/><axis xyz="0 3 4"/>
    <limit lower="-1" upper="2" effort="10" velocity="3"/><dynamics damping="0.3" friction="0.04"/>
  </joint>
  <joint name="weld" type="fixed"><parent link="upper"/><child link="flange"/><origin rpy="1.5708 0 0"/></joint>
  <joint name="slide" type="prismatic">
    <parent link="flange"/><child link="slider"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.4" effort="1" velocity="1"/><mimic joint="shoulder"/>
  </joint>
  <joint name="spin" type="continuous"><parent link="slider"/><child link="wheel"/></joint>
</robot>
"""


def load_text(folder: Path, text: str, **options: object) -> harness.System:
    path = folder / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    return harness.load(path, **options)


def pinocchio_comparison(path: Path, system: harness.System) -> tuple[float, float]:
    """Largest differences of mass matrix (relative) and of joint placement [m] at a random pose, Pinocchio against us."""
    model = pinocchio.buildModelFromUrdf(str(path))
    data = pinocchio.Data(model)
    q = np.random.default_rng(3).uniform(-1.0, 1.0, len(system.joint_names))
    theirs = pinocchio.neutral(model)
    order = []
    for name, value in zip(system.joint_names, q, strict=True):
        joint = model.joints[model.getJointId(name)]
        order.append(joint.idx_v)
        # Pinocchio keeps the cosine and sine of a continuous joint.
        theirs[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
    assert sorted(order) == list(range(model.nv))
    matrix = pinocchio.crba(model, data, theirs)
    matrix = (np.triu(matrix) + np.triu(matrix, 1).T)[np.ix_(order, order)]
    ours = mass_matrix(system, q)
    pinocchio.forwardKinematics(model, data, theirs)
    placed = poses(system, q)
    places = [
        np.abs(data.oMi[model.getJointId(joint.name)].translation - placed[joint.child][1]).max()
        for joint in system.movable_joints
    ]
    return float(np.abs(ours - matrix).max() / np.abs(matrix).max()), float(max(places))


def test_arm_is_pinocchios(tmp_path: Path) -> None:
    system = load_text(tmp_path, ARM)
    # Pinocchio reads a mimicking joint as an independent one.
    assert max(pinocchio_comparison(tmp_path / "robot.urdf", freed(system))) < 1e-13
    assert [(joint.name, joint.mimic.joint) for joint in system.joints if joint.mimic] == [("slide", "shoulder")]
    assert system.coordinate_names == ("shoulder", "spin")
    assert system.base == "foot"
    assert system.joint_names == ("shoulder", "slide", "spin")
    shoulder = system.joint("shoulder")
    np.testing.assert_allclose(shoulder.axis, [0.0, 0.6, 0.8], rtol=1e-15)
    assert (shoulder.damping, shoulder.friction, shoulder.lower, shoulder.upper) == (0.3, 0.04, -1.0, 2.0)
    assert (shoulder.effort, shoulder.velocity) == (10.0, 3.0)
    np.testing.assert_array_equal(system.joint("spin").axis, [1.0, 0.0, 0.0])  # the format's default
    notes = " | ".join(system.notes)
    assert "axis of length 5" in notes and "'foot' is the fixed base" in notes


def published_robots() -> list[Path]:
    try:
        package = importlib.metadata.distribution("example-robot-data")
    except importlib.metadata.PackageNotFoundError:
        return []
    return sorted(Path(str(package.locate_file("cmeel.prefix/share/example-robot-data/robots"))).rglob("*.urdf"))


def test_published_robots_are_read_as_pinocchio_reads_them_or_refused_in_one_line() -> None:
    paths = published_robots()
    if not paths:
        pytest.skip("example-robot-data is not installed (optional extra 'robots')")
    read, unphysical, refused, not_pinocchios = [], [], [], []
    for path in paths:
        try:
            pinocchio.buildModelFromUrdf(str(path))
        except ValueError:
            not_pinocchios.append(path.name)
            continue
        try:
            system = harness.load(path, physical=False)
        except InputError as error:
            assert "\n" not in str(error) and path.name in str(error)
            refused.append(str(error))
            continue
        difference, displacement = pinocchio_comparison(path, freed(system))
        assert difference < 1e-12, path
        assert displacement < 1e-12, path
        read.append(path.name)
        try:
            harness.load(path)
        except InputError as error:
            unphysical.append(str(error))
    # Of the files of release 6.0: no joint at all (hector, iris_simple) or grippers without any inertia (romeo).
    assert len(read) >= 64
    for line in refused:
        assert "nothing can move" in line or "inertia about its axis is zero" in line, line
    for line in unphysical:
        assert "triangle inequality" in line or "is negative" in line or "mass is zero" in line, line
    print(f"{len(read)} read, {len(unphysical)} of them unphysical; {len(refused)} refused; {not_pinocchios=}")


def body(inertia: str = 'ixx="1e-3" iyy="1e-3" izz="1e-3"', mass: str = "1", name: str = "arm") -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 -0.1"/><mass value="{mass}"/>\n<inertia {inertia}/>'
        "</inertial></link>\n"
    )


def joint(extra: str = '<axis xyz="0 1 0"/>', kind: str = "continuous", ends: tuple[str, str] = ("base", "arm")) -> str:
    return f'<joint name="pivot" type="{kind}"><parent link="{ends[0]}"/><child link="{ends[1]}"/>\n{extra}</joint>\n'


ROBOT = '<robot name="r">\n<link name="base"/>\n{}</robot>'

REFUSED = {
    "broken XML": ("<robot><link></robot>", r"robot\.urdf:1, column \d+: broken XML"),
    "unknown type": (
        ROBOT.format(body() + joint(kind="hinge")),
        r"robot\.urdf:5: joint 'pivot': unknown joint type 'hinge'",
    ),
    "zero axis": (
        ROBOT.format(body() + joint('<axis xyz="0 0 0"/>')),
        r"robot\.urdf:6: joint 'pivot': axis has zero length",
    ),
    "short axis": (ROBOT.format(body() + joint('<axis xyz="0 1"/>')), r":6: .*has 2 value\(s\) \(give 3\)"),
    "axis of words": (ROBOT.format(body() + joint('<axis xyz="a b c"/>')), r":6: .*'a b c' is not a number"),
    "NaN": (ROBOT.format(body(mass="nan") + joint()), r":3: link 'arm': value='nan' is not finite"),
    "infinite": (ROBOT.format(body('ixx="inf" iyy="1" izz="1"') + joint()), r":4: link 'arm': ixx='inf' is not finite"),
    "missing moment": (ROBOT.format(body('ixx="1" iyy="1"') + joint()), r":4: link 'arm': <inertia> has no izz"),
    "negative mass": (ROBOT.format(body(mass="-1") + joint()), r":3: link 'arm': mass -1 kg is negative"),
    "negative inertia": (
        ROBOT.format(body('ixx="-1" iyy="1" izz="1"') + joint()),
        r":3: link 'arm': principal .* negative",
    ),
    "triangle": (ROBOT.format(body('ixx="1" iyy="1" izz="3"') + joint()), r":3: link 'arm': .*triangle inequality"),
    "no inertia": (ROBOT.format('<link name="arm"/>' + joint()), r":3: joint 'pivot': inertia about its axis is zero"),
    "duplicate link": (ROBOT.format(body() + body() + joint()), r":5: two links are named 'arm'"),
    "duplicate joint": (ROBOT.format(body() + joint() + joint()), r":7: two joints are named 'pivot'"),
    "unknown child": (ROBOT.format(body() + joint(ends=("base", "amr"))), r":5: .*child 'amr' is not a link.*'arm'"),
    "unknown parent": (ROBOT.format(body() + joint(ends=("bse", "arm"))), r":5: .*parent 'bse' is not a link.*'base'"),
    "loop": (ROBOT.format(body() + joint(ends=("arm", "base")) + joint().replace("pivot", "p2")), r"cyclic tree"),
    "two parents": (
        ROBOT.format(body() + joint() + joint().replace("pivot", "second")),
        r":7: link 'arm' has two parents: joints 'pivot' and 'second'",
    ),
    "unreachable": (
        ROBOT.format(body() + body(name="stray") + joint()),
        r":5: link 'stray' cannot be reached from 'base'",
    ),
    "self": (ROBOT.format(body() + joint(ends=("arm", "arm"))), r"links arm → arm form a loop"),
    "negative damping": (
        ROBOT.format(body() + joint('<axis xyz="0 1 0"/><dynamics damping="-1"/>')),
        r":6: joint 'pivot': damping -1 is negative",
    ),
    "no name": ('<robot name="r"><link/></robot>', r":1: <link> has no name"),
    "no links": ('<robot name="r"></robot>', r"there is no <link>"),
    "not a robot": ("<sdf><model/></sdf>", r"the root element is <sdf> \(URDF begins with <robot>"),
    "entities": (
        '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="&x;"/>',
        r"document type declaration",
    ),
    "swelling entities": (
        '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]><robot name="r">&b;</robot>',
        r"document type declaration",
    ),
}


@pytest.mark.parametrize(("text", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_refused_in_one_line_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        load_text(tmp_path, text)
    assert "\n" not in str(caught.value)
    assert str(tmp_path / "robot.urdf") in str(caught.value)


@pytest.mark.parametrize("kind", ["ball", "screw"])
def test_joints_of_dialects_are_named(tmp_path: Path, kind: str) -> None:
    with pytest.raises(UnsupportedError, match=rf":5: joint 'pivot': type '{kind}' is not modelled"):
        load_text(tmp_path, ROBOT.format(body() + joint(kind=kind)))


@pytest.mark.parametrize(("kind", "degrees"), [("floating", (7, 6)), ("planar", (3, 3))])
def test_floating_and_planar_joints_are_read(tmp_path: Path, kind: str, degrees: tuple[int, int]) -> None:
    system = load_text(tmp_path, ROBOT.format(body() + joint(kind=kind)))
    assert (system.nq, system.nv) == degrees


def test_the_root_floats_on_request_as_pinocchio_lets_it(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(ARM)
    system = freed(harness.load(path, floating=True))
    assert (system.base, system.joints[0].name, system.joints[0].child) == ("world", "root_joint", "foot")
    model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    q = pinocchio.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    theirs = pinocchio.crba(model, data, q)
    theirs = np.triu(theirs) + np.triu(theirs, 1).T
    ours = harness.Denoc(system)
    turn = pinocchio.Quaternion(q[3:7]).matrix()
    # w first; linear velocity in the world where Pinocchio has the child's axes; its coordinates by name.
    position = ours.neutral
    position[:7] = [*q[:3], q[6], *q[3:6]]
    jacobian = np.zeros((model.nv, ours.n))
    jacobian[:3, :3], jacobian[3:6, 3:6] = turn.T, np.eye(3)
    for name in system.joint_names[1:]:
        joint = model.joints[model.getJointId(name)]
        value = q[joint.idx_q] if joint.nq == 1 else np.arctan2(q[joint.idx_q + 1], q[joint.idx_q])
        position[system.position_names.index(name)] = value
        jacobian[joint.idx_v, system.coordinate_names.index(name)] = 1.0
    np.testing.assert_allclose(ours.mass_matrix(position), jacobian.T @ theirs @ jacobian, atol=1e-13)
    with pytest.raises(InputError, match="a floating root is asked for, and the file is no URDF"):
        (tmp_path / "x.toml").write_text("name = 'x'")
        harness.load(tmp_path / "x.toml", floating=True)


def test_a_mimic_of_what_is_no_joint_is_told(tmp_path: Path) -> None:
    system = load_text(tmp_path, ARM.replace('<mimic joint="shoulder"/>', '<mimic joint="elbow"/>'))
    assert any("mimics 'elbow', which is no joint" in note for note in system.notes)
    assert system.simple


def test_xacro_is_sent_to_xacro(tmp_path: Path) -> None:
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<xacro:macro name="m"/></robot>'
    with pytest.raises(UnsupportedError, match=r":2: <xacro:macro> is not expanded"):
        load_text(tmp_path, text)


def test_inertia_that_is_only_rounding_is_a_point_mass(tmp_path: Path) -> None:
    def robot(moment: str) -> str:
        return f"""<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
        <inertia ixx="0" ixy="0" ixz="{moment}" iyy="0" iyz="0" izz="0"/></inertial></link>
        <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>"""

    # About the link's origin 0.02 kg·m²: 1e-20 of that is what a subtraction leaves, 1e-3 of it is a mistake.
    system = load_text(tmp_path, robot("1.35525e-20"))
    np.testing.assert_array_equal(system.links[0].inertia, np.zeros((3, 3)))
    (note,) = system.notes
    assert "'arm'" in note and "rounding" in note
    with pytest.raises(InputError, match="negative"):
        load_text(tmp_path, robot("2e-5"))


def test_unphysical_inertia_may_be_taken_as_it_stands_if_the_joint_has_inertia(tmp_path: Path) -> None:
    """About the joint 1·0.1² - 0.005 = 0.005 kg·m² is left: an estimate about the axis that was split badly."""
    text = ROBOT.format(body('ixx="-0.005" iyy="-0.005" izz="1e-9"') + joint())
    with pytest.raises(InputError, match="physical=False"):
        load_text(tmp_path, text)
    system = load_text(tmp_path, text, physical=False)
    assert any("taken as it stands" in note for note in system.notes)
    np.testing.assert_allclose(mass_matrix(system, np.zeros(1)), [[0.005]], rtol=1e-12)
    with pytest.raises(InputError, match="joint 'pivot': inertia about its axis is negative"):
        load_text(tmp_path, ROBOT.format(body('ixx="-0.02" iyy="-0.02" izz="1e-9"') + joint()), physical=False)


def test_limits_beyond_any_machine_mean_none(tmp_path: Path) -> None:
    text = joint('<axis xyz="0 1 0"/><limit lower="-1e9" upper="1e12" effort="inf" velocity="2"/>', kind="revolute")
    pivot = load_text(tmp_path, ROBOT.format(body() + text)).joint("pivot")
    assert (pivot.lower, pivot.upper, pivot.effort, pivot.velocity) == (-np.inf, np.inf, np.inf, 2.0)


@pytest.mark.parametrize(
    ("plain", "left_over"),
    [
        ('xyz="0 1 0"', 'xyz="${axis} 1 0"'),
        ('name="pivot"', 'name="${prefix}pivot"'),
        ('value="0.2"', 'value="$(arg mass)"'),
    ],
)
def test_expressions_of_xacro_that_were_not_expanded_are_no_names_and_no_numbers(tmp_path, plain, left_over):
    text = """<robot name="r"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.15"/><mass value="0.2"/>
<inertia ixx="1.5e-3" iyy="1.5e-3" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="$(find rig)/rod.stl"/></geometry></visual></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""
    file = tmp_path / "rig.urdf"
    file.write_text(text)
    assert harness.load(file).joint_names == ("pivot",)
    file.write_text(text.replace(plain, left_over))
    with pytest.raises(UnsupportedError, match=r"rig.urdf:\d: .* is not expanded \(run `xacro"):
        harness.load(file)
