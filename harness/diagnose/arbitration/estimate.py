"""What recordings themselves say of the numbers that models are compared by, and in which combinations they say it.

Numbers are those of free runs: least squares over windows that share them, initial states eliminated, short windows
first and then as long as the motion can be foretold. Their covariance is that of the likelihood of independent samples,
adjusted: its variance is what is left, so many samples count as one as hang together (Chandler and Bate, Biometrika 94
(2007) 167), and where there are three recordings or more, the spread from one to the next counts too. Free swings show
ratios alone, since every term of the equations of motion may be multiplied by the same factor: there one inertia is
held, and the other numbers are told beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.rows import INERTIA_SLOTS
from harness.diagnose.arbitration.base_parameters import ARMATURE
from harness.diagnose.arbitration.constants import BEGINNING_SHARE, FIT_STEPS, UNSEEN_SPREAD
from harness.diagnose.arbitration.freed import NOTHING, Freed, FreedObjective, lower_bounds
from harness.diagnose.arbitration.numbers import Number
from harness.diagnose.arbitration.runs import period, short_windows
from harness.diagnose.estimation.dispersion import dispersion
from harness.diagnose.estimation.effective_samples import hanging_together
from harness.diagnose.estimation.horizon import Horizon
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.misfit import squares
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Left:
    """What is left beside the sensors' noise, as a likelihood takes it (``likelihood.ModelError``)."""

    sensors: Likelihood
    together: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Estimate:
    """What recordings say of the numbers.

    freed: the model that was fitted. fitted: the fit. x: the numbers' changes [sizes], (K,); covariance of them, (K,
    K), those held without any. reference: the number that free swings are counted by, None where efforts tell its size.
    louder: variance that is left, by channel, in units of the sensors' noise.
    """

    freed: Freed
    fitted: Fit
    x: Array
    covariance: Array
    reference: int | None
    louder: tuple[float, ...]

    @property
    def numbers(self) -> Array:
        """Estimates [SI], (K,)."""
        return self.freed.told(self.x)

    @property
    def std(self) -> Array:
        """Standard deviations [SI], (K,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)) * self.freed.sizes)


def reference_of(every: Sequence[Number]) -> int:
    """The number that free swings are counted by: the largest inertia, of bodies that slide their mass."""
    inertias = [
        k
        for k, n in enumerate(every)
        if n.inertial is not None and (n.key[1] in ("mass", ARMATURE) or n.key[1] in INERTIA_SLOTS[4:7])
    ]
    return max(inertias, key=lambda k: every[k].size)


def off_the_bounds(freed: Freed) -> Array:
    """A model with some of each friction that it has none of: its parameters, (K,)."""
    none = np.array([n.positive and v == 0.0 for n, v in zip(freed.numbers, freed.start, strict=True)], dtype=bool)
    return np.where(none & ~freed.held, BEGINNING_SHARE, 0.0)


def estimated(
    freed: Freed,
    windows: Sequence[Window] | None = None,
    *,
    begin: Array | None = None,
    held: NDArray[np.bool_] | None = None,
) -> Estimate:
    """The numbers of a model fitted to the training recordings.

    windows: to fit to, by default as long as the motion can be foretold. begin: the parameters to begin with. held:
    which of them do not move.
    """
    problem = freed.problem
    train = range(len(problem.train))
    likelihood = Likelihood(problem, crude_colours(problem))
    fixed = freed.held if held is None else freed.held | held
    reference = None
    if not problem.driven:
        reference = reference_of(freed.numbers)
        fixed = fixed | (np.arange(len(freed.numbers)) == reference)
    x = np.zeros(len(freed.numbers)) if begin is None else begin
    horizon = Horizon(problem, freed, 2.0 * np.pi / period(problem))
    short = horizon.calm(short_windows(problem, train))
    states = {w: measured_state(problem, freed, w) for w in short}

    def over(spans: Sequence[Window]) -> FreedObjective:
        return FreedObjective(freed, likelihood, NOTHING, tuple(spans), lower_bounds(freed))

    found = fit(over(short), x, states, fixed=fixed, most_steps=FIT_STEPS, others=[states])
    longer = tuple(windows) if windows is not None else horizon.joined(found)
    if longer != short:
        read = {w: measured_state(problem, freed, w) for w in longer}
        begun = {**read, **found.beginning(longer).states}
        found = fit(over(longer), found.x, begun, fixed=fixed, most_steps=FIT_STEPS, others=[read])
    return _told(freed, replace(found, free=~fixed), likelihood, reference)


def _told(freed: Freed, found: Fit, likelihood: Likelihood, reference: int | None) -> Estimate:
    # What ended at its bound is not known to be there: the others' intervals allow for it, and it has one of its own.
    count = len(likelihood.colours)
    left, sizes = squares(likelihood, found.windows, found.linear.residuals)
    louder = np.maximum(left / sizes, 1.0)
    together = np.maximum(hanging_together([r.reshape(count, -1) for r in found.linear.residuals]), 1.0)
    adjusted = replace(
        likelihood,
        colours=tuple(c.louder(float(v)) for c, v in zip(likelihood.colours, louder, strict=True)),
        discrepancy=Left(likelihood, tuple(together.tolist())),
    )
    # The same point under the adjusted likelihood, for its curvature.
    objective = FreedObjective(freed, adjusted, NOTHING, found.windows, lower_bounds(freed))
    weighed = fit(objective, found.x, found.states, fixed=~found.free, most_steps=1, enough=np.inf)
    weighed = replace(weighed, x=found.x, free=found.free)
    spread = dispersion(weighed, 0, [w.run for w in found.windows])
    factors = np.ones(len(found.x)) if spread is None else spread.factors
    free = np.flatnonzero(found.free)
    jacobian = weighed.linear.matrix[:, free] / factors[free]
    strength, axes = np.linalg.eigh(jacobian.T @ jacobian)
    variance = 1.0 / np.maximum(strength, UNSEEN_SPREAD**-2)
    covariance = np.zeros((len(found.x), len(found.x)))
    covariance[np.ix_(free, free)] = (axes * variance) @ axes.T
    return Estimate(freed, found, found.x, covariance, reference, tuple(louder.tolist()))
