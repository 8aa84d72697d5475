"""Kinematics and mass matrix of a rigid system straight from its description: sums of JᵀIJ, no recursion, no tree code."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from harness.system import System


def poses(system: System, q: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Rotation and origin of every link frame in the base, joint by joint."""
    placed = {system.base: (np.eye(3), np.zeros(3))}
    positions = dict(zip(system.joint_names, q, strict=True))
    for joint in system.joints:
        rotation, origin = placed[joint.parent]
        origin = origin + rotation @ joint.xyz
        rotation = rotation @ joint.rotation
        value = positions.get(joint.name, 0.0)
        if joint.prismatic:
            origin = origin + rotation @ (joint.axis * value)
        elif joint.movable:
            rotation = rotation @ Rotation.from_rotvec(np.asarray(joint.axis) * value).as_matrix()
        placed[joint.child] = (rotation, origin)
    return placed


def mass_matrix(system: System, q: np.ndarray) -> np.ndarray:
    """Generalized inertia matrix, armature included, from geometric Jacobians of the centres of mass."""
    placed = poses(system, q)
    carrier = {joint.child: joint for joint in system.joints}
    index = {name: k for k, name in enumerate(system.joint_names)}
    matrix = np.diag([joint.armature for joint in system.movable_joints]).astype(float)
    for link in system.links:
        rotation, origin = placed[link.name]
        com = origin + rotation @ link.com
        linear, angular = np.zeros((3, len(index))), np.zeros((3, len(index)))
        name = link.name
        while name in carrier:
            joint = carrier[name]
            if joint.movable:
                turn, anchor = placed[name]
                axis = turn @ joint.axis
                if joint.prismatic:
                    linear[:, index[joint.name]] = axis
                else:
                    linear[:, index[joint.name]] = np.cross(axis, com - anchor)
                    angular[:, index[joint.name]] = axis
            name = joint.parent
        matrix += link.mass * linear.T @ linear + angular.T @ (rotation @ link.inertia @ rotation.T) @ angular
    return matrix
