"""A system without fixed joints: what they tie together becomes one body. For engines that know no welded links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.engines.protocol import Array
from harness.system import Joint, System
from harness.system.inertia import combine


@dataclass(frozen=True, eq=False)
class Body:
    """A movable joint and all that moves rigidly with it, in the order of ``System.movable_joints``.

    parent: index of the body it hangs on, -1 for the base. xyz, rotation: the joint's frame in the parent body's
    frame. mass [kg], com [m] and inertia about it [kg·m²] in the joint's frame.
    """

    joint: Joint
    parent: int
    xyz: Array
    rotation: Array
    mass: float
    com: Array
    inertia: Array


def bodies(system: System) -> tuple[tuple[Body, ...], float]:
    """The moving bodies of a rigid system, and the potential energy [J] of all that is fixed to the base."""
    frames: dict[str, tuple[int, Array, Array]] = {system.base: (-1, np.eye(3), np.zeros(3))}
    parts: list[list[tuple[float, Array, Array]]] = []
    places: list[tuple[Joint, int, Array, Array]] = []
    fixed_potential = 0.0
    for joint, link in zip(system.joints, system.links, strict=True):
        body, turn, shift = frames[joint.parent]
        rotation, xyz = turn @ joint.rotation, shift + turn @ joint.xyz
        if joint.movable:
            places.append((joint, body, xyz, rotation))
            parts.append([])
            body, rotation, xyz = len(places) - 1, np.eye(3), np.zeros(3)
        frames[joint.child] = (body, rotation, xyz)
        com = xyz + rotation @ link.com
        if body < 0:
            fixed_potential -= link.mass * float(system.gravity @ com)
        else:
            parts[body].append((link.mass, com, rotation @ link.inertia @ rotation.T))
    whole = []
    for (joint, parent, xyz, rotation), pieces in zip(places, parts, strict=True):
        mass, com, inertia = combine(*pieces)
        whole.append(Body(joint, parent, xyz, rotation, mass, com, inertia))
    return tuple(whole), fixed_potential
