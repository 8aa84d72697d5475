"""Which set of effects explains recorded efforts: score tests, joint fits, judgement on data held out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.inverse.constants import (
    BEAM_WIDTH,
    FROM_NOTHING_SIGMAS,
    HELD_OUT_SIGMAS,
    MOST_CANDIDATES,
    MOST_EFFECTS,
    MOST_STARTS,
    RIVAL_EVALUATIONS,
    RIVAL_TRACE_RATIO,
    STRETCHED_CHANCE,
    TRACE_RATIO,
)
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit, fit_effort, spread
from harness.diagnose.inverse.heldout_gain import heldout_gain
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible
from harness.diagnose.selection.study import log_choose

Array = NDArray[np.float64]


@dataclass(eq=False)
class EffortStudy:
    """Fits of hypotheses to the training data, kept; and their judgement on data held out."""

    data: EffortData
    held: EffortData
    candidates: tuple[Candidate, ...]
    fits: dict[frozenset[str], EffortFit] = field(default_factory=dict)
    traces: dict[str, tuple[list[Array], Array]] = field(default_factory=dict)

    @property
    def nothing(self) -> EffortFit:
        """The fit of the nominal model, its quantities within their tolerance."""
        return self.fits[frozenset()]

    @property
    def nominal(self) -> int:
        return len(self.data.model.nominal)

    def criterion(self, fitted: EffortFit) -> float:
        """Extended Bayesian information criterion (Chen and Chen, Biometrika 95 (2008) 759, γ = 1)."""
        return fitted.cost + self.price(fitted.hypothesis)

    def price(self, hypothesis: Hypothesis) -> float:
        """What a set of effects has to bring to be as good as none."""
        rare = sum(m.effect.rarity for m in hypothesis.members)
        sets = log_choose(len(self.candidates), len(hypothesis.members))
        return hypothesis.size * float(np.log(self.data.samples)) + 2.0 * (sets + rare)

    def fit(self, hypothesis: Hypothesis, starts: Sequence[Array]) -> EffortFit:
        best = self.fits.get(hypothesis.identity)
        for start in starts:
            found = fit_effort(self.data, hypothesis, start)
            if best is None or found.cost < best.cost:
                best = found
        assert best is not None
        self.fits[hypothesis.identity] = best
        return best

    def best(self) -> EffortFit:
        """The best fit so far by the criterion."""
        return min(self.fits.values(), key=self.criterion)

    def held_rows(self, fitted: EffortFit) -> Array:
        """Whitened residuals of the data held out, nothing fitted to them, in units of the noise that the fit left."""
        rows = self.held.rows(fitted.hypothesis, fitted.x)
        raw = self.data.rows(fitted.hypothesis, fitted.x)
        return np.asarray(rows / self.data.size(raw))

    def heldout_z(self, smaller: EffortFit, larger: EffortFit) -> float:
        """How much better the larger hypothesis predicts data held out, in standard deviations."""
        rows = self.held.rows(smaller.hypothesis, smaller.x)
        other = self.held.rows(larger.hypothesis, larger.x)
        size = self.held.size(other)
        return heldout_gain(rows / size, other / size)

    def from_nothing(self, fitted: EffortFit, k: int) -> float:
        """Standard deviations that the first parameter of member ``k`` is away from where the effect is absent."""
        first = fitted.hypothesis.members[k].effect.parameters[0]
        at = self.nominal + fitted.hypothesis.span(k).start
        sigma = float(spread(fitted, self.nominal)[at])
        origin = first.neutral if np.isfinite(first.neutral) else 0.0
        return abs(float(fitted.x[at]) - origin) / sigma if sigma > 0.0 else float("inf")

    def weight(self, fitted: EffortFit) -> float:
        """Criterion of the training data, and the same of the data held out without a fit: smaller is better."""
        rows = self.held.rows(fitted.hypothesis, fitted.x)
        return self.criterion(fitted) + self.held.misfit(rows)

    def ranked(self, base: EffortFit) -> list[tuple[float, Candidate, Array]]:
        """Candidates by the share of the residual that their trace explains beside what is fitted, with a start each."""
        here = self.data.rows(base.hypothesis, base.x)
        size = self.data.size(here)
        # What the nominal quantities may still take is limited by their prior, so those columns carry it.
        prior = np.zeros((self.nominal, base.jacobian.shape[1]))
        prior[:, : self.nominal] = np.eye(self.nominal)
        basis, _ = np.linalg.qr(np.vstack([base.jacobian, prior]))
        rest = np.concatenate([here / size, base.x[: self.nominal]])
        rest = rest - basis @ (basis.T @ rest)
        seen = basis[: len(here)]
        out = []
        for candidate in self.candidates:
            if not compatible(base.hypothesis, candidate):
                continue
            starts, traces = self.traces_of(candidate)
            # Beside the basis, whose rows of the prior a trace has nothing in.
            inside = traces @ seen
            length = np.einsum("ij,ij->i", traces, traces) - np.einsum("ij,ij->i", inside, inside)
            along = traces @ rest[: len(here)] - inside @ (basis.T @ rest)
            there = length > 1e-12 * size**2
            gain = np.where(there, along**2 / np.where(there, length, 1.0), 0.0)
            k = int(np.argmax(np.where(np.isfinite(gain), gain, -1.0)))
            times = -float(along[k] / length[k]) * size if there[k] else 1.0
            out.append((float(gain[k]), candidate, _begun(candidate, starts[k], times)))
        return sorted(out, key=lambda item: -item[0])

    def traces_of(self, candidate: Candidate) -> tuple[list[Array], Array]:
        """Starts of a candidate and what each changes in the rows of the nominal model, (starts, rows).

        Beside other effects and other nominal quantities that is a little different, which matters little to an order.
        """
        if candidate.key not in self.traces:
            blank = np.zeros(self.nominal)
            hypothesis, starts = Hypothesis().with_(candidate), starts_of(candidate)
            if len(candidate.effect.parameters) == 1:
                # Of a single number, what one size of it changes all others do as well, but for how much.
                starts = starts[:1]
            here = self.data.rows(Hypothesis(), blank)
            rows = [self.data.rows(hypothesis, np.concatenate([blank, start])) - here for start in starts]
            self.traces[candidate.key] = starts, np.array(rows)
        return self.traces[candidate.key]

    def promising(self, base: EffortFit) -> list[tuple[float, Candidate, Array]]:
        """The candidates that come first beside a fit, without those that would not pay if their trace brought twice as much."""
        out = []
        for gain, candidate, start in self.ranked(base)[:MOST_CANDIDATES]:
            price = self.price(base.hypothesis.with_(candidate)) - self.price(base.hypothesis)
            if TRACE_RATIO * gain >= price:
                out.append((gain, candidate, start))
        return out

    def extend(self, base: EffortFit, candidate: Candidate, start: Array) -> EffortFit:
        hypothesis = base.hypothesis.with_(candidate)
        known = self.fits.get(hypothesis.identity)
        return known or self.fit(hypothesis, [np.concatenate([base.x, start])])

    def reduce(self, base: EffortFit, k: int) -> EffortFit:
        """The best fit known of anything within ``base`` less member ``k``."""
        hypothesis = base.hypothesis.without(k)
        if hypothesis.identity not in self.fits:
            span = base.hypothesis.span(k)
            keep = np.ones(len(base.x), dtype=bool)
            keep[self.nominal + span.start : self.nominal + span.stop] = False
            self.fit(hypothesis, [base.x[keep], np.zeros(self.nominal) if not hypothesis.members else base.x[keep]])
        return min((f for key, f in self.fits.items() if key <= hypothesis.identity), key=lambda f: f.cost)

    def rivals(self, best: EffortFit, k: int) -> list[tuple[Candidate, EffortFit]]:
        """Candidates that could stand in the place of member ``k``, likeliest first, with their fits."""
        without = self.reduce(best, k)
        limit = self.weight(best) + UNPARTED_EVIDENCE
        # What a few steps bring not half as near as the member came will not come near it.
        brought = self.criterion(without) - self.criterion(best)
        hopeless = max(10.0 * UNPARTED_EVIDENCE, 0.5 * brought)
        out = []
        for gain, candidate, start in self.ranked(without)[: 2 * MOST_CANDIDATES]:
            # A trace that explains a share g of S takes N log(1 − g/S) off; where that is far off, so is the candidate.
            told = -self.data.samples * float(np.log1p(-min(gain / self.data.samples, 1.0 - 1e-9)))
            if candidate.key in best.hypothesis.keys or RIVAL_TRACE_RATIO * told + 10.0 * UNPARTED_EVIDENCE < brought:
                continue
            hypothesis = without.hypothesis.with_(candidate)
            if hypothesis.identity not in self.fits:
                glance = fit_effort(self.data, hypothesis, np.concatenate([without.x, start]), calls=RIVAL_EVALUATIONS)
                if self.criterion(glance) > self.criterion(best) + hopeless:
                    continue
                start = glance.x[self.nominal + without.hypothesis.size :]
            found = self.extend(without, candidate, start)
            if self.criterion(found) < self.criterion(best) + UNPARTED_EVIDENCE and self.weight(found) < limit:
                out.append((candidate, found))
        return sorted(out, key=lambda pair: self.weight(pair[1]))


def _begun(candidate: Candidate, start: Array, times: float) -> Array:
    """Where a fit begins: of a single number, as far from its absence as its trace asks for."""
    if len(start) > 1:
        return start
    (parameter,) = candidate.effect.parameters
    absent = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
    away = times * (start - absent)
    if candidate.effect.law is None:
        # A trace is of a small change: what would take a much larger one is begun at the largest of the usual starts.
        most = max(abs(float(one[0]) - absent) for one in starts_of(candidate))
        away = np.clip(away, -most, most)
    asked = absent + away
    inside = np.all((parameter.lower < asked) & (asked < parameter.upper))
    return asked if inside and np.any(asked != absent) else start


def starts_of(candidate: Candidate) -> list[Array]:
    """Starting values of a candidate's parameters [SI]."""
    each = [p.start_values(candidate.references) for p in candidate.effect.parameters]
    combinations = [np.array(c) for c in product(*each)]
    step = max(1, len(combinations) // MOST_STARTS)
    if candidate.effect.name == "cogging_torque":
        # Periods are whole numbers that no slope leads to.
        phases = (-np.pi / 2.0, 0.0)
        amplitude = each[0][0]
        return [np.array([amplitude, float(n), phase]) for n in range(2, 13) for phase in phases]
    return combinations[::step]


def search(
    study: EffortStudy,
    progress: Callable[[str], None],
    turned: Callable[[EffortFit], EffortStudy | None] = lambda _: None,
) -> EffortFit:
    """The best set of effects by the criterion, grown from nothing.

    turned: another study of the same candidates to go on in, once it holds a better fit of the best set so far.
    """
    best = study.fit(Hypothesis(), [np.zeros(study.nominal)])
    beam = [best]
    for depth in range(MOST_EFFECTS):
        other = turned(best)
        if other is not None:
            study = other
            beam = [study.fit(f.hypothesis, [f.x]) for f in beam]
            best = beam[0]
        grown: list[EffortFit] = []
        for base in beam:
            for _, candidate, start in study.promising(base):
                grown.append(study.extend(base, candidate, start))
        progress(f"efforts, {depth + 1} effects")
        if not grown:
            break
        beam = sorted({id(f): f for f in grown}.values(), key=study.criterion)[:BEAM_WIDTH]
        if study.criterion(beam[0]) >= study.criterion(best):
            break
        best = beam[0]
    return best


def _needed(smaller: EffortFit, larger: EffortFit) -> float:
    """Standard deviations by which data held out must improve.

    What the nominal model had to be stretched far beyond its tolerance to imitate cannot show there: the stretched model predicts
    them as well. The stretch is then the evidence.
    """
    stretched = chi2.sf(max(smaller.prior - larger.prior, 0.0), larger.hypothesis.size) < STRETCHED_CHANCE
    return -HELD_OUT_SIGMAS if stretched else HELD_OUT_SIGMAS


def settle(study: EffortStudy, fitted: EffortFit) -> EffortFit:
    """The set with every member dropped that does not plainly pay, or does not improve data held out, and rivals weighed."""
    while fitted.hypothesis.members:
        judged = []
        for k in range(len(fitted.hypothesis.members)):
            smaller = study.reduce(fitted, k)
            pays = study.criterion(smaller) - study.criterion(fitted) - UNPARTED_EVIDENCE
            carries = 100.0 * (study.heldout_z(smaller, fitted) - _needed(smaller, fitted))
            clear = 100.0 * (study.from_nothing(fitted, k) - FROM_NOTHING_SIGMAS)
            judged.append((min(pays, carries, clear), k, smaller))
        worst, _, smaller = min(judged, key=lambda item: item[0])
        if worst > 0.0:
            break
        fitted = smaller
    for _ in range(len(fitted.hypothesis.members)):
        options = [f for k in range(len(fitted.hypothesis.members)) for _, f in study.rivals(fitted, k)]
        better = min(options, key=study.weight, default=fitted)
        if study.weight(better) >= study.weight(fitted) - 1e-9:
            break
        fitted = better
    return fitted
