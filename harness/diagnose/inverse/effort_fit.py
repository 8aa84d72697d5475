"""Least squares of recorded efforts under coloured noise of unknown size.

Residuals are taken as often as the low-pass lets them be independent, whitened by an autoregression that is estimated from
what a generous regression leaves (so that a misfit is not taken for noise), and weighed by a Gaussian likelihood with the
size of each joint's noise marginalised: cost = Σ (N + ν) log((S + ν)/(N + ν)) over joints + the nominal quantities' prior. What a
set does not explain at one joint so says nothing of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.diagnose.inverse.constants import (
    MOST_EVALUATIONS,
    NOISE_ROUNDS,
    NOMINAL_DIFFERENCE,
    PARAMETER_DIFFERENCE,
    ROUNDED_INFORMATION,
    SETTLED_COST,
    SETTLED_SIZE,
    SIZE_SAMPLES,
    STALE_RATIO_ON_THE_WAY,
    STALE_SHARE,
    STALE_SIGMAS,
    STRETCHES_A_PARAMETER,
    UNSEEN_PART,
)
from harness.diagnose.inverse.effort_model import LAWS, EffortModel
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_noise import EffortNoise, Grid
from harness.diagnose.inverse.whitened import Whitened
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.effects.room import STATED
from harness.errors import InputError
from harness.system import Attachment

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EffortFit:
    """One hypothesis fitted. x: nominal deviations [σ], then effect parameters [SI].

    rows: whitened residuals in units of what each joint's leave; clusters: of which stretch each row is; jacobian: of the rows;
    prior: of the nominal quantities; cost: see the module.
    """

    hypothesis: Hypothesis
    x: Array
    rows: Array
    clusters: NDArray[np.intp]
    jacobian: Array
    prior: float
    cost: float


@dataclass(eq=False)
class EffortData:
    """Runs with their grids and the noise of each joint."""

    model: EffortModel
    grids: tuple[Grid, ...]
    noises: tuple[EffortNoise, ...]
    _slopes: dict[frozenset[str], tuple[Array, Array]] = field(default_factory=dict)

    def nominal_slopes(self, hypothesis: Hypothesis, x: Array, *, far: float = 1.0) -> Array:
        """Slopes of the whitened rows over the nominal quantities near x, (rows, nominal); far: how many times as far as usual.

        They are those of all hypotheses with the same effects other than laws of joints, which only add to the torque; as far as
        that is near enough, those of the nominal model alone.
        """
        model = self.model
        nominal = len(model.nominal)
        if far > 1.0:
            hypothesis, x = Hypothesis(), x[:nominal]
        bent = [
            (member, span)
            for member, span in zip(hypothesis.members, model.spans(hypothesis), strict=True)
            if member.effect.name not in LAWS
        ]
        key = frozenset(member.key for member, _ in bent)
        order = sorted(bent, key=lambda pair: pair[0].key)
        at = np.concatenate(
            [x[:nominal] / STALE_SIGMAS, *(x[span] / (STALE_SHARE * member.scales) for member, span in order)]
        )
        if key in self._slopes and np.all(np.abs(at - self._slopes[key][0]) <= far):
            return self._slopes[key][1]
        here = self.rows(hypothesis, x)
        slopes = np.empty((len(here), nominal))
        for k in range(nominal):
            there = x.copy()
            there[k] += NOMINAL_DIFFERENCE
            slopes[:, k] = (self.rows(hypothesis, there) - here) / NOMINAL_DIFFERENCE
        self._slopes[key] = at, slopes
        return slopes

    def slope(self, hypothesis: Hypothesis, x: Array, k: int, step: float, here: Array) -> Array:
        """Slope of the whitened rows over the effect parameter at ``k`` in x, by a step; here: the rows at x, (rows,)."""
        there = x.copy()
        there[k] += step
        spans = self.model.spans(hypothesis)
        which = next(m for m, span in enumerate(spans) if span.start <= k < span.stop)
        law, span = hypothesis.members[which], spans[which]
        if law.effect.name not in LAWS or (law.effect.name in STATED and min(x[span][0], there[span][0]) < 0.0):
            return (self.rows(hypothesis, there) - here) / step
        # A law adds to the torque, so that the other members need not be asked again.
        beside = [
            (m, Attachment(m.effect.name, m.site, m.effect.named(x[s])))
            for m, s in zip(hypothesis.members, spans, strict=True)
            if m.effect.name not in LAWS
        ]
        inputs = [one for m, one in beside if m.effect.input is not None]
        others = [one for m, one in beside if m.effect.input is None or m.effect.of_servo]
        own, moved = (Attachment(law.effect.name, law.site, law.effect.named(y[span])) for y in (x, there))
        return self.whitened.law_change(own, moved, inputs, others) / step

    @property
    def joints(self) -> list[int]:
        return [int(j) for j in np.flatnonzero(np.any([run.driven for run in self.model.runs], axis=0))]

    @cached_property
    def samples(self) -> float:
        """Independent samples, each counted for as much as it tells."""
        return float(np.sum(self.counts))

    @cached_property
    def counts(self) -> Array:
        """Independent samples of each joint, each counted for as much as it tells, (n,)."""
        return self.of_each(self.whitened.weights)

    def of_each(self, rows: Array) -> Array:
        """Sum of squares of each joint's rows, (n,)."""
        return np.asarray(np.bincount(self.whitened.which, rows**2, len(self.noises)), dtype=np.float64)

    def misfit(self, rows: Array) -> float:
        """Twice the negative logarithm of the likelihood of whitened rows, the size of each joint's marginalised."""
        return float((self.counts + SIZE_SAMPLES) @ np.log(self.size_of_each(rows) ** 2))

    def size_of_each(self, rows: Array) -> Array:
        """Standard deviation of each joint's whitened rows, (n,): one was expected, which counts as a few samples."""
        return np.sqrt((self.of_each(rows) + SIZE_SAMPLES) / (self.counts + SIZE_SAMPLES))

    def size(self, rows: Array) -> Array:
        """The same at every row, (rows,)."""
        return np.asarray(self.size_of_each(rows)[self.whitened.which])

    @cached_property
    def whitened(self) -> Whitened:
        """What the rows of hypotheses are put together of."""
        return Whitened(self.model, self.grids, self.noises)

    def recorded(self, runs: Sequence[EffortRun]) -> EffortData:
        """The same motions with other efforts recorded."""
        other = EffortData(self.model.recorded(runs), self.grids, self.noises)
        other.whitened = self.whitened.recorded(other.model)
        return other

    def under(self, noises: tuple[EffortNoise, ...]) -> EffortData:
        """The same under another noise of each joint."""
        return EffortData(self.model, self.grids, noises)

    def rows(self, hypothesis: Hypothesis, x: Array) -> Array:
        """Whitened residuals of all stretches."""
        return self.whitened.rows(hypothesis, x)

    def plain(self, residuals: Sequence[Array], joint: int) -> Array:
        """Residuals of a joint at the samples compared, as they are [N·m]."""
        parts = [
            residual[stretch, joint]
            for run, grid, residual in zip(self.model.runs, self.grids, residuals, strict=True)
            if run.driven[joint]
            for stretch in grid.stretches
        ]
        return np.concatenate(parts) if parts else np.zeros(0)


