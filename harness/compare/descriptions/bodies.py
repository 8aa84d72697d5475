"""A mechanism in the pose in which every joint is at zero, in the coordinates of its base.

Where the axes pass, where masses lie and how they are spread in that one pose is all there is to a tree of rigid bodies
(product of exponentials; Brockett 1984): link frames are a matter of taste, and two files may choose them otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.system import Attachment, Beam, Joint, Link, System
from harness.system.description import Array, constant
from harness.system.inertia import combine


@dataclass(frozen=True, eq=False)
class Part:
    """A link's mass [kg], centre of mass [m] and inertia about it [kg·m²], in base coordinates."""

    name: str
    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class Body:
    """What a joint carries: its own link and all links welded to it.

    parent: index of the body it hangs on, -1 for the base. point [m], turn: origin and axes of the link frame in base
    coordinates; axis: of the joint, unit, zero if it is fixed. parts: those with mass. beam: its vectors in base coordinates.
    """

    name: str
    joint: Joint
    parent: int
    point: Array
    turn: Array
    axis: Array
    parts: tuple[Part, ...]
    beam: Beam | None

    @property
    def size(self) -> float:
        """How far the mass reaches from the joint [m]: to its centre, or by its radius of gyration."""
        mass, com, inertia = combine(*((p.mass, p.com, p.inertia) for p in self.parts))
        if mass <= 0.0:
            return 0.0
        gyration = float(np.sqrt(max(np.linalg.eigvalsh(inertia)[-1], 0.0) / mass))
        return max(float(np.linalg.norm(com - self.point)), gyration)


def bodies(system: System) -> tuple[Body, ...]:
    """The bodies of a system, in the order of their joints; what is welded to the base is left out, unless it bends."""
    frames: dict[str, tuple[int, Array, Array]] = {system.base: (-1, np.zeros(3), np.eye(3))}
    found: list[Body] = []
    for joint, link in zip(system.joints, system.links, strict=True):
        body, origin, axes = frames[joint.parent]
        point, turn = origin + axes @ joint.xyz, axes @ joint.rotation
        part = Part(link.name, link.mass, point + turn @ link.com, turn @ link.inertia @ turn.T)
        parts = (part,) if link.mass > 0.0 or np.any(link.inertia) else ()
        rides = body >= 0 and found[body].beam is not None
        if joint.movable or link.beam is not None or (rides and parts):
            axis = turn @ joint.axis if joint.movable else np.zeros(3)
            found.append(Body(link.name, joint, body, point, turn, axis, parts, _turned(link.beam, turn)))
            body = len(found) - 1
        elif body >= 0 and not rides:
            found[body] = replace(found[body], parts=(*found[body].parts, *parts))
        frames[link.name] = (body, point, turn)
    return tuple(found)


def _turned(beam: Beam | None, turn: Array) -> Beam | None:
    if beam is None:
        return None
    return replace(
        beam,
        direction=constant(turn @ beam.direction),
        bending=constant(turn @ beam.bending),
        payload_inertia=constant(turn @ beam.payload_inertia @ turn.T),
    )


def assembled(parts: Sequence[Body], like: System) -> System:
    """The system of these bodies, with link frames parallel to the base; name, gravity and effects of ``like``."""
    joints, links = [], []
    for body in parts:
        parent = parts[body.parent] if body.parent >= 0 else None
        origin = np.zeros(3) if parent is None else parent.point
        mass, com, inertia = combine(*((p.mass, p.com - body.point, p.inertia) for p in body.parts))
        joints.append(
            replace(
                body.joint,
                parent=like.base if parent is None else parent.name,
                child=body.name,
                xyz=constant(body.point - origin),
                rotation=constant(np.eye(3)),
                axis=constant(body.axis if body.joint.movable else [0.0, 0.0, 1.0]),
            )
        )
        links.append(Link(body.name, mass, constant(com), constant(inertia), body.beam))
    names = {name for body in parts for name in (body.name, body.joint.name)} | {"base"}
    kept: tuple[Attachment, ...] = tuple(a for a in like.attachments if a.site.partition(".")[0] in names)
    return System(like.name, tuple(joints), tuple(links), like.base, like.gravity, attachments=kept)
