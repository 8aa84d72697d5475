"""Rotations between the ways that model files write them and 3 x 3 matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from harness.system.description import Array


def from_rpy(rpy: ArrayLike) -> Array:
    """Matrix of roll, pitch, yaw about the fixed x, y, z axes, R = Rz(yaw) Ry(pitch) Rx(roll), as URDF means them.

    rpy: angles [rad], shape (3,). Returns shape (3, 3).
    """
    roll, pitch, yaw = np.asarray(rpy, dtype=np.float64)
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def to_rpy(rotation: ArrayLike) -> Array:
    """Roll, pitch, yaw [rad] of a rotation matrix, shape (3,); reproduces the matrix to rounding even at pitch ±90°."""
    r = np.asarray(rotation, dtype=np.float64)
    yaw = np.arctan2(r[1, 0], r[0, 0])
    cy, sy = np.cos(yaw), np.sin(yaw)
    # Roll is read after yaw has been taken out, so that an arbitrary yaw at gimbal lock is made good by roll.
    pitch = np.arctan2(-r[2, 0], cy * r[0, 0] + sy * r[1, 0])
    roll = np.arctan2(sy * r[0, 2] - cy * r[1, 2], cy * r[1, 1] - sy * r[0, 1])
    return np.array([roll, pitch, yaw])


def from_quaternion(quaternion: ArrayLike) -> Array:
    """Matrix of a quaternion (w, x, y, z), which need not be of unit length, shape (3, 3)."""
    q = np.asarray(quaternion, dtype=np.float64)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix, shape (4,)."""
    from scipy.spatial.transform import Rotation  # slow to import, and most systems are only read

    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z])


def about_axis(axis: ArrayLike, angle: float) -> Array:
    """Matrix of a turn by ``angle`` [rad] about a unit axis (Rodrigues), shape (3, 3)."""
    k = skew(axis)
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


def skew(vector: ArrayLike) -> Array:
    """Matrix S with S x = vector × x, shape (3, 3)."""
    x, y, z = np.asarray(vector, dtype=np.float64)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def along_z(axis: ArrayLike) -> Array:
    """A rotation whose third column is the direction ``axis``: the least turn from z, or from -z if that is nearer, (3, 3)."""
    x, y, z = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    if z >= 0.0:
        h = 1.0 / (1.0 + z)
        return np.array([[1.0 - h * x * x, -h * x * y, x], [-h * x * y, 1.0 - h * y * y, y], [-x, -y, z]])
    # Turned over first, so that an axis near -z does not divide by something small.
    h = 1.0 / (1.0 - z)
    return np.array([[1.0 - h * x * x, h * x * y, x], [-h * x * y, h * y * y - 1.0, y], [x, -y, z]])
