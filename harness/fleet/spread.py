"""How far numbers of several units are apart beyond their own intervals, and which lie apart from the others.

Random effects: a unit's number is that of the fleet plus what units differ by (standard deviation τ) plus what its own
recordings leave open (its own standard deviation). τ by Paule and Mandel (J. Res. Natl. Bur. Stand. 87 (1982) 377), its interval
by the Q-profile (Viechtbauer, Stat. Med. 26 (2007) 37); both look at Q(τ²) = Σ (x − x̄)² / (τ² + s²) alone, which is chi-squared.

Outliers would hide themselves in such a τ. They are judged by the median and by the τ at which half of the units lie within what
half of a normal distribution does, as for the median absolute deviation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import chi2, false_discovery_control, norm
from scipy.stats import t as student

Array = NDArray[np.float64]

FEWEST = 10  # units, from which on one of them is judged by the others
EFFICIENCY = 0.37  # of the median absolute deviation (Rousseeuw and Croux, J. Am. Stat. Assoc. 88 (1993) 1273)
HALF = float(norm.ppf(0.75))  # standard deviations that half of a normal distribution lies within
FALSE = 0.05  # expected share of those called outliers that are none


@dataclass(frozen=True)
class Spread:
    """Mean of a fleet with its standard deviation, and standard deviation between units with its 95 % interval.

    chance: of numbers as far apart if all units had the same one (Cochran's Q).
    """

    mean: float
    mean_std: float
    between: float
    low: float
    high: float
    chance: float


def spread(values: Array, stds: Array) -> Spread:
    """Random effects over units. values, stds: shape (k,), k of at least 2, one unit.

    Raises ValueError for fewer.
    """
    count = len(values)
    if count < 2:
        raise ValueError(f"{count} units tell nothing of how units differ")
    variances = _positive(values, stds) ** 2

    def q(square: float) -> float:
        weight = 1.0 / (square + variances)
        mean = float(weight @ values) / float(np.sum(weight))
        return float(weight @ (values - mean) ** 2)

    size = float(np.var(values)) + float(np.mean(variances))
    square = _where(q, count - 1.0, size)
    weight = 1.0 / (square + variances)
    low, high = (_where(q, float(chi2.ppf(p, count - 1)), size) for p in (0.975, 0.025))
    return Spread(
        float(weight @ values) / float(np.sum(weight)), float(np.sum(weight)) ** -0.5, square**0.5, low**0.5, high**0.5,
        float(chi2.sf(q(0.0), count - 1)),
    )  # fmt: skip


def away(values: Array, stds: Array) -> tuple[Array, float]:
    """Robust standard deviations that each unit is away from the median, and the robust one between units, shape (k,)."""
    variances = _positive(values, stds) ** 2
    left = values - float(np.median(values))

    def typical(square: float) -> float:
        return float(np.median(np.abs(left) / np.sqrt(square + variances)))

    square = _where(typical, HALF, float(np.median(left**2)) + float(np.median(variances)))
    return left / np.sqrt(square + variances), square**0.5


def chances(z: Array) -> Array:
    """Two-sided chance of each distance, by Student's distribution: the scale is an estimate from so many units."""
    return np.asarray(2.0 * student.sf(np.abs(z), EFFICIENCY * (len(z) - 1)))


def outlying(every: Sequence[Array]) -> list[Array]:
    """Chances of several numbers' units, adjusted for all of them together (Benjamini and Hochberg, J. R. Stat. Soc. B 57 (1995)
    289); below ``FALSE`` is an outlier."""
    if not every:
        return []
    adjusted = false_discovery_control(np.concatenate(list(every)))
    return list(np.split(adjusted, np.cumsum([len(part) for part in every])[:-1]))


def _positive(values: Array, stds: Array) -> Array:
    """Standard deviations no smaller than rounding."""
    return np.maximum(stds, 1e-12 * max(float(np.max(np.abs(values))), 1e-290))


def _where(falling: Callable[[float], float], level: float, size: float) -> float:
    """Where a falling function of τ² meets a level, 0 if it is below from the start. size: of τ², to begin with."""
    if falling(0.0) <= level:
        return 0.0
    high = size
    while falling(high) > level:
        high *= 4.0
    return float(brentq(lambda square: falling(square) - level, 0.0, high, xtol=1e-12 * size, rtol=1e-10))
