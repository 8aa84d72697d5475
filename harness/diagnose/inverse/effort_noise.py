"""Noise of recorded efforts, at samples far enough apart for a low-pass to let them be independent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from harness.diagnose.inverse.constants import NOISE_LAGS, SAMPLE_PERIODS
from harness.diagnose.inverse.effort_motion import EffortRun

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Grid:
    """Samples of one run that residuals are compared at: stretches of consecutive indices."""

    stretches: tuple[NDArray[np.intp], ...]

    @property
    def samples(self) -> int:
        return sum(len(s) for s in self.stretches)


def grid_of(run: EffortRun) -> Grid:
    """Indices a little more than half a period of the cutoff apart (where the low-pass falls off, folding keeps white noise
    white), in stretches without an unusable sample between them."""
    step = float(run.time[1] - run.time[0])
    every = max(1, round(SAMPLE_PERIODS / (run.bandwidth * step)))
    stretches: list[NDArray[np.intp]] = []
    current: list[int] = []
    for start in range(0, len(run.time) - every, every):
        if run.usable[start : start + every].all():
            current.append(start)
            continue
        if len(current) > 2 * NOISE_LAGS:
            stretches.append(np.array(current))
        current = []
    if len(current) > 2 * NOISE_LAGS:
        stretches.append(np.array(current))
    return Grid(tuple(stretches))


@dataclass(frozen=True, eq=False)
class EffortNoise:
    """Autoregression of a joint's residual effort: ``ahead`` (NOISE_LAGS,), and the size of its innovation [N·m].

    dry: level of the dry friction whose direction is unsure while the joint turns about [N·m].
    """

    ahead: Array
    innovation: float
    std: float
    dry: float = 0.0


def effort_noise(pieces: Sequence[Array], dry: float = 0.0) -> EffortNoise:
    """Yule–Walker estimate over stretches of residual [N·m], its order by the Bayesian information criterion."""
    total = sum(len(p) for p in pieces)
    lags = np.array([sum(float(p[k:] @ p[: len(p) - k]) for p in pieces) / total for k in range(NOISE_LAGS + 1)])
    if lags[0] <= 0.0:
        return EffortNoise(np.zeros(NOISE_LAGS), 1e-12, 1e-12, dry)
    # As many lags as pay for themselves: the regression has taken its own share of the power out of the residual, and a longer
    # memory would take that for colour.
    lags[0] *= 1.0 + 1e-6
    best, chosen = total * float(np.log(lags[0])), np.zeros(0)
    for order in range(1, NOISE_LAGS + 1):
        ahead = solve_toeplitz(lags[:order], lags[1 : order + 1])
        left = max(float(lags[0] - ahead @ lags[1 : order + 1]), 1e-6 * float(lags[0]))
        cost = total * float(np.log(left)) + order * float(np.log(max(total, 2)))
        if cost < best:
            best, chosen = cost, ahead
    ahead = np.concatenate([chosen, np.zeros(NOISE_LAGS - len(chosen))])
    left = max(float(lags[0] - ahead @ lags[1:]), 1e-6 * float(lags[0]))
    return EffortNoise(ahead, float(np.sqrt(left)), float(np.sqrt(lags[0])), dry)
