"""A system written and read back is the same system; the written files mean the same to MuJoCo and to Pinocchio."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest
from jacobian_mechanics import mass_matrix

import harness
from harness.cases.loop_mechanisms import squeezer
from harness.errors import InputError
from harness.system import Attachment, Joint, JointType, Link, System, random_chain, random_tree, write
from harness.system.description import constant

SYSTEMS = [
    random_tree(6, 1, armature=True, damping=True, fixed=0.3),
    random_tree(12, 2, prismatic=0.5),
    random_chain(9, 3, armature=True, fixed=0.2),
]


def pinocchio_mass_matrix(path: Path, system: System, q: np.ndarray) -> np.ndarray:
    """Pinocchio's mass matrix of a URDF, in our joint order; it knows no armature, which is added as it stands."""
    model = pinocchio.buildModelFromUrdf(str(path))
    order = [model.joints[model.getJointId(name)].idx_v for name in system.joint_names]
    theirs = np.zeros(model.nv)
    theirs[order] = q
    matrix = pinocchio.crba(model, pinocchio.Data(model), theirs)
    matrix = np.triu(matrix) + np.triu(matrix, 1).T
    return matrix[np.ix_(order, order)] + np.diag([joint.armature for joint in system.movable_joints])


def mujoco_mass_matrix(path: Path, system: System, q: np.ndarray) -> np.ndarray:
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    order = [model.joint(name).dofadr[0] for name in system.joint_names]
    data.qpos[order] = q
    mujoco.mj_forward(model, data)
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    return matrix[np.ix_(order, order)]


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_urdf_means_the_same_to_pinocchio(tmp_path: Path, system: System) -> None:
    path = tmp_path / "robot.urdf"
    left_out = write(system, path)
    assert len(left_out) == sum(joint.armature > 0 for joint in system.joints)
    q = np.random.default_rng(8).uniform(-2, 2, len(system.joint_names))
    ours = mass_matrix(system, q)
    np.testing.assert_allclose(pinocchio_mass_matrix(path, system, q), ours, rtol=0, atol=1e-12 * np.abs(ours).max())
    back = harness.load(path)
    assert back.joint_names == system.joint_names
    armature = np.diag([joint.armature for joint in system.movable_joints])
    np.testing.assert_allclose(mass_matrix(back, q) + armature, ours, rtol=0, atol=1e-12 * np.abs(ours).max())


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_mjcf_means_the_same_to_mujoco(tmp_path: Path, system: System) -> None:
    path = tmp_path / "robot.xml"
    assert write(system, path) == ()
    q = np.random.default_rng(9).uniform(-2, 2, len(system.joint_names))
    ours = mass_matrix(system, q)
    np.testing.assert_allclose(mujoco_mass_matrix(path, system, q), ours, rtol=0, atol=1e-12 * np.abs(ours).max())
    back = harness.load(path)
    order = [back.joint_names.index(name) for name in system.joint_names]
    theirs = np.empty(len(q))
    theirs[order] = q
    np.testing.assert_allclose(
        mass_matrix(back, theirs)[np.ix_(order, order)], ours, rtol=0, atol=1e-12 * np.abs(ours).max()
    )


def test_several_joints_on_one_massless_link_become_one_body(tmp_path: Path) -> None:
    """Three crossing and shifted axes with massless links between them, as a gimbal with an offset has."""
    rng = np.random.default_rng(2)
    template = random_chain(3, 5, prismatic=0.4, armature=True)
    links = (Link("link1"), Link("link2"), template.links[2])
    system = replace(template, links=links)
    path = tmp_path / "gimbal.xml"
    assert write(system, path) == ()
    assert mujoco.MjModel.from_xml_path(str(path)).nbody == 2
    q = rng.uniform(-1, 1, 3)
    np.testing.assert_allclose(mujoco_mass_matrix(path, system, q), mass_matrix(system, q), rtol=0, atol=1e-12)
    np.testing.assert_allclose(mass_matrix(harness.load(path), q), mass_matrix(system, q), rtol=0, atol=1e-12)


