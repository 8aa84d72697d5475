"""Joints of several degrees of freedom as chains of joints of one, by massless links between them.

A shift in space is three slides, a planar joint two slides and a turn, a universal joint two turns, a helical joint a turn and
a slide that follows it. Nothing is lost by that. A ball is the one exception: no three angles reach every rotation without a
singular one. It is lowered to three turns about the child's own axes x, y and z *at zero angles*, with the rotation that its
quaternion states put into where the first turn is placed (``recentred``). There the rates of the three angles are the angular
velocity in the child's axes; only their accelerations differ, by a product of rates (see ``harness.denoc.chart``).

The chart that moves along with the motion is that of Lie-group integrators (Iserles, Munthe-Kaas, Nørsett and Zanna, Lie-group
methods, Acta Numerica 9 (2000), section 2), with Cardan angles in place of canonical coordinates.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError, UnsupportedError
from harness.system.description import Array, Joint, JointType, Link, Mimic, System, constant
from harness.system.rotation import along_z, from_quaternion

Integers = NDArray[np.int64]

_UNIT = np.eye(3)
_FOLLOWING = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.HELICAL)


@dataclass(frozen=True, eq=False)
class Lowered:
    """A system lowered to joints of one degree of freedom; m coordinates, of the original's nq positions and nv velocities.

    system: the lowered one, every joint simple.
    rates: (m, nv), constant: rates of the lowered coordinates are ``rates`` times the velocities.
    take, factor, shift: (m,): lowered position k is factor · q[take] + shift; take is -1 for the angles of balls, which are zero.
    balls: (b, 2): where a ball's quaternion begins in q, and the first of its three lowered coordinates.
    independent: whether lowered rates are the velocities themselves, one to one.
    """

    system: System
    rates: Array
    take: Integers
    factor: Array
    shift: Array
    balls: Integers
    independent: bool

    def position(self, q: Array) -> Array:
        """Lowered positions, shape (m,), of positions of shape (nq,)."""
        return np.where(self.take >= 0, self.factor * q[self.take], 0.0) + self.shift

    def recentred(self, q: Array) -> System:
        """The lowered system with the rotations of its balls put into where their first turns are placed."""
        joints = {joint.name: joint for joint in self.system.joints}
        for quaternion, first in self.balls:
            joint = joints[self.system.coordinate_names[first]]
            turn = np.asarray(joint.rotation) @ from_quaternion(q[quaternion : quaternion + 4])
            joints[joint.name] = replace(joint, rotation=constant(turn))
        return replace(self.system, joints=tuple(joints.values()))


def one_degree(system: System, who: str) -> System:
    """The system with planar and universal joints as chains of simple ones, whose coordinates have the same names.

    Raises UnsupportedError, saying ``who`` cannot take it, for a joint that no chain of simple joints stands for, and for loops.
    """
    refuse_loops(system, who)
    if system.simple:
        return system
    for joint in system.joints:
        if joint.turns_in_space or joint.type is JointType.HELICAL or joint.mimic is not None:
            what = f"mimics {joint.mimic.joint!r}" if joint.mimic is not None else f"is of type {joint.type}"
            raise UnsupportedError(
                f"joint {joint.name!r} {what}, which {who} does not support yet",
                mend="use joints of one independent degree of freedom each",
                source=system.source,
            )
    return lower(system).system


def refuse_loops(system: System, who: str) -> None:
    """Raise UnsupportedError, saying ``who`` cannot take it, where a system has loops."""
    if system.loops:
        raise UnsupportedError(
            f"{system.loops[0].name!r} closes a loop, which {who} does not support yet",
            mend="take the loops out, or use harness.Denoc, denoc simulate and denoc validate",
            source=system.source,
        )


def freed(system: System) -> System:
    """The system with every joint that mimics another independent of it, which the notes then say."""
    following = [joint for joint in system.joints if joint.mimic is not None]
    if not following:
        return system
    told = tuple(
        f"joint {joint.name!r} mimics {joint.mimic.joint!r}; it counts as an independent joint here"
        for joint in following
        if joint.mimic is not None
    )
    joints = tuple(replace(joint, mimic=None) for joint in system.joints)
    return replace(system, joints=joints, notes=(*system.notes, *told))


def position_of_rate(system: System) -> Integers:
    """Where among the positions each velocity's own stands, shape (nv,); -1 for the spins of joints that turn in space."""
    positions = {name: k for k, name in enumerate(system.position_names)}
    found = dict(positions)
    for joint in system.joints:
        if joint.turns_in_space:
            found |= dict.fromkeys(joint.velocity_names[-3:], -1)
            shifts = zip(joint.position_names[:-4], joint.velocity_names[:-3], strict=True)
            found |= {velocity: positions[position] for position, velocity in shifts}
    return np.array([found[name] for name in system.coordinate_names], dtype=np.int64)


