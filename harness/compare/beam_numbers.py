"""Which number of a mechanism that bends would explain a difference of its answers, and by how much it is off.

Every number is moved alone, and what that does to the native answer is held against the difference. Several that do the same (mass
and stiffness of a clamped beam, by its frequencies) cannot be told apart, and are all named. Beside the numbers of the description
stand what of a beam and its payload may be counted in the rigid hub as well, and how much of the foreshortening is counted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.system import Beam, Joint, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link
from harness.system.inertia import point_inertia

Array = NDArray[np.float64]
Answer = Callable[[System], Array]
Blend = Callable[[Array, Array, float], Array]

# How far a number is moved for its effect; a share of the difference that may be left unexplained; and how much more of it
# by numbers that count as one as good as the best.
_STEP, _LEFT, _ALIKE = 1e-3, 0.1, 0.02
# Effects below this share of the largest are rounding.
_NOTHING = 1e-9
# What no beam can be: numbers are moved without asking whether a body could have them.
_IMPOSSIBLE = (ValueError, ArithmeticError, np.linalg.LinAlgError)


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
        if self.without is not None and abs(factor) < 1e-6:
            return f"no {named}"
        return f"{named} {factor:.6g} times as large"


@dataclass(frozen=True)
class InHub(Number):
    """What of a beam or its payload the rigid hub may carry besides; a factor of one is none of it."""

    def unlikely(self, factor: float) -> float:
        return abs(abs(factor - 1.0) - 1.0)

    def said(self, factor: float) -> str:
        return f"{factor - 1.0:+.6g} times the {self.what} in the hub of {self.site}"


@dataclass(frozen=True)
class Explanation:
    """A number, by what factor the other engine takes it, and the share of the difference that this leaves."""

    number: Number
    factor: float
    left: float


def numbers(system: System) -> Iterator[Number]:
    """Numbers that are not zero: of beams, of rigid links, of joints, and gravity."""
    for link in system.links:
        if link.beam is not None:
            yield from _of_beam(system, link, link.beam)
        elif link.mass > 0.0:
            yield from _of_rigid(system, link)
    for joint in system.joints:
        yield from _of_joint(system, joint)
    if np.any(system.gravity):

        def pulled(s: float) -> System:
            return replace(system, gravity=constant(s * np.asarray(system.gravity)))

        yield Number("gravity", "", {"value": "gravity"}, pulled)


def _of_rigid(system: System, link: Link) -> Iterator[Number]:
    def heavier(s: float) -> System:
        return system.replace_link(replace(link, mass=s * link.mass, inertia=constant(s * np.asarray(link.inertia))))

    def wider(s: float) -> System:
        return system.replace_link(replace(link, inertia=constant(s * np.asarray(link.inertia))))

    site = f"link {link.name!r}"
    yield Number("mass and inertia", site, {"link": link.name, "value": "mass"}, heavier)
    yield Number("inertia", site, {"link": link.name, "value": "inertia"}, wider)


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


def linear(without: Array, whole: Array, factor: float) -> Array:
    """What an answer is with a part of something, by the answers without it and with all of it."""
    return np.asarray(without + factor * (whole - without))


def squares(without: Array, whole: Array, factor: float) -> Array:
    """The same of logarithms of frequencies, whose squares go with the stiffness (Southwell)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(0.5 * np.log(linear(np.exp(2.0 * without), np.exp(2.0 * whole), factor)))


def explain(system: System, answer: Answer, apart: Array, blend: Blend = linear) -> list[Explanation]:
    """The numbers that explain a difference ``apart`` from the native answer, the best first; none where none does.

    answer: of a system, a flat array such as logarithms of frequencies; apart: the other engine's less the native one's.
    blend: an answer with a part of what is there or not.
    """
    base, whole = answer(system), float(np.linalg.norm(apart))
    if not np.isfinite(apart).all() or whole == 0.0 or base.shape != apart.shape:
        return []

    def answers(number: Number) -> Callable[[float], Array]:
        if number.without is None:
            return lambda factor: answer(number.scaled(factor))
        without = answer(number.without)
        return lambda factor: blend(without, base, factor)

    effects: list[tuple[Number, Callable[[float], Array], Array]] = []
    for number in numbers(system):
        try:
            moved = answers(number)
            effects.append((number, moved, (moved(1.0 + _STEP) - base) / _STEP))
        except _IMPOSSIBLE:
            continue
    largest = max((float(np.linalg.norm(effect)) for _, _, effect in effects), default=0.0)
    found = []
    for number, moved, effect in effects:
        square = float(effect @ effect)
        if not np.isfinite(square) or np.sqrt(square) <= _NOTHING * largest:
            continue
        found.append(_refined(number, effect, moved, base, apart, whole))
    # Of what does the same, first what is there once or not at all.
    found.sort(key=lambda one: (round(one.left, 6), one.number.unlikely(one.factor)))
    return [one for one in found if one.left <= _LEFT and one.left <= 2.0 * found[0].left + _ALIKE]


def _refined(
    number: Number, effect: Array, answer: Callable[[float], Array], base: Array, apart: Array, whole: float
) -> Explanation:
    """The factor by secants: what a change of a per cent does is not in proportion to it any more."""
    change, best = 0.0, Explanation(number, 1.0, 1.0)
    slope, left = effect, apart
    for _ in range(3):
        change += float(slope @ left) / float(slope @ slope)
        if not number.least < change < 20.0:
            break
        try:
            moved = answer(1.0 + change) - base
        except _IMPOSSIBLE:
            break
        left = apart - moved
        share = float(np.linalg.norm(left)) / whole
        if np.isfinite(share) and share < best.left:
            best = Explanation(number, 1.0 + change, share)
        if change == 0.0:
            break
        slope = moved / change
        if not float(slope @ slope) > 0.0:
            break
    return best


def sentence(found: list[Explanation], other: str) -> str:
    """For a table: ``exudyn_ancf moves as with mass of link 'rod' 1.01 times as large``."""
    said = " or ".join(one.number.said(one.factor) for one in found[:4])
    return f"{other} answers as with {said}" if said else ""
