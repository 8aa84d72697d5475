"""Which number of a mechanism that bends would explain a difference of its frequencies or its motion, and by how much it is off.

Every number is moved alone, and what that does to the native answer is held against the difference. Several that do the same (mass
and stiffness of a clamped beam, by its frequencies) cannot be told apart, and are all named.
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

Array = NDArray[np.float64]
Answer = Callable[[System], Array]

# How far a number is moved for its effect; a share of the difference that may be left unexplained; and how much more of it
# by numbers that count as one as good as the best.
_STEP, _LEFT, _ALIKE = 1e-3, 0.1, 0.02
# Effects below this share of the largest are rounding.
_NOTHING = 1e-9


@dataclass(frozen=True)
class Number:
    """A number of the description: what it is, of which link or joint, and the system with that number times a factor."""

    what: str
    site: str
    place: dict[str, object]
    scaled: Callable[[float], System]


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


def explain(system: System, answer: Answer, apart: Array) -> list[Explanation]:
    """The numbers that explain a difference ``apart`` from the native answer, the best first; none where none does.

    answer: of a system, a flat array such as logarithms of frequencies; apart: the other engine's less the native one's.
    """
    base, whole = answer(system), float(np.linalg.norm(apart))
    if not np.isfinite(apart).all() or whole == 0.0 or base.shape != apart.shape:
        return []
    effects: list[tuple[Number, Array]] = []
    for number in numbers(system):
        try:
            effects.append((number, (answer(number.scaled(1.0 + _STEP)) - base) / _STEP))
        except (ValueError, np.linalg.LinAlgError):
            continue
    largest = max((float(np.linalg.norm(effect)) for _, effect in effects), default=0.0)
    found = []
    for number, effect in effects:
        square = float(effect @ effect)
        if not np.isfinite(square) or np.sqrt(square) <= _NOTHING * largest:
            continue
        found.append(_refined(number, effect, answer, base, apart, whole))
    found.sort(key=lambda one: one.left)
    return [one for one in found if one.left <= _LEFT and one.left <= 2.0 * found[0].left + _ALIKE]


def _refined(number: Number, effect: Array, answer: Answer, base: Array, apart: Array, whole: float) -> Explanation:
    """The factor by secants: what a change of a per cent does is not in proportion to it any more."""
    change, best = 0.0, Explanation(number, 1.0, 1.0)
    slope, left = effect, apart
    for _ in range(3):
        change += float(slope @ left) / float(slope @ slope)
        if not -0.95 < change < 20.0:
            break
        try:
            moved = answer(number.scaled(1.0 + change)) - base
        except (ValueError, np.linalg.LinAlgError):
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
    said = " or ".join(
        f"{one.number.what}{' of ' + one.number.site if one.number.site else ''} {one.factor:.6g} times as large"
        for one in found[:4]
    )
    return f"{other} answers as with {said}" if said else ""
