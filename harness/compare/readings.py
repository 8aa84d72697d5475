"""Where two readings of one model file differ: which joint, which body, which field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.engines.readers import Placed

Array = NDArray[np.float64]

# Relative to the largest length, mass or inertia of the mechanism. Readers turn rotations into quaternions and inertia into
# principal axes, which costs rounding; a digit misread costs a million times more.
ALLOWED = 1e-9
_MOST = 3


def differences(ours: Sequence[Placed], theirs: Sequence[Placed]) -> tuple[str, ...]:
    """One phrase for each field that differs, joints first; what hangs on a joint placed otherwise is compared by mass alone."""
    length = max([1e-3, *(float(np.linalg.norm(x)) for body in ours for x in (body.origin, body.com))])
    heaviest = max([1e-12, *(body.mass for body in ours)])
    inertia = max([1e-15, *(float(np.abs(body.inertia).max()) for body in ours)])
    found: list[str] = []
    moved: set[int] = set()
    for k, (a, b) in enumerate(zip(ours, theirs, strict=True)):
        elsewhere = a.parent in moved
        placed: list[str] = []
        if not elsewhere:
            if a.kind != b.kind:
                placed.append(f"joint {a.joint!r}: {b.kind} for {a.kind} here")
            elif _apart(a.axis, b.axis) > ALLOWED:
                placed.append(f"joint {a.joint!r}: axis {_vector(b.axis)} for {_vector(a.axis)} here")
            # Of a hinge only the line counts that it turns about; of a slide only the direction.
            elif a.kind in ("revolute", "ball") and _apart(_line(a, a.origin), _line(a, b.origin)) > ALLOWED * length:
                placed.append(f"joint {a.joint!r}: origin {_vector(b.origin)} m for {_vector(a.origin)} m here")
        if elsewhere or placed:
            moved.add(k)
        found += placed
        if abs(a.mass - b.mass) > ALLOWED * heaviest:
            found.append(f"body {a.link!r}: mass {b.mass:.6g} kg for {a.mass:.6g} kg here")
        if k in moved:
            continue
        if _apart(a.com, b.com) > ALLOWED * length and max(a.mass, b.mass) > 0.0:
            found.append(f"body {a.link!r}: centre of mass {_vector(b.com)} m for {_vector(a.com)} m here")
        if _apart(a.inertia, b.inertia) > ALLOWED * inertia:
            at = np.unravel_index(int(np.argmax(np.abs(a.inertia - b.inertia))), (3, 3))
            name = "".join("xyz"[i] for i in at)
            found.append(f"body {a.link!r}: inertia {name} {b.inertia[at]:.6g} for {a.inertia[at]:.6g} kg·m² here")
    return tuple(found)


def field_differences(
    ours: Mapping[str, Mapping[str, float]], theirs: Mapping[str, Mapping[str, float]]
) -> tuple[float, tuple[str, ...]]:
    """Largest relative difference of the joints' numbers that both have, finite in both, and a phrase for each that differs."""
    worst, found = 0.0, []
    for joint, fields in theirs.items():
        for name, value in fields.items():
            own = ours[joint].get(name)
            if own is None or not (np.isfinite(own) and np.isfinite(value)) or own == value:
                continue
            apart = abs(own - value) / max(abs(own), abs(value))
            worst = max(worst, apart)
            if apart > ALLOWED:
                found.append(f"joint {joint!r}: {name} {value:.6g} for {own:.6g} here")
    return worst, tuple(found)


def phrase(found: Sequence[str]) -> str:
    """The first few, and how many more."""
    return "; ".join(found[:_MOST]) + (f"; and {len(found) - _MOST} more" if len(found) > _MOST else "")


def _apart(a: Array, b: Array) -> float:
    return float(np.abs(np.asarray(a) - np.asarray(b)).max())


def _line(placed: Placed, origin: Array) -> Array:
    """What counts of a point of a joint: the line through it along the axis, or of a ball the point itself."""
    return np.cross(placed.axis, origin) if placed.kind == "revolute" else origin


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in np.asarray(values) + 0.0) + ")"
