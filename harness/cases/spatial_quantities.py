"""What only some engines can be asked for: Coriolis matrix, momentum, poses of links, external wrenches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.checks.states import random_states
from harness.compare import quantities
from harness.compare.single_answer import blame_momentum
from harness.denoc import Denoc
from harness.system import System, random_tree

STATES = 6
PINOCCHIO = "pinocchio"
WHY = "one pass over the links: rounding of double precision"


def system() -> System:
    """Twelve joints in general position; no fixed ones, so that every link has a frame in Pinocchio too."""
    return random_tree(12, seed=12, prismatic=0.3, armature=True, damping=True)


def _peer(bench: Bench) -> Any:
    """Pinocchio's model and data, and our index of each of its coordinates; None where it is not installed."""
    return bench.models.get(PINOCCHIO)


def coriolis(bench: Bench) -> Iterable[Row | Series]:
    """C + Cᵀ = Ṁ has but one value, whatever the matrix; and C q̇ is the velocity force.

    Pinocchio's matrix (S. Echeandia and P. Wensing, ASME J. Comput. Nonlinear Dyn. 16, 2021) has the same property.
    """
    peer = _peer(bench)
    if peer is None:
        return
    import pinocchio as pin

    native, states = Denoc(bench.system), random_states(bench, STATES, 1.0, 1.0, 0.0)
    ours, theirs, forces, expected = [], [], [], []
    for q, qd in zip(states.q, states.qd, strict=True):
        c = native.coriolis_matrix(q, qd)
        d = np.empty_like(c)
        found = pin.computeCoriolisMatrix(peer.model, peer.data, q[peer.axes.order], qd[peer.axes.order])
        d[np.ix_(peer.axes.order, peer.axes.order)] = found
        ours.append(c + c.T)
        theirs.append(d + d.T)
        forces.append(c @ qd)
        expected.append(peer.bias(q, qd) - peer.gravity(q))
    yield _row(bench, "coriolis_matrix", np.array(ours), np.array(theirs), {"term": "coriolis_matrix"})
    yield _row(bench, "coriolis_force", np.array(forces), np.array(expected), {"term": "coriolis_matrix"})


def momentum(bench: Bench) -> Iterable[Row | Series]:
    """Pinocchio's centroidal momentum carried over to the base's origin."""
    peer = _peer(bench)
    if peer is None:
        return
    import pinocchio as pin

    native, states = Denoc(bench.system), random_states(bench, STATES, 1.0, 1.0, 0.0)
    ours, theirs = [], []
    for q, qd in zip(states.q, states.qd, strict=True):
        # Without armature, which is no body's inertia: Pinocchio leaves it out of momentum too.
        h = pin.computeCentroidalMomentum(peer.bare, peer.data, q[peer.axes.order], qd[peer.axes.order])
        centre = pin.centerOfMass(peer.bare, peer.data, q[peer.axes.order])
        theirs.append(np.concatenate([h.angular + np.cross(centre, h.linear), h.linear]))
        ours.append(native.momentum(q, qd))
    apart = float(quantities.relative(np.array(ours), np.array(theirs)).max())
    said, place = ("", None) if apart <= 1e-12 else _by_joint(bench, peer, states.q[:3])
    yield bench.row("momentum", (NATIVE, PINOCCHIO), apart, 1e-12, why=WHY, note=said, first_divergence=place)


def _by_joint(bench: Bench, peer: Any, q: Array) -> tuple[str, dict[str, object]]:
    """Whose momentum it is that differs, joint by joint."""
    import pinocchio as pin

    native, names = Denoc(bench.system), bench.system.coordinate_names
    ours, theirs = np.empty((2, len(q), 6, len(names)))
    for state, x in enumerate(q):
        centre = pin.centerOfMass(peer.bare, peer.data, x[peer.axes.order])
        for k, unit in enumerate(np.eye(len(names))):
            h = pin.computeCentroidalMomentum(peer.bare, peer.data, x[peer.axes.order], unit[peer.axes.order])
            theirs[state, :, k] = np.concatenate([h.angular + np.cross(centre, h.linear), h.linear])
            ours[state, :, k] = native.momentum(x, unit)
    return blame_momentum(names, theirs, ours, 1e-12)


