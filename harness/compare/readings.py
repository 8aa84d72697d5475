"""Where two readings of one model file differ: which joint, which body, which field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.engines.readers import Placed
from harness.system import System
from harness.system.read_urdf import NO_LIMIT

Array = NDArray[np.float64]

# Relative to the largest length, mass or inertia of the mechanism. Readers turn rotations into quaternions and inertia into
# principal axes, which costs rounding; a digit misread costs a million times more.
ALLOWED = 1e-9
_MOST = 3
FIELDS = ("damping", "friction", "armature", "stiffness", "rest_position", "lower", "upper")


@dataclass(frozen=True)
class Otherwise:
    """A field that is read otherwise: of which ``joint`` or ``link``, which member of it, and both values in words.

    part: of the member, where one alone differs: ``products of inertia``.
    """

    owner: str
    name: str
    member: str
    words: str
    part: str = ""

    @property
    def place(self) -> dict[str, object]:
        place: dict[str, object] = {self.owner: self.name, "value": self.member}
        return place | ({"part": self.part} if self.part else {})


def differences(ours: Sequence[Placed], theirs: Sequence[Placed]) -> tuple[Otherwise, ...]:
    """Each field that differs, a joint's before its body's; what hangs on a joint placed otherwise is compared by mass alone."""
    length = max([1e-3, *(float(np.linalg.norm(x)) for body in ours for x in (body.origin, body.com))])
    heaviest = max([1e-12, *(body.mass for body in ours)])
    inertia = max([1e-15, *(float(np.abs(body.inertia).max()) for body in ours)])
    found: list[Otherwise] = []
    moved: set[int] = set()
    for k, (a, b) in enumerate(zip(ours, theirs, strict=True)):
        elsewhere = a.parent in moved
        placed: list[Otherwise] = []
        if not elsewhere:
            if a.kind != b.kind:
                placed.append(_joint(a, "type", f"{b.kind} for {a.kind} here"))
            elif _apart(a.axis, b.axis) > ALLOWED:
                placed.append(_joint(a, "axis", f"axis {_vector(b.axis)} for {_vector(a.axis)} here"))
            # Of a hinge only the line counts that it turns about; of a slide only the direction.
            elif a.kind in ("revolute", "ball") and _apart(_line(a, a.origin), _line(a, b.origin)) > ALLOWED * length:
                placed.append(_joint(a, "xyz", f"origin {_vector(b.origin)} m for {_vector(a.origin)} m here"))
        if elsewhere or placed:
            moved.add(k)
        found += placed
        if abs(a.mass - b.mass) > ALLOWED * heaviest:
            found.append(_body(a, "mass", f"mass {b.mass:.6g} kg for {a.mass:.6g} kg here"))
        if k in moved:
            continue
        if _apart(a.com, b.com) > ALLOWED * length and max(a.mass, b.mass) > 0.0:
            found.append(_body(a, "com", f"centre of mass {_vector(b.com)} m for {_vector(a.com)} m here"))
        if _apart(a.inertia, b.inertia) > ALLOWED * inertia:
            at = np.unravel_index(int(np.argmax(np.triu(np.abs(a.inertia - b.inertia)))), (3, 3))
            entry = "".join("xyz"[i] for i in at)
            what = _inertia_part(a.inertia, b.inertia, ALLOWED * inertia)
            words = f"{what}, most in {entry}: {b.inertia[at]:.6g} for {a.inertia[at]:.6g} kg·m² here"
            found.append(_body(a, "inertia", words, what if what != "inertia" else ""))
    return tuple(found)


def _inertia_part(ours: Array, theirs: Array, allowed: float) -> str:
    """What of an inertia differs, by what no choice of axes changes: bodies here are in axes of the base, not of their file.

    Turned, it keeps its principal moments; with other products it keeps the sum of the moments alone (it is the trace).
    """
    moments = [np.asarray(np.linalg.eigvalsh(one), dtype=np.float64) for one in (ours, theirs)]
    if _apart(*moments) <= allowed:
        return "axes of inertia"
    if abs(float(np.trace(ours) - np.trace(theirs))) <= allowed:
        return "products of inertia"
    return "inertia"


def _joint(placed: Placed, member: str, words: str) -> Otherwise:
    return Otherwise("joint", placed.joint, member, f"joint {placed.joint!r}: {words}")


def _body(placed: Placed, member: str, words: str, part: str = "") -> Otherwise:
    return Otherwise("link", placed.link, member, f"body {placed.link!r}: {words}", part)


def fields_of(system: System) -> dict[str, dict[str, float]]:
    """Numbers of each movable joint by name that readers of other engines know too."""
    return {joint.name: {key: getattr(joint, key) for key in FIELDS} for joint in system.movable_joints}


def field_differences(
    ours: Mapping[str, Mapping[str, float]], theirs: Mapping[str, Mapping[str, float]]
) -> tuple[float, tuple[Otherwise, ...]]:
    """Largest relative difference of the joints' numbers that both have, and each that differs; one where a limit is no limit."""
    worst = 0.0
    found: list[Otherwise] = []
    for joint, fields in theirs.items():
        for name, value in _bounded(fields).items():
            own = ours[joint].get(name)
            if own is None or own == value or np.isnan(own) or np.isnan(value):
                continue
            both = np.isfinite(own) and np.isfinite(value)
            apart = abs(own - value) / max(abs(own), abs(value)) if both else 1.0
            worst = max(worst, apart)
            if apart > ALLOWED:
                words = f"joint {joint!r}: {name.replace('_', ' ')} {value:.6g} for {own:.6g} here"
                found.append(Otherwise("joint", joint, name, words))
    return worst, tuple(found)


def _bounded(fields: Mapping[str, float]) -> dict[str, float]:
    """The numbers with limits as our readers of files have them: huge ones, and a lower one above the upper, are none."""
    found = dict(fields)
    reversed_ = found.get("lower", -np.inf) > found.get("upper", np.inf)
    for name in ("lower", "upper"):
        if name in found and (reversed_ or abs(found[name]) >= NO_LIMIT):
            found[name] = -np.inf if name == "lower" else np.inf
    return found


def phrase(found: Sequence[Otherwise]) -> str:
    """The first few, and how many more."""
    said = [one.words for one in found]
    return "; ".join(said[:_MOST]) + (f"; and {len(found) - _MOST} more" if len(found) > _MOST else "")


def _apart(a: Array, b: Array) -> float:
    return float(np.abs(np.asarray(a) - np.asarray(b)).max())


def _line(placed: Placed, origin: Array) -> Array:
    """What counts of a point of a joint: the line through it along the axis, or of a ball the point itself."""
    return np.cross(placed.axis, origin) if placed.kind == "revolute" else origin


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in np.asarray(values) + 0.0) + ")"
