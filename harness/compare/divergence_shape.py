"""In what way two motions part: by a constant, in proportion to time, in phase, or exponentially."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Share of the difference's square that a shape must explain to be named.
ENOUGH = 0.9
# An exponential must be seen over this factor: below, a power of time runs as it does.
SEEN = 100.0
# For this share of the run at least: how any difference begins is no course.
LASTS = 0.3
# What it leaves beside what the nearest power of time does: a swinging difference grows in stairs, which both fit about alike.
CLEARLY = 0.7
# What a force that is off drives: a constant one the square of time, one that itself grows with the motion a power or two more.
POWERS = (0.5, 5.0)
# Steps in which a growing envelope is read, and how few of them make a course.
LEVELS, FEWEST = 40, 6


def shape_of(time: Array, first: Array, second: Array) -> str:
    """``offset``, ``secular``, ``phase`` or ``exponential``, or nothing where none of them fits.

    time: [s], shape (T,). first, second: a coordinate in two motions, each (T,).
    """
    apart = second - first
    if len(time) < 8 or not np.isfinite(apart).all() or not np.abs(apart).any():
        return ""
    # First, for what grows so is a multiple of its own rate too: beside an unstable rest a motion that is late parts as it moves.
    if growth(time, apart) is not None:
        return "exponential"
    since = time - time[0]
    rate = np.gradient(first, time)
    courses = {
        "offset": np.ones_like(since)[:, None],
        # As far as a wrong force drives: in proportion to time, and to its square.
        "secular": np.column_stack([since, since**2]),
    }
    if _turns(rate) >= 2:
        # One runs ahead: a clock that is off by a constant, and by a rate.
        courses["phase"] = np.column_stack([rate, rate * since])
    # An offset may begin behind the first sample.
    late = {"offset": 1}
    explained = {name: _explained(c[late.get(name, 0) :], apart[late.get(name, 0) :]) for name, c in courses.items()}
    best = max(explained, key=lambda name: explained[name])
    if explained[best] >= ENOUGH:
        return best
    return "secular" if _swells(since, apart) else ""


def course_of(time: Array, first: Array, second: Array, begins: int | None = None) -> dict[str, object]:
    """``shape`` of a difference, and ``growth`` [1/s] of an exponential one, where they can be told.

    begins: sample at which it first shows; what was one motion until then has no part in the shape.
    """
    since = slice(max((begins or 0) - 1, 0), None)
    time, first, second = time[since], first[since], second[since]
    shape = shape_of(time, first, second)
    if not shape:
        return {}
    rate = growth(time, second - first) if shape == "exponential" else None
    return {"shape": shape} | ({} if rate is None else {"growth": rate})


def left_line(
    time: Array, names: Sequence[str], first: Array, second: Array, allowed: float, begins: int | None = None
) -> dict[str, object] | None:
    """When two motions (T, n) leave what is allowed: ``time`` [s], ``coordinate``, and the course there; None where they do not."""
    apart = np.abs(second - first)
    left = ~(apart.max(axis=1) <= allowed)
    if not left.any():
        return None
    at = int(np.argmax(left))
    worst = int(np.argmax(np.nan_to_num(apart[at], nan=np.inf)))
    place = {"time": float(time[at]), "coordinate": names[worst]}
    return place | course_of(time, first[:, worst], second[:, worst], begins)


def growth(time: Array, apart: Array) -> float | None:
    """Rate [1/s] at which a difference (T,) grows exponentially, or None where it does not, by a factor of a hundred at least.

    Read from its envelope, for it may swing; up to any level, for once as large as the motion it grows no further; and against
    powers of time, from the start or from where it first shows, one of which also looks straight over a decade or two.
    """
    since, envelope = time - time[0], np.maximum.accumulate(np.abs(apart))
    best: tuple[float, float] | None = None
    for top in envelope[-1] * np.logspace(0.0, -6.0, 13):
        for factor in (SEEN, 1e3, 1e4, 1e6, 1e8):
            at = _passages(envelope, top / factor, top)
            if len(at) < FEWEST or (best is not None and factor <= best[0]):
                continue
            level = np.log(envelope[at])
            if level[-1] - level[0] < np.log(SEEN) or since[at[-1]] - since[at[0]] < LASTS * since[-1]:
                continue
            straight = np.column_stack([np.ones(len(at)), since[at]])
            if _explained(straight, level, centred=True) < ENOUGH:
                continue
            error, slope = _misfit(since[at], level)
            powers = [_power_misfit(since[at] - origin, level) for origin in (0.0, _shown(since, envelope, at[0]))]
            if slope > 0.0 and error < CLEARLY * min(powers):
                best = (factor, slope)
    return None if best is None else best[1]


def _passages(envelope: Array, low: float, high: float) -> NDArray[np.intp]:
    """Samples at which an envelope first reaches levels in equal ratios from ``low`` to ``high``, each sample once."""
    if not 0.0 < low < high:
        return np.zeros(0, dtype=np.intp)
    levels = np.geomspace(max(low, float(envelope[envelope > 0.0][0])), high, LEVELS)
    return np.unique(np.minimum(np.searchsorted(envelope, levels), len(envelope) - 1))


def _shown(since: Array, envelope: Array, first: int) -> float:
    """When a difference first showed above a hundredth of what it is at the sample ``first`` [s]."""
    return float(since[max(int(np.searchsorted(envelope, 1e-2 * envelope[first])) - 1, 0)])


def _misfit(x: Array, level: Array) -> tuple[float, float]:
    """Root mean square of what a straight line leaves, and its slope."""
    slope, start = np.polyfit(x, level, 1)
    return float(np.sqrt(np.mean((level - start - slope * x) ** 2))), float(slope)


def _power_misfit(since: Array, level: Array) -> float:
    """What the nearest power of time leaves, among those that forces make; infinite where the time has not begun."""
    if since[0] <= 0.0:
        since, level = since[since > 0.0], level[since > 0.0]
    if len(since) < FEWEST:
        return np.inf
    x = np.log(since)
    power = float(np.clip(_misfit(x, level)[1], *POWERS))
    left = level - power * x
    return float(np.std(left))


def _swells(since: Array, apart: Array) -> bool:
    """Whether a difference swings and its swings grow in proportion to time or its square, as from a damping that is off."""
    envelope = np.maximum.accumulate(np.abs(apart))
    at = _passages(envelope, 0.1 * envelope[-1], envelope[-1])
    at = at[since[at] > 0.0]
    if len(at) < FEWEST or envelope[at[0]] > 0.3 * envelope[-1]:
        return False
    x, level = np.log(since[at]), np.log(envelope[at])
    power = _misfit(x, level)[1]
    return 0.5 <= power <= 2.5 and _explained(np.column_stack([np.ones(len(x)), x]), level, centred=True) >= ENOUGH


def _turns(rate: Array) -> int:
    """How often a motion turns back."""
    signs = np.sign(rate[np.abs(rate) > 1e-6 * np.abs(rate).max()])
    return int(np.count_nonzero(np.diff(signs)))


def _explained(course: Array, apart: Array, *, centred: bool = False) -> float:
    left = apart - course @ np.linalg.lstsq(course, apart, rcond=None)[0]
    whole = apart - apart.mean() if centred else apart
    square = float(whole @ whole)
    return 1.0 - float(left @ left) / square if square > 0.0 else 0.0