def poses(bench: Bench) -> Iterable[Row | Series]:
    """Rotation and place of every link's frame."""
    peer = _peer(bench)
    if peer is None:
        return
    import pinocchio as pin

    native, states = Denoc(bench.system), random_states(bench, STATES, 1.0, 1.0, 0.0)
    ours, theirs = [], []
    for q in states.q:
        pin.forwardKinematics(peer.model, peer.data, q[peer.axes.order])
        for joint in bench.system.joints:
            turn, place = native.link_pose(q, joint.child)
            pose = peer.data.oMi[peer.model.getJointId(joint.name)]
            ours.append(np.append(turn.ravel(), place))
            theirs.append(np.append(pose.rotation.ravel(), pose.translation))
    each = quantities.relative(np.array(ours), np.array(theirs))
    links = [joint.child for joint in bench.system.joints]
    off = [link for k, link in enumerate(links) if not each[k :: len(links)].max() <= 1e-12]
    yield _row(
        bench, "link_pose", np.array(ours), np.array(theirs), {"term": "link_pose", "link": off[0]} if off else {}
    )


def wrenches(bench: Bench) -> Iterable[Row | Series]:
    """Moment and force on every link, given at its frame's origin in base axes, in forward and inverse dynamics."""
    peer = _peer(bench)
    if peer is None:
        return
    import pinocchio as pin

    native, states = Denoc(bench.system), random_states(bench, STATES, 1.0, 1.0, 0.0)
    rng = np.random.default_rng(bench.seed)
    links = bench.system.links
    forward: list[list[Array]] = [[], []]
    inverse: list[list[Array]] = [[], []]
    mass = []
    for q, qd, qdd, tau in zip(states.q, states.qd, states.qdd, states.tau, strict=True):
        w = 5.0 * rng.standard_normal((len(links), 6))
        pin.computeJointJacobians(peer.model, peer.data, q[peer.axes.order])
        moved = np.zeros(len(q))
        for joint, wrench in zip(bench.system.joints, w, strict=True):
            which = peer.model.getJointId(joint.name)
            jacobian = pin.getJointJacobian(peer.model, peer.data, which, pin.LOCAL_WORLD_ALIGNED)
            moved[peer.axes.order] += jacobian.T @ np.concatenate([wrench[3:], wrench[:3]])
        forward[0].append(native.forward_dynamics(q, qd, tau, wrenches=w))
        forward[1].append(peer.forward_dynamics(q, qd, tau + moved))
        inverse[0].append(native.inverse_dynamics(q, qd, qdd, wrenches=w))
        inverse[1].append(peer.inverse_dynamics(q, qd, qdd) - moved)
        mass.append(peer.mass_matrix(q))
    apart = quantities.accelerations(np.array(mass), *map(np.array, forward))
    about: dict[str, object] = {"term": "wrenches"}
    if not apart.max() <= 1e-11:
        about |= _in_wrenches(bench, peer, native, states.q[0])
    yield bench.row("wrenches_forward", (NATIVE, PINOCCHIO), float(apart.max()), 1e-11, why=WHY, about=about)
    yield _row(bench, "wrenches_inverse", np.array(inverse[0]), np.array(inverse[1]), about)


def _in_wrenches(bench: Bench, peer: Any, native: Denoc, q: Array) -> dict[str, object]:
    """The first link whose wrench does not act as Pinocchio's Jacobian of it says, and whether by its moment or its force."""
    import pinocchio as pin

    still = np.zeros(len(q))
    pin.computeJointJacobians(peer.model, peer.data, q[peer.axes.order])
    free = native.inverse_dynamics(q, still, still)
    for k, joint in enumerate(bench.system.joints):
        jacobian = np.empty((6, len(q)))
        which = peer.model.getJointId(joint.name)
        jacobian[:, peer.axes.order] = pin.getJointJacobian(peer.model, peer.data, which, pin.LOCAL_WORLD_ALIGNED)
        for part, first, rows in (("moment", 0, jacobian[3:]), ("force", 3, jacobian[:3])):
            for axis in range(3):
                w = np.zeros((len(bench.system.links), 6))
                w[k, first + axis] = 1.0
                acts = free - native.inverse_dynamics(q, still, still, wrenches=w)
                if not np.abs(acts - rows[axis]).max() <= 1e-9 * max(1.0, np.abs(rows).max()):
                    return {"link": joint.child, "part": part}
    return {}


def _row(bench: Bench, quantity: str, ours: Array, theirs: Array, about: Mapping[str, object]) -> Row:
    apart = float(quantities.relative(ours, theirs).max())
    return bench.row(quantity, (NATIVE, PINOCCHIO), apart, 1e-12, why=WHY, about=about)


CASE = Case(
    name="spatial_quantities",
    title="Coriolis matrix, momentum, poses and wrenches of a tree of twelve joints",
    source="Pinocchio: computeCoriolisMatrix, computeCentroidalMomentum, forwardKinematics, joint Jacobians",
    system=system,
    checks=(
        Measured("coriolis_matrix", coriolis),
        Measured("momentum", momentum),
        Measured("link_pose", poses),
        Measured("wrenches", wrenches),
    ),
    group="scale",
    engines=(NATIVE, PINOCCHIO),
)
