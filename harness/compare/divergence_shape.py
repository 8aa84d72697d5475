"""In what way two motions part: by a constant, in proportion to time, in phase, or exponentially; and what the steps alone make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Share of the difference's square that a shape must explain to be named.
ENOUGH = 0.9
# A difference is the model's where it is this many times what halving the steps changes.
CLEAR = 5.0


def shape_of(time: Array, first: Array, second: Array) -> str:
    """``offset``, ``secular``, ``phase`` or ``exponential``, or nothing where none of them fits.

    time: [s], shape (T,). first, second: a coordinate in two motions, each (T,).
    """
    apart = second - first
    if len(time) < 8 or not np.isfinite(apart).all() or not np.abs(apart).any():
        return ""
    since = time - time[0]
    rate = np.gradient(first, time)
    courses = {
        "offset": np.ones_like(since)[:, None],
        # As far as a wrong force drives: in proportion to time, and to its square.
        "secular": np.column_stack([since, since**2]),
        # One runs ahead: a clock that is off by a constant, and by a rate.
        "phase": np.column_stack([rate, rate * since]),
    }
    explained = {name: _explained(course, apart) for name, course in courses.items()}
    size = np.abs(apart)
    late = size > 1e-3 * size.max()
    if late.sum() >= 8 and size[late][-1] > 100.0 * np.median(size[late][: max(1, late.sum() // 4)]):
        explained["exponential"] = _explained(
            np.column_stack([np.ones(int(late.sum())), since[late]]), np.log(size[late]), centred=True
        )
    best = max(explained, key=lambda name: explained[name])
    return best if explained[best] >= ENOUGH else ""


def _explained(course: Array, apart: Array, *, centred: bool = False) -> float:
    left = apart - course @ np.linalg.lstsq(course, apart, rcond=None)[0]
    whole = apart - apart.mean() if centred else apart
    square = float(whole @ whole)
    return 1.0 - float(left @ left) / square if square > 0.0 else 0.0


def by_steps(difference: float, floors: dict[str, float], how: str = "halving the step") -> str:
    """Whether a difference is the model's or the steps', by what halving its steps changes in each engine [rad or m].

    how: what was done instead, where an engine chooses its steps.
    """
    if not floors:
        return ""
    said = ", ".join(f"{name} by {floor:.1e}" for name, floor in floors.items())
    if difference > CLEAR * max(floors.values()):
        return f"{how} moves {said}: it is the model, not the integration"
    return f"{how} moves {said}: below that there is no verdict, the integration may be all of it"
