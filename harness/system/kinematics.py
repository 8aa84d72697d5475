"""Where the frames of a rigid tree are and how they move, in plain NumPy: for closing loops when a file is read.

Slow and short; the compiled recursions are held against it in tests.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.system.description import Array, Link, System
from harness.system.inertia import about_origin
from harness.system.lowering import Lowered, lower
from harness.system.rotation import about_axis, skew


@dataclass(frozen=True, eq=False)
class Pose:
    """A frame in base coordinates: rotation (3, 3), origin (3,), and the twist's Jacobian (angular, linear), (6, m)."""

    rotation: Array
    origin: Array
    jacobian: Array

    def at(self, xyz: Array, rotation: Array) -> Pose:
        """A frame fixed to this one."""
        arm = self.rotation @ xyz
        moved = self.jacobian.copy()
        moved[3:] -= skew(arm) @ self.jacobian[:3]
        return Pose(self.rotation @ rotation, self.origin + arm, moved)


def poses(lowered: Lowered, q: Array) -> dict[str, Pose]:
    """Poses of all links and the base by name at positions q (nq,); Jacobians are those of the velocities (nv)."""
    system = lowered.recentred(q)
    local = lowered.position(q)
    nv = lowered.rates.shape[1]
    found = {system.base: Pose(np.eye(3), np.zeros(3), np.zeros((6, nv)))}
    coordinates = list(system.coordinate_names)
    for joint in system.joints:
        pose = found[joint.parent].at(np.asarray(joint.xyz), np.asarray(joint.rotation))
        if joint.movable:
            k = coordinates.index(joint.name)
            axis = pose.rotation @ np.asarray(joint.axis)
            if joint.prismatic:
                pose = pose.at(np.asarray(joint.axis) * local[k], np.eye(3))
                pose.jacobian[3:] += np.outer(axis, lowered.rates[k])
            else:
                pose = pose.at(np.zeros(3), about_axis(joint.axis, float(local[k])))
                pose.jacobian[:3] += np.outer(axis, lowered.rates[k])
        found[joint.child] = pose
    return found


def mass_matrix(system: System, q: Array) -> Array:
    """Generalized inertia matrix of the tree, beams frozen, armature included, shape (nv, nv): Σ Jᵀ M J over the links."""
    lowered = lower(system)
    at = poses(lowered, q)
    armature = [joint.armature for joint in lowered.system.movable_joints]
    total = lowered.rates.T @ np.diag(armature) @ lowered.rates
    for link in lowered.system.links:
        pose = at[link.name]
        turned = np.vstack([pose.rotation.T @ pose.jacobian[:3], pose.rotation.T @ pose.jacobian[3:]])
        total = total + turned.T @ spatial_inertia(link) @ turned
    return np.asarray(total)


def spatial_inertia(link: Link) -> Array:
    """Generalized inertia matrix of a link about its origin, (angular, linear), shape (6, 6)."""
    first = link.mass * skew(link.com)
    return np.block([[about_origin(link), first], [first.T, link.mass * np.eye(3)]])


def gravity_forces(system: System, q: Array) -> Array:
    """Generalized forces of gravity on the tree, beams frozen, shape (nv,): Σ m Jᵀ g at the centres of mass."""
    at = poses(lower(system), q)
    moved = (link.mass * at[link.name].at(np.asarray(link.com), np.eye(3)).jacobian[3:] for link in system.links)
    return np.asarray(sum(moved, np.zeros((3, system.nv))).T @ np.asarray(system.gravity))