def rich_flexible() -> System:
    system = random_chain(5, 11, flexible=0.6, modes=3, bending2=True, armature=True, damping=True, fixed=0.3)
    joint = replace(system.joints[0], friction=0.1, stiffness=2.0, rest_position=0.3, lower=-1.0, upper=2.0, effort=9.0)
    return replace(
        system.replace_joint(joint),
        gravity=constant([0.1, 0.2, -1.6]),
        tolerance=0.03,
        base="frame",
        joints=tuple(replace(j, parent="frame") if j.parent == "base" else j for j in (joint, *system.joints[1:])),
        links=tuple(
            replace(link, beam=replace(link.beam, modal_damping=(0.02,), mode_stiffness=(1.1, 0.9)))
            if link.beam
            else link
            for link in system.links
        ),
        attachments=(Attachment("coulomb_friction", "joint1", {"torque": 0.01}, {"torque": 0.001}),),
    )


def test_toml_says_everything(tmp_path: Path) -> None:
    system = rich_flexible()
    assert any(link.flexible for link in system.links) and not all(link.flexible for link in system.links)
    path = tmp_path / "system.toml"
    assert write(system, path) == ()
    back = harness.load(path)
    assert (back.name, back.base, back.tolerance) == (system.name, system.base, system.tolerance)
    np.testing.assert_array_equal(back.gravity, system.gravity)
    assert [vars(a) for a in back.attachments] == [vars(a) for a in system.attachments]
    for ours, theirs in zip(system.joints + system.links, back.joints + back.links, strict=True):
        same(ours, theirs)


def same(a: object, b: object) -> None:
    """Every field equal to rounding."""
    assert type(a) is type(b)
    for field in fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if field.name == "beam" and x is not None:
            same(x, y)
        elif isinstance(x, np.ndarray | float):
            np.testing.assert_allclose(y, x, rtol=1e-12, atol=1e-15, err_msg=field.name)
        else:
            assert x == y, field.name


def test_a_beam_with_stiffness_outright_comes_back(tmp_path: Path) -> None:
    system = rich_flexible()
    link = next(link for link in system.links if link.beam is not None)
    assert link.beam is not None
    beam = replace(
        link.beam,
        bending_stiffness=1.1 * link.beam.bending_stiffness,
        torsion_modes=1,
        torsional_stiffness=0.7,
        polar_inertia=3e-5,
        width=float("nan"),
        thickness=float("nan"),
        density=float("nan"),
    )
    changed = system.replace_link(replace(link, beam=beam))
    path = tmp_path / "system.toml"
    assert write(changed, path) == ()
    same(beam, harness.load(path).link(link.name).beam)


def test_left_out_is_told(tmp_path: Path) -> None:
    system = rich_flexible()
    urdf = " | ".join(write(system, tmp_path / "a.urdf"))
    for word in ("gravity", "tolerance", "coulomb_friction", "armature", "spring", "bending"):
        assert word in urdf
    mjcf = " | ".join(write(system, tmp_path / "a.xml"))
    for word in ("coulomb_friction", "bending", "tolerance"):
        assert word in mjcf
    assert "armature" not in mjcf


def test_a_massless_strut_is_refused_for_mjcf(tmp_path: Path) -> None:
    """MuJoCo takes no moving body without mass, so that a spring's strut, which a loop closes, is no MJCF."""
    file = tmp_path / "squeezer.xml"
    with pytest.raises(InputError, match="'piston' is massless and carries nothing"):
        write(squeezer(), file)
    assert not file.exists()


def test_massless_branch_is_refused_for_mjcf_and_nothing_is_written(tmp_path: Path) -> None:
    body = random_chain(1, 1).links[0]
    joints = tuple(
        Joint(f"j{k}", JointType.REVOLUTE, parent, child)
        for k, (parent, child) in enumerate([("base", "hub"), ("hub", "x"), ("hub", "y")])
    )
    system = System("fork", joints, (Link("hub"), replace(body, name="x"), replace(body, name="y")))
    with pytest.raises(InputError, match="'hub' is massless and branches"):
        write(system, tmp_path / "fork.xml")
    with pytest.raises(InputError, match=r"no format for the ending '\.sdf'"):
        write(system, tmp_path / "fork.sdf")
    with pytest.raises(InputError, match="cannot be written"):
        write(system, tmp_path / "nowhere" / "fork.toml")
    assert list(tmp_path.iterdir()) == []
