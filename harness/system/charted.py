"""Joints that turn in space as chains of joints of one degree of freedom in a chart that keeps off its singular rotations.

Three angles reach every rotation but singular ones, where the middle angle is a quarter of a turn. Which rotations these are is
free to choose: with R = A Rx(a) Ry(b) Rz(c) Cᵀ they are those that take the body's direction C z to ± A x. A motion that is known
has a chart as long as some direction of the body keeps off some axis of space.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.errors import UnsupportedError
from harness.system.description import Array, Gimbal, Joint, JointType, Link, System, constant
from harness.system.rotation import along_z

TURNS = ("rx", "ry", "rz")
SHIFTS = ("x", "y", "z")
FARTHEST = 0.97  # sine of the middle angle that a chart may come to
DIRECTIONS = 200  # of the body and of space that are tried
SAMPLES = 400
LIKELY = 50
_UNIT = np.eye(3)


@dataclass(frozen=True, eq=False)
class Chart:
    """Rotations R (in the joint's frame) by three angles: R = before · Rx(a) Ry(b) Rz(c) · afterᵀ. Both are (3, 3)."""

    before: Array
    after: Array

    def angles(self, rotations: Array) -> Array:
        """The angles [rad] of rotations (T, 3, 3), continuous along the samples that are finite, shape (T, 3)."""
        turned = np.einsum("ji,tjk,kl->til", self.before, rotations, self.after)
        middle = np.arcsin(np.clip(turned[:, 0, 2], -1.0, 1.0))
        first = np.arctan2(-turned[:, 1, 2], turned[:, 2, 2])
        last = np.arctan2(-turned[:, 0, 1], turned[:, 0, 0])
        out = np.stack([first, middle, last], axis=1)
        good = np.isfinite(out).all(axis=1)
        out[good] = np.unwrap(out[good], axis=0)
        return out


def chart_for(rotations: Array) -> Chart | None:
    """The chart that recorded rotations (T, 3, 3) keep farthest off being singular in; None if none keeps off far enough."""
    good = rotations[np.isfinite(rotations).all(axis=(1, 2))]
    some = good[:: max(1, len(good) // SAMPLES)]
    every = _directions(DIRECTIONS)
    # |s · R u| of every direction s of space and u of the body, the largest along the motion.
    turned = np.einsum("tij,uj->tui", some, every)
    worst = np.abs(np.einsum("tui,si->tsu", turned, every)).max(axis=0)
    # Of those that some samples keep off, the one that all do.
    likely = [np.unravel_index(k, worst.shape) for k in np.argsort(worst, axis=None)[:LIKELY].tolist()]
    reached = [float(np.abs(np.einsum("i,tij,j->t", every[s], good, every[u])).max()) for s, u in likely]
    s, u = likely[int(np.argmin(reached))]
    if min(reached) > FARTHEST:
        return None
    # Columns beginning with the direction: of space the first one, of the body the last one.
    before = np.roll(along_z(every[s]), 1, axis=1)
    after = along_z(every[u])
    return Chart(constant(before), constant(after))


def _directions(count: int) -> Array:
    """Directions spread evenly over half the sphere, shape (count, 3), the axes before others."""
    k = np.arange(count) + 0.5
    z, turn = k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    around = np.stack([np.sqrt(1.0 - z**2) * np.cos(turn), np.sqrt(1.0 - z**2) * np.sin(turn), z], axis=1)
    return np.concatenate([_UNIT, around])


def turning(system: System) -> tuple[Joint, ...]:
    """The balls and free joints."""
    return tuple(joint for joint in system.joints if joint.turns_in_space)


def charted(system: System, charts: Mapping[str, Chart]) -> System:
    """The system with its balls and free joints as slides and turns in a chart each, by the joint's name.

    Their damping goes to ``System.gimbals``, armature to the body. Raises UnsupportedError for armature between two bodies that
    move.
    """
    if not turning(system):
        return system
    joints: list[Joint] = []
    links: list[Link] = []
    gimbals: list[Gimbal] = []
    still = {system.base}
    for joint, link in zip(system.joints, system.links, strict=True):
        if not joint.movable and joint.parent in still:
            still.add(joint.child)
        if not joint.turns_in_space:
            joints.append(joint)
            links.append(link)
            continue
        if joint.armature:
            link = _heavier(system, joint, link, still)
        parts, groups = _parts(joint, charts[joint.name])
        joints += parts
        links += [link if part is parts[-1] else Link(part.child) for part in parts]
        gimbals += groups
    return replace(system, joints=tuple(joints), links=tuple(links), gimbals=tuple(gimbals), keyframes=())


def _heavier(system: System, joint: Joint, link: Link, still: set[str]) -> Link:
    """The link with a joint's armature, which is as much inertia about every axis where the other side does not move."""
    if joint.parent not in still or (joint.type is JointType.FREE and link.mass <= 0.0):
        raise UnsupportedError(
            f"joint {joint.name!r} has armature between two bodies that move, which a chart does not hold",
            mend="give the inertia to the bodies",
            source=system.source,
        )
    mass = joint.armature if joint.type is JointType.FREE else 0.0
    if mass:
        raise UnsupportedError(
            f"free joint {joint.name!r} has armature, which a chart does not hold",
            mend="give mass and inertia to the body",
            source=system.source,
        )
    return replace(link, inertia=constant(np.asarray(link.inertia) + joint.armature * _UNIT))


def _parts(joint: Joint, chart: Chart) -> tuple[list[Joint], list[Gimbal]]:
    free = joint.type is JointType.FREE
    kinds: list[tuple[str, JointType, NDArray[np.float64]]] = []
    if free:
        kinds += [(name, JointType.PRISMATIC, _UNIT[k]) for k, name in enumerate(SHIFTS)]
    kinds += [(name, JointType.REVOLUTE, _UNIT[k]) for k, name in enumerate(TURNS)]
    parts: list[Joint] = []
    parent = joint.parent
    for name, kind, axis in kinds:
        child = f"{joint.child}__{joint.name}.{name}"
        part = Joint(f"{joint.name}.{name}", kind, parent, child, axis=constant(axis))
        if not parts:
            part = replace(part, xyz=joint.xyz, rotation=joint.rotation)
        if name == TURNS[0]:
            part = replace(part, rotation=constant(np.asarray(part.rotation) @ chart.before))
        parts.append(part)
        parent = child
    parts.append(Joint(f"{joint.name}.frame", JointType.FIXED, parent, joint.child, rotation=constant(chart.after.T)))

    def group(ending: str, names: Sequence[str], slides: bool) -> Gimbal:
        first, second, third = (f"{joint.name}.{name}" for name in names)
        return Gimbal(joint.name + ending, joint.name, joint.child, (first, second, third), slides, joint.damping)

    turns = group(".turn" if free else "", TURNS, False)
    return parts, [group(".shift", SHIFTS, True), turns] if free else [turns]