def fit_effort(
    data: EffortData, hypothesis: Hypothesis, start: Array, *, frozen: Array | None = None, calls: int | None = None
) -> EffortFit:
    """Fit by bounded nonlinear least squares; frozen: parameters that stay, boolean, shape of x.

    calls: evaluations after which a fit is left as it is; None goes on to the end.
    """
    model = data.model
    nominal = len(model.nominal)
    lower, upper = _bounds(hypothesis, nominal)
    scale = np.concatenate([np.ones(nominal), *(m.scales for m in hypothesis.members)])
    free = np.ones(len(start), dtype=bool) if frozen is None else ~frozen.astype(bool)
    x = np.clip(start, lower, upper)
    # With what a bad start leaves, the nominal quantities' prior would hold them there.
    size = data.size(data.rows(hypothesis, x)) if calls else np.ones(data.whitened.count)
    # On the way to the least value slopes need not be as near as at it.
    far = STALE_RATIO_ON_THE_WAY

    def full(part: Array) -> Array:
        whole = x.copy()
        whole[free] = part
        return whole

    def misfit(part: Array) -> Array:
        whole = full(part)
        try:
            rows = data.rows(hypothesis, whole)
        except InputError:
            # A step that led to no mechanism at all, which says nothing of the user's: the next one is shorter.
            return np.full(len(size) + nominal, np.inf)
        return np.concatenate([rows / size, whole[:nominal]])

    def slopes(part: Array) -> Array:
        whole = full(part)
        here = data.rows(hypothesis, whole)
        out = np.zeros((len(here) + nominal, len(whole)))
        if free[:nominal].any():
            out[: len(here), :nominal] = data.nominal_slopes(hypothesis, whole, far=far) / size[:, None]
        out[len(here) :, :nominal] = np.eye(nominal)
        for k in np.flatnonzero(free[nominal:]) + nominal:
            step = (
                PARAMETER_DIFFERENCE
                * scale[k]
                * (1.0 if whole[k] + PARAMETER_DIFFERENCE * scale[k] <= upper[k] else -1.0)
            )
            out[: len(here), k] = data.slope(hypothesis, whole, int(k), step, here) / size
        return out[:, free]

    jacobian = np.zeros((len(size), len(start)))
    for _ in range(NOISE_ROUNDS + 1):
        if free.any():
            inside = np.clip(x[free], lower[free] + 1e-9 * scale[free], upper[free] - 1e-9 * scale[free])
            found = least_squares(
                misfit,
                inside,
                slopes,
                bounds=(lower[free], upper[free]),
                x_scale=scale[free],
                max_nfev=calls or MOST_EVALUATIONS,
                ftol=SETTLED_COST,
            )
            x = full(found.x)
            jacobian = np.zeros((len(found.fun), len(start)))
            jacobian[:, free] = found.jac
        rows = data.rows(hypothesis, x)
        before, size = size, data.size(rows)
        jacobian[: len(rows)] *= (before / size)[:, None]
        if calls or not free.any() or (far == 1.0 and np.all(np.abs(size - before) < SETTLED_SIZE * size)):
            break
        far = 1.0
    return _as_fit(data, hypothesis, x, rows, jacobian[: len(rows)])


