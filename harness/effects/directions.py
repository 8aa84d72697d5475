"""Directions in the base that effects of the whole mechanism act along."""

from __future__ import annotations

import numpy as np

from harness.effects.scale import zero_poses
from harness.system import Joint, System
from harness.system.description import Array

UP = (0.0, 0.0, 1.0)


def first_axis(system: System) -> Array:
    """Axis of the first movable joint in base coordinates at zero position, shape (3,); x if there is none."""
    movable = system.movable_joints
    if not movable:
        return np.array([1.0, 0.0, 0.0])
    return _axis(system, movable[0])


def turning_axis(system: System) -> Array:
    """Axis of the first joint that turns, in base coordinates at zero position, shape (3,); the first axis if none turns.

    A slide before it, be it a cart or a stand that gives, is tilted with the base and not about itself.
    """
    turning = [joint for joint in system.movable_joints if not joint.prismatic]
    return _axis(system, turning[0]) if turning else first_axis(system)


def _axis(system: System, joint: Joint) -> Array:
    """A joint's axis in base coordinates at zero position, shape (3,)."""
    rotation, _ = zero_poses(system)[joint.child]
    return np.asarray(rotation @ joint.axis)


def upward(system: System) -> Array:
    """Unit vector against gravity in base coordinates, shape (3,); z without gravity."""
    size = float(np.linalg.norm(system.gravity))
    return -np.asarray(system.gravity) / size if size > 0.0 else np.array(UP)


def sideways(system: System) -> Array:
    """Horizontal unit vector in the plane of motion, axis × down, in base coordinates, shape (3,).

    It is where a positive first joint moves a hanging tip. A prismatic first joint gives its own horizontal direction; a
    joint that turns about the vertical gives x.
    """
    axis, up = first_axis(system), upward(system)
    movable = system.movable_joints
    across = axis - up * (axis @ up) if movable and movable[0].prismatic else np.cross(axis, -up)
    if np.linalg.norm(across) < 1e-9:
        across = np.cross(np.array([0.0, 1.0, 0.0]), up)
        if np.linalg.norm(across) < 1e-9:
            across = np.cross(np.array([1.0, 0.0, 0.0]), up)
    return np.asarray(across / np.linalg.norm(across))
