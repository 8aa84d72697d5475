"""How far a fit's numbers differ from recording to recording, beyond what its likelihood expects, and what that says of intervals.

Where a model leaves something out, recordings of one rig disagree about its numbers by more than any noise inside one of them
says. Each recording's share of the gradient at the fit tells what it alone would change (one Newton step, no further run); the
spread of these is a sandwich estimate with recordings as clusters (Liang and Zeger, Biometrika 73 (1986) 13). Of few recordings
it is a poor estimate by itself, so every parameter's is held together with the pooled one of all (Smyth, Stat. Appl. Genet. Mol.
Biol. 3 (2004) 3), and intervals have the quantiles of Student's distribution.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, t

from harness.diagnose.estimation.constants import FEWEST_CLUSTERS, POOLED_RECORDINGS
from harness.diagnose.estimation.least_squares import Fit, inverse

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Dispersion:
    """What recordings say of a fit one by one.

    factors: on standard deviations and half-widths of intervals, (P,). without: the shared parameters with one cluster left out, by
    its name, (P,); each with its standard deviations (P,).
    """

    factors: Array
    without: Mapping[Hashable, tuple[Array, Array]]


def dispersion(
    fitted: Fit, nominal: int, clusters: Sequence[Hashable], expected: Array | None = None
) -> Dispersion | None:
    """The spread of a fit's shared parameters over clusters of its windows; None where none is free.

    Of fewer than ``FEWEST_CLUSTERS`` clusters no spread is seen. That they would differ by no more than expected is then as
    uncertain as the pooled spread is by itself, and intervals are Student's of that.

    nominal: number of leading parameters with a unit normal prior. clusters: of every window of the fit. expected: standard
    deviations (P,) in units of those that the curvature says, where these are known to be others (``misfit.sandwich``).
    """
    names = list(dict.fromkeys(clusters))
    free = np.flatnonzero(fitted.free)
    count = len(names)
    if not len(free):
        return None
    wider = np.ones(len(free)) if expected is None else expected[free]
    factors = np.ones(len(fitted.x))
    if count < FEWEST_CLUSTERS:
        factors[free] = _student(POOLED_RECORDINGS) * wider
        return Dispersion(factors, {})
    # As many rows of every window as its triangle has (``linearisation.eliminated``).
    edges = np.cumsum([min(len(r), len(fitted.x) + 1) for r in fitted.linear.residuals])[:-1]
    rows = np.split(fitted.linear.matrix[:, free], edges)
    right = np.split(fitted.linear.vector, edges)
    information = {name: np.zeros((len(free), len(free))) for name in names}
    slopes = {name: np.zeros(len(free)) for name in names}
    for cluster, a, b in zip(clusters, rows, right, strict=True):
        information[cluster] += a.T @ a
        slopes[cluster] += a.T @ b
    prior = np.diag((free < nominal).astype(np.float64))
    every = sum(information.values()) + prior
    whole = inverse(every)
    sigma = wider * np.sqrt(np.diag(whole))
    pull = prior @ fitted.x[free]
    # What the prior pulls is shared out, so that the clusters' slopes add up to nothing at the fit.
    moved = np.array([whole @ (slopes[name] + pull / count) for name in names])
    own = np.sum((moved - moved.mean(axis=0)) ** 2, axis=0) * count / (count - 1)
    seen = sigma > 0.0
    ratio = np.where(seen, own / np.where(seen, sigma, 1.0) ** 2, 1.0)
    pooled = max(float(np.mean(ratio[seen])) if seen.any() else 1.0, 1.0)
    moderated = np.maximum((POOLED_RECORDINGS * pooled + (count - 1) * ratio) / (POOLED_RECORDINGS + count - 1), 1.0)
    factors[free] = np.sqrt(moderated) * _student(POOLED_RECORDINGS + count - 1) * wider
    without = {}
    for name in names:
        rest = inverse(every - information[name])
        x, std = fitted.x.copy(), np.full(len(fitted.x), np.nan)
        x[free] += rest @ slopes[name]
        std[free] = wider * np.sqrt(np.diag(rest) * moderated)
        without[name] = x, std
    return Dispersion(factors, without)


def _student(freedom: float) -> float:
    """How much wider intervals of 95 % are where a spread is known by so many degrees of freedom."""
    return float(t.ppf(0.975, freedom) / norm.ppf(0.975))
