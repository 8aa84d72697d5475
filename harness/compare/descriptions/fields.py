"""One difference between two descriptions, and the fields of joints and beams that are plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from harness.compare.descriptions.bodies import Body
from harness.recording.units import written
from harness.system import Beam, Joint

Change = Callable[[list[Body]], list[Body]]


@dataclass(frozen=True, eq=False)
class Difference:
    """How far two descriptions lie apart in one field of one body or joint.

    size: relative to the larger of the two (lengths: to the link's), or an angle [rad]; unit ``1`` or ``rad``.
    stated: both values in words. change: makes the bodies of the first description agree with the second in this field, None
    where that cannot be or moves nothing. one_sided: only one of the files states it, and that counts for no difference.
    """

    field: str
    site: str
    size: float
    unit: str = "1"
    stated: str = ""
    change: Change | None = None
    one_sided: bool = False


def relative(a: float, b: float) -> float:
    """Difference relative to the larger size; 1 where only one is infinite."""
    if a == b:
        return 0.0
    if math.isinf(a) or math.isinf(b):
        return 1.0
    return abs(a - b) / max(abs(a), abs(b))


def against(a: float, b: float, unit: str) -> str:
    """``0.05 against 0.08 N·m·s/rad``, to as many digits as tell them apart."""
    if math.isinf(a) or math.isinf(b):
        return f"{_limit(a)} against {_limit(b)} {unit}".strip()
    digits = next((d for d in (4, 6, 9, 12) if f"{a:.{d}g}" != f"{b:.{d}g}"), 4)
    return f"{a:.{digits}g} against {b:.{digits}g} {unit}".strip()


def vector(values: Iterable[float], digits: int = 5) -> str:
    """``(0, 1, 0)``; what is rounding is 0."""
    return "(" + ", ".join(f"{0.0 if abs(v) < 1e-12 else v:.{digits}g}" for v in values) + ")"


def _limit(value: float) -> str:
    return "none" if math.isinf(value) else f"{value:.6g}"


def joint_numbers(k: int, a: Joint, b: Joint) -> Iterator[Difference]:
    """Armature, damping, friction, spring and limits of a joint."""
    force, position = written(a.force_unit), a.position_unit
    units = {
        "armature": "kg" if a.prismatic else "kg·m²",
        "damping": f"{force}·s/{position}",
        "friction": force,
        "stiffness": f"{force}/{position}",
    }
    for field, unit in units.items():
        x, y = getattr(a, field), getattr(b, field)
        yield Difference(field, a.name, relative(x, y), stated=against(x, y, unit), change=_joint_change(k, {field: y}))
    if a.stiffness and b.stiffness:
        x, y = a.rest_position, b.rest_position
        change = _joint_change(k, {"rest_position": y})
        yield Difference("spring's rest position", a.name, abs(x - y), position, against(x, y, position), change)
    for field, unit in (("lower", position), ("upper", position)):
        x, y = getattr(a, field), getattr(b, field)
        yield Difference("position limit", a.name, relative(x, y), stated=f"{field} {against(x, y, unit)}")
    for field, unit in (("effort", force), ("velocity", f"{position}/s")):
        x, y = getattr(a, field), getattr(b, field)
        if math.isinf(x) == math.isinf(y):
            yield Difference(f"{field} limit", a.name, relative(x, y), stated=against(x, y, unit))
        else:
            # MJCF has no word for a limit of velocity; these limits act on no motion.
            yield Difference(f"{field} limit", a.name, 0.0, stated=against(x, y, unit), one_sided=True)


def _joint_change(k: int, values: dict[str, Any]) -> Change:
    def change(bodies: list[Body]) -> list[Body]:
        bodies[k] = replace(bodies[k], joint=replace(bodies[k].joint, **values))
        return bodies

    return change


BEAM_UNITS = {
    "length": "m",
    "mass": "kg",
    "bending_stiffness": "N·m²",
    "bending_stiffness2": "N·m²",
    "torsional_stiffness": "N·m²",
    "material_damping": "s",
    "payload": "kg",
    "modes": "",
    "torsion_modes": "",
}


def beam_numbers(k: int, site: str, a: Beam, b: Beam) -> Iterator[Difference]:
    """Length, mass, stiffness, damping, payload and number of modes of a flexible link."""
    for field, unit in BEAM_UNITS.items():
        x, y = getattr(a, field), getattr(b, field)
        yield Difference(
            f"beam's {field.replace('_', ' ').replace('stiffness2', 'stiffness across')}",
            site,
            relative(x, y),
            stated=against(x, y, unit),
            change=_beam_change(k, {field: y}),
        )
    ratios = [(*beam.modal_damping, *[0.0] * (len(b.modal_damping) + len(a.modal_damping))) for beam in (a, b)]
    for mode, (x, y) in enumerate(zip(*ratios, strict=False), start=1):
        if x or y:
            change = _beam_change(k, {"modal_damping": b.modal_damping})
            yield Difference(
                "beam's modal damping", site, relative(x, y), "1", f"mode {mode}: {against(x, y, '')}", change
            )
    if a.geometric_stiffening != b.geometric_stiffening:
        words = [("with" if beam.geometric_stiffening else "without") for beam in (a, b)]
        change = _beam_change(k, {"geometric_stiffening": b.geometric_stiffening})
        yield Difference("beam's geometric stiffening", site, 1.0, "1", " against ".join(words), change)


def _beam_change(k: int, values: dict[str, Any]) -> Change:
    def change(bodies: list[Body]) -> list[Body]:
        beam = bodies[k].beam
        if beam is not None:
            bodies[k] = replace(bodies[k], beam=replace(beam, **values))
        return bodies

    return change