def neutral_position(system: System) -> Array:
    """Positions with every coordinate zero and every rotation the identity, shape (nq,)."""
    identities = {joint.position_names[-4] for joint in system.joints if joint.turns_in_space}
    return np.array([1.0 if name in identities else 0.0 for name in system.position_names])


def chained(system: System, keep: Container[JointType] = ()) -> System:
    """The system with its joints as chains of joints of one degree of freedom, those of the types ``keep`` as they are.

    A part of a joint goes by the name of its position; what follows another joint still does, the slide of a helical joint its
    turn. Raises InputError for a mimic that cannot be.
    """
    if system.simple:
        return system
    joints: list[Joint] = []
    links: list[Link] = []
    taken = {joint.name for joint in system.joints} | {link.name for link in system.links} | {system.base}
    for joint, link in zip(system.joints, system.links, strict=True):
        followed(system, joint)
        parts = [joint] if joint.type in keep else _parts(joint, taken)
        joints += parts
        links += [link if part is parts[-1] else Link(part.child) for part in parts]
    return replace(system, joints=tuple(joints), links=tuple(links))


def lower(system: System) -> Lowered:
    """Lower every joint of a system; a simple system comes back as it is.

    Raises InputError for a mimic without a leader, or in a circle.
    """
    chain = chained(system)
    positions = {name: k for k, name in enumerate(system.position_names)}
    velocities = {name: k for k, name in enumerate(system.coordinate_names)}
    # Slides of free joints and angles of balls have velocities of other names, and the angles no position.
    renamed: dict[str, str] = {}
    balls: dict[str, str] = {}
    for joint in system.joints:
        if joint.turns_in_space:
            renamed |= dict(zip(joint.position_names[:-4], joint.velocity_names[:-3], strict=True))
            balls[joint.velocity_names[-3]] = joint.position_names[-4]
    spins = {name for joint in system.joints if joint.turns_in_space for name in joint.velocity_names[-3:]}
    # Of each lowered coordinate: position taken (-1 none), factor, shift, and its velocity.
    coordinates: list[tuple[int, float, float, int]] = []
    found: list[tuple[int, int]] = []
    for joint, link in zip(chain.joints, chain.links, strict=True):
        if joint.name in balls:
            found.append((positions[balls[joint.name]], len(coordinates)))
        if joint.movable:
            leader, multiplier, offset = followed(chain, joint)
            position = -1 if leader in spins else positions[leader]
            coordinates.append((position, multiplier, offset, velocities[renamed.get(leader, leader)]))
        if link.beam is not None:
            modes = [f"{link.name}.mode{k + 1}" for k in range(link.beam.coordinates)]
            coordinates += [(positions[name], 1.0, 0.0, velocities[name]) for name in modes]
    rates = np.zeros((len(coordinates), len(velocities)))
    for k, (_, factor, _, velocity) in enumerate(coordinates):
        rates[k, velocity] = factor
    simple = tuple(replace(joint, mimic=None) for joint in chain.joints)
    return Lowered(
        system=system if system.simple else replace(chain, joints=simple, keyframes=()),
        rates=rates,
        take=np.array([c[0] for c in coordinates], dtype=np.int64),
        factor=np.array([c[1] for c in coordinates]),
        shift=np.array([c[2] for c in coordinates]),
        balls=np.array(found, dtype=np.int64).reshape(-1, 2),
        independent=np.array_equal(rates, np.eye(*rates.shape)) and rates.shape[0] == rates.shape[1],
    )


