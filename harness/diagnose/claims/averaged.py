"""Intervals beside a force over the state: what every set that the recordings speak for says of an effect's numbers, averaged.

A set's numbers are where it and the force that it leaves out are likeliest together, as uncertain as the curvature there says with
that force free; sets count by their evidence (Bayesian model averaging; Hoeting et al., Stat. Sci. 14 (1999) 382). Intervals reach
over that of the set that is told, too, whose numbers are those of the training recordings alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

from harness.diagnose.claims.constants import NEGLIGIBLE_POSTERIOR, QUANTILE_SIGMAS
from harness.diagnose.claims.posterior import weighed
from harness.diagnose.estimation.constants import NORMAL_95
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import from_internal
from harness.diagnose.problem.hypothesis import Candidate, whole_numbers
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.state_evidence import Evidence

Array = NDArray[np.float64]


def averaged(
    outcome: Outcome, evidence: Evidence, told: Fit, *, at_hand: bool = False
) -> dict[str, dict[str, Estimate]]:
    """Estimates of every member of ``told`` by its key and parameter; values are those of ``told``.

    at_hand: by the sets that have been looked at, so that no run is needed.
    """
    count, rows = len(outcome.predictor.nominal), _rows(outcome, evidence, told, at_hand=at_hand)
    by_training = np.zeros(len(told.x))
    if not at_hand or evidence.has(told):
        by_training = evidence.beside(outcome.training, told).spread
    by_training = np.where(np.isfinite(by_training), by_training, 0.0)
    out = {}
    for k, member in enumerate(told.hypothesis.members):
        span = told.hypothesis.span(k)
        place = slice(count + span.start, count + span.stop)
        out[member.key] = _estimates(member, told.x[place], by_training[place], rows[member.key])
    return out


def of_other_sets(outcome: Outcome, evidence: Evidence, told: Fit, k: int) -> tuple[float, float] | None:
    """Where the first number of member ``k`` of ``told`` lies by the sets that have been looked at beside the force, averaged; None
    where none of them has that member, or it has no number.
    """
    member = told.hypothesis.members[k]
    rows = _rows(outcome, evidence, told, at_hand=True)[member.key]
    if not rows or not member.effect.parameters:
        return None
    weights, means, spreads = (np.array(column) for column in zip(*((w, x[0], s[0]) for w, x, s in rows), strict=True))
    own = np.array(told.x[len(outcome.predictor.nominal) :][told.hypothesis.span(k)])
    ends = []
    for level in (norm.cdf(-NORMAL_95), norm.cdf(NORMAL_95)):
        own[0] = quantile(weights, means, spreads, float(level))
        ends.append(float(from_internal(member, own)[0]))
    return min(ends), max(ends)


def _rows(
    outcome: Outcome, evidence: Evidence, told: Fit, *, at_hand: bool
) -> dict[str, list[tuple[float, Array, Array]]]:
    """Of every member of ``told`` its numbers and their spread in the sets that hold it, with the set's share of the posterior."""
    count = len(outcome.predictor.nominal)
    rows: dict[str, list[tuple[float, Array, Array]]] = {member.key: [] for member in told.hypothesis.members}
    for share, fitted in weighed(outcome, at_hand=at_hand):
        if share < NEGLIGIBLE_POSTERIOR:
            continue
        found = evidence.beside(outcome.study, fitted)
        if not np.isfinite(found.spread).all():
            continue
        for k, member in enumerate(fitted.hypothesis.members):
            if member.key in rows:
                span = fitted.hypothesis.span(k)
                place = slice(count + span.start, count + span.stop)
                rows[member.key].append((share, found.x[place], found.spread[place]))
    return rows


def _estimates(
    member: Candidate, own: Array, spread: Array, rows: Sequence[tuple[float, Array, Array]]
) -> dict[str, Estimate]:
    values, whole = from_internal(member, own), whole_numbers(member)
    out = {}
    for j, parameter in enumerate(member.effect.parameters):
        if whole[j]:
            # Neighbours of a whole number are other sets, with waves at other places.
            count = float(round(float(values[j])))
            out[parameter.name] = Estimate(count, 0.0, count, count)
            continue
        ends = [own[j] - NORMAL_95 * spread[j], own[j] + NORMAL_95 * spread[j]]
        if rows:
            weights, means, spreads = (
                np.array(column) for column in zip(*((w, x[j], s[j]) for w, x, s in rows), strict=True)
            )
            ends += [quantile(weights, means, spreads, level) for level in (norm.cdf(-NORMAL_95), norm.cdf(NORMAL_95))]
        there = [float(from_internal(member, np.where(np.arange(len(own)) == j, end, own))[j]) for end in ends]
        low, high = max(min(there), parameter.lower), min(max(there), parameter.upper)
        out[parameter.name] = Estimate(float(values[j]), (high - low) / (2.0 * NORMAL_95), low, high)
    return out


def quantile(weights: Array, means: Array, spreads: Array, level: float) -> float:
    """Of a mixture of normal distributions, each (K,)."""
    share = weights / weights.sum()
    spreads = np.maximum(spreads, 1e-12)

    def beyond(x: float) -> float:
        return float(share @ norm.cdf((x - means) / spreads)) - level

    return float(brentq(beyond, np.min(means - QUANTILE_SIGMAS * spreads), np.max(means + QUANTILE_SIGMAS * spreads)))