def unfitted(data: EffortData, hypothesis: Hypothesis, x: Array) -> EffortFit:
    """A hypothesis with numbers that were not fitted, within their bounds; without slopes."""
    x = np.clip(x, *_bounds(hypothesis, len(data.model.nominal)))
    rows = data.rows(hypothesis, x)
    return _as_fit(data, hypothesis, x, rows, np.zeros((len(rows), len(x))))


def _bounds(hypothesis: Hypothesis, nominal: int) -> tuple[Array, Array]:
    """What physics allows of nominal deviations and effect parameters."""
    lower = np.concatenate([np.full(nominal, -np.inf), *(m.effect.lower for m in hypothesis.members)])
    return lower, np.concatenate([np.full(nominal, np.inf), *(m.effect.upper for m in hypothesis.members)])


def _as_fit(data: EffortData, hypothesis: Hypothesis, x: Array, rows: Array, jacobian: Array) -> EffortFit:
    """A hypothesis at x; rows: whitened residuals there, jacobian: of them in units of what each joint's leave."""
    nominal = x[: len(data.model.nominal)]
    prior = float(nominal @ nominal)
    cost = data.misfit(rows) + prior
    return EffortFit(hypothesis, x, rows / data.size(rows), data.whitened.clusters, jacobian, prior, cost)


def spread(fitted: EffortFit, nominal: int) -> Array:
    """Standard deviations of all parameters, shape of x; infinite where undetermined.

    From the curvature, and from the scatter of the gradient between stretches (the cluster-robust estimate of Liang and
    Zeger, Biometrika 73 (1986) 13) where there are enough of them; the larger one.
    """
    count = len(fitted.x)
    information = fitted.jacobian.T @ fitted.jacobian + np.diag([1.0] * nominal + [0.0] * (count - nominal))
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    alike = information / np.outer(size, size)
    inverse = np.linalg.pinv(alike, rcond=ROUNDED_INFORMATION) / np.outer(size, size)
    plain = np.diag(inverse)
    clusters = np.unique(fitted.clusters)
    if len(clusters) >= STRETCHES_A_PARAMETER * max(count - nominal, 1):
        gradients = np.array(
            [fitted.jacobian[fitted.clusters == k].T @ fitted.rows[fitted.clusters == k] for k in clusters]
        )
        factor = len(clusters) / max(len(clusters) - (count - nominal), 1)
        robust = np.diag(inverse @ (factor * gradients.T @ gradients) @ inverse)
        plain = np.maximum(plain, robust)
    # A pseudo-inverse is blind to what it leaves out: a number that nothing turns on would pass for known exactly.
    values, vectors = np.linalg.eigh(alike)
    open_ = np.abs(vectors[:, values < ROUNDED_INFORMATION * max(float(values[-1]), 1e-300)]).max(axis=1, initial=0.0)
    unseen = (open_ > UNSEEN_PART) | (np.diag(information) <= 1e-300)
    return np.where(unseen, np.inf, np.sqrt(np.maximum(plain, 0.0)))
