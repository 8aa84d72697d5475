"""Rigid chains and trees against Pinocchio and MuJoCo, called directly."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from pinocchio_tree import pinocchio_tree

from harness.denoc import Denoc
from harness.system import System, random_chain, random_tree


def mujoco_model(system: System) -> mujoco.MjModel:
    """A chain or tree in MuJoCo by way of MjSpec (its XML ends near 500 nested bodies)."""
    spec = mujoco.MjSpec()
    spec.option.gravity = system.gravity
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    bodies = {system.base: spec.worldbody}
    for joint, link in zip(system.joints, system.links, strict=True):
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(joint.rotation).ravel())
        xx, xy, xz, _, yy, yz, _, _, zz = np.asarray(link.inertia).ravel()
        body = bodies[joint.parent].add_body(
            name=link.name,
            pos=joint.xyz,
            quat=quaternion,
            mass=link.mass,
            ipos=link.com,
            fullinertia=[xx, yy, zz, xy, xz, yz],
            explicitinertial=True,
        )
        bodies[link.name] = body
        if joint.movable:
            kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.prismatic else mujoco.mjtJoint.mjJNT_HINGE
            body.add_joint(name=joint.name, type=kind, axis=joint.axis, armature=joint.armature)
    return spec.compile()


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


CHAINS = [
    (random_chain(1, 1, prismatic=0.0), 1e-12),
    (random_chain(2, 2, armature=True), 1e-12),
    (random_chain(7, 3, prismatic=0.0), 1e-12),
    (random_chain(7, 4, prismatic=0.4, fixed=0.4, armature=True), 1e-12),
    (random_tree(7, 5), 1e-12),
    (random_chain(50, 6), 1e-10),
    (random_tree(50, 7, fixed=0.2, armature=True), 1e-10),
    (random_chain(200, 8), 1e-9),
]


@pytest.mark.parametrize(("system", "allowed"), CHAINS, ids=lambda value: getattr(value, "name", ""))
def test_accelerations_forces_and_mass_matrix_are_pinocchios(system: System, allowed: float) -> None:
    model = Denoc(system)
    peer, order = pinocchio_tree(system)
    data = pin.Data(peer)
    rng = np.random.default_rng(0)
    q, qd, tau = rng.uniform(-3.0, 3.0, model.n), rng.normal(size=model.n), rng.normal(size=model.n)

    def theirs(ours: np.ndarray) -> np.ndarray:
        result = np.empty(model.n)
        result[order] = ours
        return result

    qdd = model.forward_dynamics(q, qd, tau)
    assert relative(qdd, pin.aba(peer, data, theirs(q), theirs(qd), theirs(tau))[order]) < allowed
    expected = pin.rnea(peer, pin.Data(peer), theirs(q), theirs(qd), theirs(tau))[order]
    assert relative(model.inverse_dynamics(q, qd, tau), expected) < 1e-11
    # Columns by inverse dynamics: Pinocchio's crba wants joints numbered depth first, which a random tree's are not.
    rest = np.zeros(model.n)
    gravity = pin.rnea(peer, data, theirs(q), rest, rest)
    columns = [pin.rnea(peer, data, theirs(q), rest, theirs(e)) - gravity for e in np.eye(model.n)]
    assert relative(model.mass_matrix(q), np.array(columns).T[order]) < 1e-12
    assert relative(model.bias(q, qd), pin.nonLinearEffects(peer, pin.Data(peer), theirs(q), theirs(qd))[order]) < 1e-11


@pytest.mark.parametrize("size", [1e2, 1e4])
def test_far_turned_joints_keep_their_accuracy(size: float) -> None:
    system = random_chain(7, 11, prismatic=0.0)
    model = Denoc(system)
    peer, order = pinocchio_tree(system)
    rng = np.random.default_rng(1)
    for _ in range(20):
        q, qd, tau = rng.uniform(-size, size, 7), rng.normal(size=7), rng.normal(size=7)
        expected = pin.aba(peer, pin.Data(peer), q[order], qd[order], tau[order])
        assert relative(model.forward_dynamics(q, qd, tau), expected) < 1e-12


@pytest.mark.parametrize(
    ("system", "allowed"),
    [
        (random_chain(7, 21, armature=True), 1e-12),
        (random_tree(30, 22), 1e-10),
        (random_chain(50, 23), 1e-10),
        (random_chain(1000, 24, prismatic=0.0, armature=True), 1e-9),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_accelerations_are_mujocos(system: System, allowed: float) -> None:
    model = Denoc(system)
    peer = mujoco_model(system)
    data = mujoco.MjData(peer)
    places = [peer.joint(name).dofadr[0] for name in system.joint_names]
    rng = np.random.default_rng(2)
    q, qd, tau = rng.uniform(-1.0, 1.0, model.n), 0.1 * rng.normal(size=model.n), rng.normal(size=model.n)
    data.qpos[places], data.qvel[places], data.qfrc_applied[places] = q, qd, tau
    mujoco.mj_forward(peer, data)
    # MuJoCo's factorization alone is 2e-9 off at a thousand links; one step of refinement by its own inverse dynamics.
    qacc = data.qacc.copy()
    mujoco.mj_inverse(peer, data)
    correction = np.zeros((1, model.n))
    mujoco.mj_solveM(peer, data, correction, (data.qfrc_applied - data.qfrc_inverse)[None])
    expected = (qacc + correction[0])[places]
    assert relative(model.forward_dynamics(q, qd, tau), expected) < allowed


def test_ten_thousand_links_go_through() -> None:
    """The two recursions, one inwards and one outwards, undo each other on a chain no matrix of which would fit."""
    model = Denoc(random_chain(10_000, 31, prismatic=0.0, armature=True))
    rng = np.random.default_rng(3)
    q, qd = rng.uniform(-0.01, 0.01, model.n), 1e-3 * rng.normal(size=model.n)
    qdd = 1e-3 * rng.normal(size=model.n)
    tau = model.inverse_dynamics(q, qd, qdd)
    assert relative(model.forward_dynamics(q, qd, tau), qdd) < 1e-4
