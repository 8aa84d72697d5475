"""What models say of numbers beside what recordings say: agreed on, decided for one of them, or left open.

By number, and by combination: the axes of the estimate's covariance, in units of the numbers' sizes, are combinations
that the recordings tell each by itself, from the best told to those they say nothing of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.arbitration.constants import ALIKE_SHARE, MOST_NAMED, NAMED_WEIGHT, OPEN_SHARE
from harness.diagnose.arbitration.estimate import Estimate
from harness.diagnose.arbitration.numbers import Number
from harness.diagnose.estimation.constants import NORMAL_95

Array = NDArray[np.float64]


def by_number(estimate: Estimate, models: Mapping[str, Array]) -> list[dict[str, Any]]:
    """One row a number: what each model says (K,) [SI], the recordings' estimate and its 95 % interval, and what
    follows.

    ``says``: of an interval, wider by a hundredth of the number's size, that holds what every model says, "agree" (it is
    narrow) or "open" (it is wide, and any of them may be right); else the name of the only model that it holds, or "neither":
    an interval that leaves a value out speaks against it, however wide it is. Where free swings are counted by one number, that
    row says "reference".
    """
    out = []
    for k, number in enumerate(estimate.freed.numbers):
        value, std = float(estimate.numbers[k]), float(estimate.std[k])
        low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
        if number.positive:
            low = max(low, 0.0)
        held = not estimate.fitted.free[k]
        slack = ALIKE_SHARE * number.size
        inside = [name for name, numbers in models.items() if low - slack <= numbers[k] <= high + slack]
        if k == estimate.reference:
            says = "reference"
        elif held:
            says = "not freed"
        elif len(inside) == len(models):
            says = "open" if NORMAL_95 * std > OPEN_SHARE * number.size else "agree"
        elif len(inside) == 1:
            says = inside[0]
        else:
            says = "neither"
        out.append(
            {
                "number": number.label,
                "joint": number.joint,
                "unit": number.unit,
                "size": number.size,
                "grouped": grouped(number),
                "models": {name: float(numbers[k]) for name, numbers in models.items()},
                "value": value,
                "std": None if held or k == estimate.reference else std,
                "ci95": None if held or k == estimate.reference else [low, high],
                "says": says,
            }
        )
    return out


def by_combination(estimate: Estimate, models: Mapping[str, Array]) -> list[dict[str, Any]]:
    """One row an axis of the covariance, the best told first.

    ``weights``: of changes in units of sizes, by number. ``std``: standard deviation along it. ``models``: where each
    model lies along it, in standard deviations from the estimate. ``says`` as in ``by_number``; models that both lie
    farther off than the interval but nearer to each other than half of it "agree, and the recordings differ".
    """
    free = np.flatnonzero(estimate.fitted.free)
    if not len(free):
        return []
    variance, axes = np.linalg.eigh(estimate.covariance[np.ix_(free, free)])
    out = []
    for along, spread in zip(axes.T, np.sqrt(np.maximum(variance, 0.0)), strict=True):
        if along[np.argmax(np.abs(along))] < 0.0:
            along = -along
        away = {
            name: float(along @ (estimate.freed.of(numbers) - estimate.x)[free] / spread)
            for name, numbers in models.items()
        }
        inside = [name for name, far in away.items() if abs(far) <= NORMAL_95 + ALIKE_SHARE / spread]
        apart = max(away.values()) - min(away.values())
        if len(inside) == len(models):
            says = "open" if NORMAL_95 * spread > OPEN_SHARE else "agree"
        elif len(inside) == 1:
            says = inside[0]
        elif len(models) > 1 and apart <= NORMAL_95:
            says = "agree, and the recordings differ"
        else:
            says = "neither"
        order = np.argsort(-np.abs(along))[:MOST_NAMED]
        out.append(
            {
                "weights": {
                    estimate.freed.numbers[free[j]].label: round(float(along[j]), 3)
                    for j in order
                    if abs(along[j]) >= NAMED_WEIGHT
                },
                "std": float(spread),
                "models": away,
                "says": says,
            }
        )
    return out


def counted_alike(
    models: Mapping[str, Array], every: Sequence[Number], reference: int | None, to: float
) -> dict[str, Array]:
    """Models' numbers with the one that free swings are counted by the same in all: [SI], (K,) each.

    A model in which it is nothing is left as it is. Angles at which something is slack and the like do not go with it.
    """
    if reference is None:
        return dict(models)
    goes = np.array([not n.shape for n in every])
    return {
        name: np.where(goes, numbers * to / numbers[reference], numbers) if numbers[reference] > 0.0 else numbers
        for name, numbers in models.items()
    }


def grouped(number: Number) -> str:
    """A base parameter's combination as a formula; nothing for what stands alone."""
    if number.inertial is None or not number.inertial.with_:
        return ""
    parts = [f"{site}.{name}" for site, name in (number.inertial.key,)]
    for factor, (site, name) in number.inertial.with_:
        sign = "−" if factor < 0.0 else "+"
        size = "" if abs(abs(factor) - 1.0) < 1e-9 else f"{abs(factor):.4g} · "
        parts.append(f"{sign} {size}{site}.{name}")
    return " ".join(parts)
