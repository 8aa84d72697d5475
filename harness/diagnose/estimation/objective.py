"""What a fit makes small: the whitened residuals of a hypothesis on windows of the recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import LOST
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.prediction.constants import REACH
from harness.diagnose.prediction.coordinates import internal_bounds
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]
States = Mapping[Window, Array]

Residuals = tuple[float, tuple[Array, ...]]
"""Sum of squared whitened residuals and, per window, the residuals (M,); a run that left the numbers costs ``LOST``."""


@dataclass(frozen=True, eq=False)
class Objective:
    """Whitened residuals as a function of the shared parameters (P,) and of every window's initial state (S,)."""

    predictor: Predictor
    likelihood: Likelihood
    hypothesis: Hypothesis
    windows: tuple[Window, ...]

    def on(self, windows: Sequence[Window]) -> Objective:
        """The same on other windows."""
        return replace(self, windows=tuple(windows))

    @property
    def nominal(self) -> int:
        """How many of the shared parameters are nominal quantities; they come first and have a unit normal prior."""
        return len(self.predictor.nominal)

    @property
    def size(self) -> int:
        """How many shared parameters there are."""
        return self.predictor.size(self.hypothesis)

    def prior(self, x: Array) -> float:
        """Cost of the nominal quantities' deviations from what is stated."""
        return float(np.sum(x[: self.nominal] ** 2))

    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the shared parameters; nominal quantities are held by their prior alone."""
        k = self.nominal
        lower, upper = [np.full(k, -np.inf)], [np.full(k, np.inf)]
        for member in self.hypothesis.members:
            low, high = internal_bounds(member, self.predictor.reach.get(member.key, REACH))
            lower.append(low)
            upper.append(high)
        return np.concatenate(lower), np.concatenate(upper)

    def residuals(self, points: Sequence[tuple[Array, States]]) -> list[Residuals]:
        """Residuals at several points (shared parameters, initial states), all lanes at once."""
        lanes = [(k, window, states[window]) for window in self.windows for k, (_, states) in enumerate(points)]
        predictions = self.predictor.predict(self.hypothesis, np.array([x for x, _ in points]), lanes)
        costs = [0.0] * len(points)
        residuals: list[list[Array]] = [[] for _ in points]
        for w, white in enumerate(self.likelihood.whiten_windows(self.windows, predictions)):
            chunk = predictions[w * len(points) : (w + 1) * len(points)]
            for k, r in enumerate(white):
                costs[k] += price(r, chunk[k])
                residuals[k].append(r)
        return [(cost, tuple(own)) for cost, own in zip(costs, residuals, strict=True)]

    def of_options(self, x: Array, options: Sequence[Sequence[States]]) -> tuple[Array, list[list[Array]]]:
        """Cost (W, K) and residuals of equally many initial states of every window under one set of shared parameters."""
        lanes = [
            (0, window, states[window]) for window, own in zip(self.windows, options, strict=True) for states in own
        ]
        predictions = self.predictor.predict(self.hypothesis, x[None], lanes)
        count = len(options[0])
        costs = np.zeros((len(self.windows), count))
        residuals = []
        for w, white in enumerate(self.likelihood.whiten_windows(self.windows, predictions)):
            residuals.append(list(white))
            for k, r in enumerate(white):
                costs[w, k] = price(r, predictions[w * count + k])
        return costs, residuals


def price(residual: Array, lane: Array) -> float:
    """Cost of a predicted lane's whitened residual; ``LOST`` for one that left the numbers or is too far off for its square."""
    if not np.all(np.isfinite(lane)):
        return LOST
    with np.errstate(over="ignore"):
        return min(float(residual @ residual), LOST)
