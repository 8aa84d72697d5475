"""Which number of a mechanism's description would make one engine answer as another does.

Every number of the description is tried in turn, joint by joint and link by link: moved (as a group: the three of a centre of
mass, the six of an inertia) until the trusted engine's inverse dynamics are the other's, by Gauss-Newton. The smallest group
that does it wholly is named, with its place and by how much; beside it, what of bodies that turn together does it with as few
directions (the inertia of a first link beside the armature of its joint). Inverse dynamics at random velocities and accelerations
see all that is in the equations of motion: inertia, frames, armature, damping, springs, gravity.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.engines.protocol import EngineModel
from harness.errors import InputError
from harness.system import Joint, Link, System
from harness.system.description import JointType, constant

Array = NDArray[np.float64]
BODY = "body"
Build = Callable[[System], EngineModel]

# What may be left of a difference that a group of numbers explains, and how often it is linearized anew.
LEFT, STEPS = 1e-4, 5


@dataclass(frozen=True)
class Group:
    """Numbers that are moved together: owner (``link``, ``joint`` or ``base``), its name, the member, how many."""

    owner: str
    name: str
    member: str
    size: int

    def said(self) -> str:
        return f"{self.member.replace('_', ' ')}" + (f" of {self.owner} {self.name!r}" if self.owner != "base" else "")


@dataclass(frozen=True)
class Explanation:
    """A group and by how much it is off, in SI units (rad for rotations).

    left: share of the difference that stays. directions: how many of the group's numbers, or sums of them, the forces hang on.
    """

    group: Group
    off: Array
    left: float
    directions: int

    @property
    def place(self) -> dict[str, object]:
        return {self.group.owner: self.group.name, "value": self.group.member}

    def sentence(self) -> str:
        if self.group.member == BODY:
            return f"as if mass, centre of mass and inertia of link {self.group.name!r} were off together"
        amounts = ", ".join(f"{value:+.3g}" for value in self.off)
        return f"as if the {self.group.said()} were off by {amounts if len(self.off) == 1 else f'({amounts})'}"


def groups(system: System) -> Iterator[Group]:
    """Every group of numbers that the dynamics hang on, small groups first."""
    for link in system.links:
        yield Group("link", link.name, "mass", 1)
    for joint in system.movable_joints:
        for member in ("armature", "damping", "stiffness", "rest_position"):
            if member != "rest_position" or joint.stiffness:
                yield Group("joint", joint.name, member, 1)
    for link in system.links:
        yield Group("link", link.name, "com", 3)
    for joint in system.joints:
        if joint.movable:
            yield Group("joint", joint.name, "axis", 3)
        yield Group("joint", joint.name, "xyz", 3)
        yield Group("joint", joint.name, "rotation", 3)
    yield Group("base", system.base, "gravity", 3)
    for link in system.links:
        yield Group("link", link.name, "inertia", 6)


def bodies(system: System) -> Iterator[Group]:
    """All ten numbers of a link's inertia as one group, for what mistakes of packing make of them together."""
    for link in system.links:
        if link.mass > 0.0:
            yield Group("link", link.name, BODY, 10)


def moved(system: System, group: Group, by: Array) -> System:
    """The system with a group of its numbers off by ``by``."""
    if group.owner == "base":
        return replace(system, gravity=constant(np.asarray(system.gravity) + by))
    if group.owner == "link":
        return system.replace_link(_moved_link(system.link(group.name), group.member, by))
    return system.replace_joint(_moved_joint(system.joint(group.name), group.member, by))


def _moved_link(link: Link, member: str, by: Array) -> Link:
    if member == "mass":
        return replace(link, mass=link.mass + float(by[0]))
    if member == "com":
        return replace(link, com=constant(np.asarray(link.com) + by))
    if member == BODY:
        return _moved_link(_moved_link(_moved_link(link, "mass", by[:1]), "com", by[1:4]), "inertia", by[4:])
    full = np.array([[by[0], by[3], by[4]], [by[3], by[1], by[5]], [by[4], by[5], by[2]]])
    return replace(link, inertia=constant(np.asarray(link.inertia) + full))


def _moved_joint(joint: Joint, member: str, by: Array) -> Joint:
    if member == "xyz":
        return replace(joint, xyz=constant(np.asarray(joint.xyz) + by))
    if member == "axis":
        axis = np.asarray(joint.axis) + by
        return replace(joint, axis=constant(axis / np.linalg.norm(axis)))
    if member == "rotation":
        from scipy.spatial.transform import Rotation

        return replace(joint, rotation=constant(np.asarray(joint.rotation) @ Rotation.from_rotvec(by).as_matrix()))
    changes: dict[str, Any] = {member: getattr(joint, member) + float(by[0])}
    return replace(joint, **changes)


