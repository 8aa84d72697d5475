"""How much residuals tell where the model, not the sensors, makes them: as loud as they are, and as few as they are independent.

A force that is left out moves the joints, and what it does to a free run lasts. Its exact covariance would weigh residuals best if
the force were what it is taken for, a stationary process. It is not: friction comes and goes with the motion, a hand still holds
for a while. Parameters by such weights answer to accelerations alone, and free runs of them drift. So parameters are those of
free runs (least squares of what is read), and the likelihood of independent samples is adjusted for how residuals hang together:
its variance is what is left, and so many samples count as one as their correlations say (Chandler and Bate, Biometrika 94 (2007)
167, on adjusting an independence likelihood; Bartlett, J. R. Statist. Soc. 98 (1935) 536, on the number).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.discrepancy import Discrepancy, Responses, covariance_at, orthonormal
from harness.diagnose.estimation.effective_samples import hanging_together
from harness.diagnose.estimation.least_squares import Fit, inverse
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.state_force import StateForce
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Misfit:
    """What a set of laws leaves, channel by channel.

    sensors: noise without it. louder: variance in units of the sensors'; together: samples that err together, (C,) each.
    force: the force at the joints that would do it, as a process in time. state: the same as a function of the state, by which sets
    are weighed; None where that is not known.
    """

    sensors: Likelihood
    louder: tuple[float, ...]
    together: tuple[float, ...]
    force: Discrepancy
    state: StateForce | None = None

    def fainter(self, share: float) -> Misfit:
        """The same of a share of its size, no quieter than the sensors."""
        return replace(self, louder=tuple(max(share**2 * one, 1.0) for one in self.louder))

    @property
    def likelihood(self) -> Likelihood:
        """The likelihood with it."""
        colours = tuple(c.louder(v) for c, v in zip(self.sensors.colours, self.louder, strict=True))
        return replace(self.sensors, colours=colours, discrepancy=self)


def squares(sensors: Likelihood, windows: Sequence[Window], residuals: Sequence[Array]) -> tuple[Array, Array]:
    """Sum of squared residuals that the sensors have whitened, and the number of readings, (C,) each."""
    count = len(sensors.colours)
    sizes = sum((np.sum(sensors.weights(w) ** 2, axis=1) for w in windows), np.zeros(count))
    left = sum((np.sum(r.reshape(count, -1) ** 2, axis=1) for r in residuals), np.zeros(count))
    return left, np.maximum(sizes, 1.0)


def misfit(sensors: Likelihood, windows: Sequence[Window], residuals: Sequence[Array], force: Discrepancy) -> Misfit:
    """What residuals (M,) of windows say, whitened by the sensors."""
    left, sizes = squares(sensors, windows, residuals)
    shares = hanging_together([r.reshape(len(sensors.colours), -1) for r in residuals])
    samples = sum((np.count_nonzero(sensors.weights(w), axis=1) for w in windows), np.zeros(len(sizes)))
    # Readings that repeat each other count as one already.
    together = np.maximum(shares * sizes / np.maximum(samples, 1.0), 1.0)
    return Misfit(sensors, tuple(np.maximum(left / sizes, 1.0)), tuple(together), force)


def sandwich(fitted: Fit, nominal: int, left: Misfit, found: Responses) -> Array:
    """By how much standard deviations of a fit's parameters (P,) are wider or narrower than its curvature, given the force.

    Residuals that hang together hurt what looks like them, and other parameters less: B A' S A B with S the covariance that the
    force makes (Huber, Proc. 5th Berkeley Symp. 1 (1967) 221; White, Econometrica 50 (1982) 1), as large in all as what is left.

    nominal: number of leading parameters with a unit normal prior. found: how channels, whitened by the sensors, answer to forces.
    """
    free = np.flatnonzero(fitted.free)
    prior = np.diag((free < nominal).astype(np.float64))
    whole = inverse(fitted.linear.matrix[:, free].T @ fitted.linear.matrix[:, free] + prior)
    quieter = 1.0 / np.sqrt(np.array(left.louder) * np.array(left.together))
    sizes = np.array(left.force.sizes) / found.torque
    middle, expected = np.zeros_like(prior), 0.0
    for window, states, shared in zip(fitted.windows, fitted.linear.bases, fitted.linear.shared, strict=True):
        rows = np.repeat(quieter, window.size)[:, None]
        basis = orthonormal(states)
        columns = shared[:, free] - basis @ (basis.T @ shared[:, free])
        forced = found.of(window)
        root = np.linalg.cholesky(covariance_at(forced.knots, sizes, left.force.memory))
        pushed = (rows * forced.q) @ (forced.r @ root)
        pushed -= basis @ (basis.T @ pushed)
        own = columns.T @ pushed
        middle += own @ own.T + left.force.louder * (rows * columns).T @ (rows * columns)
        expected += float(np.sum(pushed**2)) + left.force.louder * float(np.sum(rows**2))
    middle = middle * fitted.linear.cost / max(expected, 1e-300) + prior
    out = np.ones(len(fitted.x))
    ratio = np.diag(whole @ middle @ whole) / np.maximum(np.diag(whole), 1e-300)
    out[free] = np.sqrt(np.maximum(ratio, 0.0))
    return out
