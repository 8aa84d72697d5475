"""Moving on the manifold of positions, in NumPy: what integrators of others, finite differences and comparisons need."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.system.description import Array, System
from harness.system.lowering import position_of_rate

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


def quaternions(system: System) -> tuple[tuple[str, int, int], ...]:
    """Of every joint that turns in space: its name, where its quaternion begins in q, and where its spin begins in v."""
    if system.simple:
        return ()
    positions, velocities = system.position_names, system.coordinate_names
    return tuple(
        (joint.name, positions.index(joint.position_names[-4]), velocities.index(joint.velocity_names[-3]))
        for joint in system.joints
        if joint.turns_in_space
    )


def integrate(system: System, q: Array, step: Array) -> Array:
    """Positions reached from q (nq,) by a step (nv,): velocities held for one second, rotations by the exponential map."""
    found = np.empty_like(q)
    _shift(system, q, step, found)
    if system.simple:
        return found
    from scipy.spatial.transform import Rotation  # slow to import, and most systems have none

    for _, at, spin in quaternions(system):
        turned = _rotation(q[at : at + 4]) * Rotation.from_rotvec(step[spin : spin + 3])
        found[at : at + 4] = turned.as_quat(scalar_first=True)
    return found


def difference(system: System, q0: Array, q1: Array) -> Array:
    """The step (nv,) that ``integrate`` takes from q0 to q1, each (nq,); rotations by the shorter way."""
    step = np.zeros(system.nv)
    if system.simple:
        return q1 - q0
    for at, rate in _plain(system):
        step[rate] = q1[at] - q0[at]
    for _, at, spin in quaternions(system):
        step[spin : spin + 3] = (_rotation(q0[at : at + 4]).inv() * _rotation(q1[at : at + 4])).as_rotvec()
    return step


def position_rates(system: System, q: Array, v: Array) -> Array:
    """Rates of the positions (nq,): velocities, and ½ q ⊗ (0, w) of quaternions, w in the child's axes."""
    found = np.empty_like(q)
    for at, rate in _plain(system):
        found[at] = v[rate]
    for _, at, spin in quaternions(system):
        w, x, y, z = q[at : at + 4]
        matrix = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])
        found[at : at + 4] = 0.5 * matrix @ v[spin : spin + 3]
    return found


def _shift(system: System, q: Array, step: Array, found: Array) -> None:
    if system.simple:
        found[:] = q + step
        return
    for at, rate in _plain(system):
        found[at] = q[at] + step[rate]


def _plain(system: System) -> list[tuple[int, int]]:
    """Positions whose rate is a velocity, with that velocity."""
    return [(int(at), rate) for rate, at in enumerate(position_of_rate(system)) if at >= 0]


def _rotation(quaternion: Array) -> Rotation:
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(quaternion, scalar_first=True)
