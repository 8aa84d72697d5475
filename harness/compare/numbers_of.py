"""The numbers of a mechanism that bends, each with the system that has it otherwise: of one link or joint, or of all alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.system import Beam, Joint, Link, System
from harness.system.description import Array, constant
from harness.system.flexible_link import flexible_link
from harness.system.inertia import point_inertia

#: Numbers that may be zero.
VANISHES = (
    "armature", "damping", "stiffness", "payload", "payload_inertia", "material_damping", "modal_damping", "gravity",
    "geometric_stiffening",
)  # fmt: skip


@dataclass(frozen=True)
class Number:
    """A number of the description: what it is, of which link or joint, and the system with that number times a factor.

    without: the system without what is there or not, and has no size in the description; answers between the two are blended.
    least: of the change of the factor.
    """

    what: str
    site: str
    place: dict[str, object]
    scaled: Callable[[float], System]
    without: System | None = None
    least: float = -0.95

    def unlikely(self, factor: float) -> float:
        """How far a factor is from what a mistake would make, where any is as likely as another: 0."""
        return 0.0

    def said(self, factor: float) -> str:
        named = f"{self.what}{' of ' + self.site if self.site else ''}"
        if abs(factor) < 1e-6:
            return f"no {named}"
        return f"{named} {factor:.6g} times as large"


@dataclass(frozen=True)
class InHub(Number):
    """What of a beam or its payload the rigid hub may carry besides; a factor of one is none of it."""

    def unlikely(self, factor: float) -> float:
        return abs(abs(factor - 1.0) - 1.0)

    def said(self, factor: float) -> str:
        return f"{factor - 1.0:+.6g} times the {self.what} in the hub of {self.site}"


def numbers(system: System) -> Iterator[Number]:
    """Numbers that are not zero: of beams, of rigid links, of joints, and gravity."""
    for link in system.links:
        if link.beam is not None:
            yield from _of_beam(system, link, link.beam)
        elif link.mass > 0.0:
            yield from _of_rigid(system, link)
    for joint in system.joints:
        yield from _of_joint(system, joint)
    yield from _of_all(system)
    if np.any(system.gravity):

        def pulled(s: float) -> System:
            return replace(system, gravity=constant(s * np.asarray(system.gravity)))

        yield Number("gravity", "", {"value": "gravity"}, pulled)


def _of_rigid(system: System, link: Link) -> Iterator[Number]:
    def heavier(s: float) -> System:
        return system.replace_link(replace(link, mass=s * link.mass, inertia=constant(s * np.asarray(link.inertia))))

    site = f"link {link.name!r}"
    yield Number("mass and inertia", site, {"link": link.name, "value": "mass"}, heavier)
    yield _turning(system, [link], site, {"link": link.name, "value": "inertia"})


def _of_all(system: System) -> Iterator[Number]:
    """Of several joints, beams or rigid links alike: what goes wrong in the code is often wrong for all of a kind."""
    movable = [joint for joint in system.joints if joint.movable]
    for which, joints in (("every joint", movable), ("every inner joint", movable[1:])):
        for key in ("armature", "damping", "stiffness"):
            chosen = [joint for joint in joints if getattr(joint, key) != 0.0]
            if len(chosen) > 1:

                def changed(s: float, key: str = key, chosen: list[Joint] = chosen) -> System:
                    new = {joint.name: replace(joint, **{key: s * getattr(joint, key)}) for joint in chosen}
                    return replace(system, joints=tuple(new.get(joint.name, joint) for joint in system.joints))

                yield Number(key, which, {"value": key}, changed)
    beams = [(link, link.beam) for link in system.links if link.beam is not None]
    for key in ("bending_stiffness", "mass"):
        if len(beams) > 1:

            def scaled(s: float, key: str = key) -> System:
                whole = system
                for link, beam in beams:
                    changes: dict[str, Any] = {key: s * getattr(beam, key)}
                    whole = whole.replace_link(flexible_link(link.name, replace(beam, **changes)))
                return whole

            yield Number(key.replace("_", " "), "every beam", {"value": key}, scaled)
    rigid = [link for link in system.links if link.beam is None and link.mass > 0.0]
    if len(rigid) > 1:
        yield _turning(system, rigid, "every rigid link", {"value": "inertia"})


def _turning(system: System, links: Sequence[Link], site: str, place: dict[str, object]) -> Number:
    """The inertia of rigid links about their centres of mass; what is forgotten about the joint can be more than all of that."""

    def wider(s: float) -> System:
        whole = system
        for link in links:
            whole = whole.replace_link(replace(link, inertia=constant(s * np.asarray(link.inertia))))
        return whole

    return Number("inertia", site, place, wider, None, -5.0)


def _of_joint(system: System, joint: Joint) -> Iterator[Number]:
    def changed(**values: Any) -> System:
        return system.replace_joint(replace(joint, **values))

    scaled: dict[str, tuple[bool, Callable[[float], System]]] = {
        "armature": (joint.movable and joint.armature != 0.0, lambda s: changed(armature=s * joint.armature)),
        "damping": (joint.movable and joint.damping != 0.0, lambda s: changed(damping=s * joint.damping)),
        "stiffness": (joint.movable and joint.stiffness != 0.0, lambda s: changed(stiffness=s * joint.stiffness)),
        "xyz": (bool(np.any(joint.xyz)), lambda s: changed(xyz=constant(s * np.asarray(joint.xyz)))),
    }
    for key, (there, how) in scaled.items():
        if there:
            what = "place" if key == "xyz" else key
            yield Number(what, f"joint {joint.name!r}", {"joint": joint.name, "value": key}, how)


def _of_beam(system: System, link: Link, beam: Beam) -> Iterator[Number]:
    values = {
        "mass": beam.mass > 0.0,
        "bending_stiffness": True,
        "bending_stiffness2": beam.bending2,
        "torsional_stiffness": beam.torsion_modes > 0,
        "polar_inertia": beam.torsion_modes > 0,
        "payload": beam.payload > 0.0,
        "material_damping": beam.material_damping > 0.0,
        "modal_damping": any(beam.modal_damping),
        "payload_inertia": bool(np.any(beam.payload_inertia)),
    }
    for key in (key for key, there in values.items() if there):

        def scaled(s: float, key: str = key) -> System:
            value = getattr(beam, key)
            new = constant(s * np.asarray(value)) if key in ("payload_inertia", "modal_damping") else s * value
            change: dict[str, Any] = {key: tuple(new) if key == "modal_damping" else new}
            changed = replace(beam, **change)
            return system.replace_link(flexible_link(link.name, changed))

        yield Number(key.replace("_", " "), f"link {link.name!r}", {"link": link.name, "value": key}, scaled)
    if beam.geometric_stiffening:
        without = system.replace_link(flexible_link(link.name, replace(beam, geometric_stiffening=False)))
        place: dict[str, object] = {"link": link.name, "value": "geometric_stiffening"}
        # Missing altogether, or with the other sign.
        yield Number("geometric stiffening", f"link {link.name!r}", place, lambda _: system, without, -3.0)
    yield from _in_hub(system, link, beam)


def _in_hub(system: System, link: Link, beam: Beam) -> Iterator[Number]:
    """What bends and is carried by what bends, and is in the link's rigid inertia as well: by moments of order 0, 1 and 2."""
    direction, origin = np.asarray(beam.direction), np.zeros(3)
    across = np.eye(3) - np.outer(direction, direction)
    for what, value, mass, arm, turning in (
        ("payload", "payload", beam.payload, beam.length, np.asarray(beam.payload_inertia)),
        ("beam", "mass", beam.mass, beam.length / 2.0, beam.mass * beam.length**2 / 12.0 * across),
    ):
        if not mass > 0.0:
            continue
        moment = mass * arm * direction
        inertia = turning + mass * arm**2 * across
        none = np.zeros((3, 3))
        for order, change in (
            ("first moment", (0.0, moment, none)),
            ("inertia", (0.0, origin, inertia)),
            ("mass", (mass, origin, none)),
        ):

            def left(s: float, change: tuple[float, Array, Array] = change) -> System:
                mass, moment, inertia = change
                return system.replace_link(
                    with_moments(link, (s - 1.0) * mass, (s - 1.0) * moment, (s - 1.0) * inertia)
                )

            place: dict[str, object] = {"link": link.name, "value": value}
            yield InHub(f"{what}'s {order}", f"link {link.name!r}", place, left, None, -3.0)


def with_moments(link: Link, mass: float, moment: Array, inertia: Array) -> Link:
    """The link with more mass, first moment and inertia about its origin."""
    about = np.asarray(link.inertia) + point_inertia(link.mass, np.asarray(link.com)) + inertia
    total = link.mass + mass
    com = (link.mass * np.asarray(link.com) + moment) / total
    return replace(link, mass=total, com=constant(com), inertia=constant(about - point_inertia(total, com)))
