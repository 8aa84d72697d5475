"""Which number of a closed form would give what was found: the closed form is trusted, and its numbers are moved one at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from harness.cases.case import Array

#: How many times as large a number is, by its name; and frequencies of a closed form with its numbers so many times as large.
Times = Callable[[str], float]
Truth = Callable[[Times], Array]

# Share of the difference that one number may leave: closed forms are exact, and so is what explains them.
LEFT = 1e-3
_FACTORS = np.append(1e-9, np.logspace(-4.0, 4.0, 161))


def once(_: str) -> float:
    """Every number as it is."""
    return 1.0


def by_truth(link: str, truth: Truth, names: tuple[str, ...], found: Array) -> tuple[str, dict[str, object]]:
    """The numbers of a link, each of which alone would give the frequencies found (k,); else it is the shapes it bends in."""
    whole = float(np.linalg.norm(np.log(found / truth(once))))
    explained = []
    for name in names:

        def left(exponent: float, name: str = name) -> float:
            factor = float(np.exp(exponent))
            try:
                true = truth(lambda one: factor if one == name else 1.0)
            except (ValueError, ArithmeticError):
                return np.inf  # so far from what it is, the closed form has no answer
            return float(np.linalg.norm(np.log(found / true))) / whole

        logs = np.log(_FACTORS)
        best = int(np.argmin([left(x) for x in logs]))
        around = logs[max(best - 1, 0)], logs[min(best + 1, len(logs) - 1)]
        refined = minimize_scalar(left, bounds=around, method="bounded", options={"xatol": 1e-12})
        if min(refined.fun, left(logs[best])) <= LEFT:
            factor = float(np.exp(refined.x))
            explained.append((name, 0.0 if factor < 1e-4 else factor))
    if not explained:
        said = "no one number of the closed form explains it: shapes, or how the beam is mounted"
        return said, {"link": link, "term": "shapes"}
    words = " or ".join(f"{name.replace('_', ' ')} {factor:.6g} times as large" for name, factor in explained)
    others = ", ".join(name for name, _ in explained[1:])
    place: dict[str, object] = {"link": link, "value": explained[0][0]}
    return f"as with {words}", place | ({"or": others} if others else {})