def explain(build: Build, system: System, other: EngineModel, q: Array, qd: Array, qdd: Array) -> list[Explanation]:
    """The smallest groups that explain why ``other`` asks other forces than the trusted engine; several where they cannot be
    told apart, none where no single group does.

    build: of the trusted engine. q, qd, qdd: states in general position, each (B, n), in the order of ``other.names``.
    """

    def forces(model: EngineModel) -> Array:
        return np.array([model.inverse_dynamics(*state) for state in zip(q, qd, qdd, strict=True)])

    wanted, nominal = forces(other), forces(build(system))
    scale = np.maximum(np.abs(nominal).max(axis=0), 1e-300)
    whole = float(np.linalg.norm((wanted - nominal) / scale))
    if not np.isfinite(whole) or whole == 0.0:
        return []

    def residual(group: Group, by: Array) -> Array:
        return ((wanted - forces(build(moved(system, group, by)))) / scale).ravel()

    found: list[Explanation] = []
    for group in groups(system):
        larger = bool(found) and group.size > found[0].group.size
        if larger and not any(_turn_together(system, one.group, group) for one in found):
            continue
        explained = _fit(group, residual, whole)
        if explained is not None and not (larger and explained.directions > found[0].directions):
            found.append(explained)
    if not found:
        found = [
            Explanation(group, by, left, group.size)
            for group in groups(system)
            for by in _mistakes(system, group)
            if (left := _left(group, by, residual, whole)) <= LEFT
        ]
    if not found:
        found = [one for group in bodies(system) if (one := _fit(group, residual, whole)) is not None]
    best = min((one.left for one in found), default=0.0)
    return sorted((one for one in found if one.left <= 100.0 * max(best, 1e-9)), key=lambda one: one.left)


def _mistakes(system: System, group: Group) -> list[Array]:
    """By how much a group is off where it is turned round or forgotten, which is too far for a linear step to find."""
    if group.member not in ("axis", "xyz", "com", "rotation"):
        return []
    owner = system.joint(group.name) if group.owner == "joint" else system.link(group.name)
    value = np.asarray(getattr(owner, group.member))
    if group.member == "rotation":
        from scipy.spatial.transform import Rotation

        # From a rotation to its inverse, and to none.
        return [Rotation.from_matrix(turn).as_rotvec() for turn in (value.T @ value.T, value.T)]
    return [-2.0 * value] if group.member == "axis" else [-2.0 * value, -value]


def _left(group: Group, by: Array, residual: Callable[[Group, Array], Array], whole: float) -> float:
    """The share of the difference that a group leaves where it is off by so much; infinite where nothing can be so."""
    if not by.any():
        return np.inf
    try:
        left = float(np.linalg.norm(residual(group, by))) / whole
    except (InputError, np.linalg.LinAlgError, ValueError, RuntimeError):
        return np.inf
    return left if np.isfinite(left) else np.inf


def _turn_together(system: System, one: Group, other: Group) -> bool:
    """Whether two groups are of bodies that nothing turns against each other, or of the joints that carry these."""

    def turned(group: Group) -> str:
        carrier = system.joint(group.name) if group.owner == "joint" else system.carrier(group.name)
        while carrier.type in (JointType.PRISMATIC, JointType.FIXED) and carrier.parent != system.base:
            carrier = system.carrier(carrier.parent)
        return carrier.name

    return "base" not in (one.owner, other.owner) and turned(one) == turned(other)


def _fit(group: Group, residual: Callable[[Group, Array], Array], whole: float) -> Explanation | None:
    by = np.zeros(group.size)
    left, directions = 1.0, group.size
    step = 1e-6
    try:
        for _ in range(STEPS):
            here = residual(group, by)
            left = float(np.linalg.norm(here)) / whole
            if left < 1e-9:
                break
            slopes = np.column_stack([(here - residual(group, by + step * unit)) / step for unit in np.eye(group.size)])
            # Along an axis itself nothing changes; differences of a millionth leave a millionth of noise there.
            change, _, rank, _ = np.linalg.lstsq(slopes, here, rcond=1e-4)
            directions = int(rank)
            # Linear ones are done at once; where the first step explains nothing, the others will not either.
            after = float(np.linalg.norm(residual(group, by + change))) / whole
            if not after < max(0.7 * left, 1e-12):
                break
            by, left = by + change, after
    except (InputError, np.linalg.LinAlgError, ValueError, RuntimeError):
        return None
    return Explanation(group, by, left, directions) if left <= LEFT else None