def followed(system: System, joint: Joint) -> tuple[str, float, float]:
    """The independent joint that a joint follows through one or several mimics, and multiplier and offset; itself if none."""
    multiplier, offset = 1.0, 0.0
    seen = [joint.name]
    if joint.mimic is not None and joint.type not in _FOLLOWING:
        raise InputError(
            f"joint {joint.name!r} of type {joint.type} mimics {joint.mimic.joint!r}",
            mend="a joint of one degree of freedom can follow another",
            source=system.source,
        )
    while joint.mimic is not None:
        mimic = joint.mimic
        offset += multiplier * mimic.offset
        multiplier *= mimic.multiplier
        try:
            joint = system.joint(mimic.joint)
        except KeyError:
            raise InputError(
                f"joint {joint.name!r} mimics {mimic.joint!r}, which is no joint of this model",
                mend="name a joint that moves",
                source=system.source,
            ) from None
        if joint.name in seen:
            raise InputError(
                f"joints {' → '.join([*seen, joint.name])} mimic one another in a circle",
                mend="one of them must be independent",
                source=system.source,
            )
        seen.append(joint.name)
        if joint.type not in _FOLLOWING:
            raise InputError(
                f"joint {seen[-2]!r} mimics {joint.name!r}, which has not one degree of freedom but is {joint.type}",
                mend="a joint of one degree of freedom can be followed",
                source=system.source,
            )
    return joint.name, multiplier, offset


def _parts(joint: Joint, taken: set[str]) -> list[Joint]:
    """The joints of one degree of freedom that a joint is lowered to, the joint itself if it has one."""
    slide, turn = JointType.PRISMATIC, JointType.REVOLUTE
    kinds: list[tuple[str, JointType, Array]]
    if joint.type is JointType.HELICAL:
        kinds = [("", turn, joint.axis), (".slide", slide, joint.axis)]
    elif joint.type is JointType.UNIVERSAL:
        kinds = [(".angle1", turn, joint.axis), (".angle2", turn, joint.axis2)]
    elif joint.type is JointType.PLANAR:
        plane = along_z(np.asarray(joint.axis))
        kinds = [(".x", slide, plane[:, 0]), (".y", slide, plane[:, 1]), (".angle", turn, joint.axis)]
    elif joint.turns_in_space:
        spins = [(f".w{'xyz'[k]}", turn, _UNIT[k]) for k in range(3)]
        shifts = [(f".{'xyz'[k]}", slide, _UNIT[k]) for k in range(3)] if joint.type is JointType.FREE else []
        kinds = [*shifts, *spins]
    else:
        return [joint]
    parts: list[Joint] = []
    parent = joint.parent
    for k, (ending, kind, axis) in enumerate(kinds):
        last = k == len(kinds) - 1
        child = joint.child if last else _unused(f"{joint.child}__{joint.name}{ending}", taken)
        follows = joint.type is JointType.HELICAL and k > 0
        part = Joint(joint.name + ending, kind, parent, child, axis=constant(axis))
        if not follows:
            # Spring, dry friction and limits of a helical joint are those of its turn; dampers and armature of each part.
            own = ("armature", "damping", "friction", "stiffness", "rest_position", "mimic")
            part = replace(part, **{name: getattr(joint, name) for name in own})
        else:
            part = replace(part, mimic=Mimic(joint.name, joint.pitch))
        parts.append(part if k else replace(part, xyz=joint.xyz, rotation=joint.rotation))
        parent = child
    return parts


def _unused(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name
