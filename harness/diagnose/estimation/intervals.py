"""Intervals of effect parameters: from the curvature of the likelihood, nominal tolerances and initial states profiled out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import NORMAL_95, WIDEST_INTERVAL
from harness.diagnose.estimation.least_squares import Fit, covariance
from harness.diagnose.prediction.coordinates import from_internal, is_logarithmic
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Candidate, whole_numbers

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """Value, standard deviation and 95 % interval in SI; std is None where the value lies at a bound of what is possible."""

    value: float
    std: float | None
    low: float
    high: float

    def document(self, unit: str) -> dict[str, Any]:
        """For programs."""
        return {"value": self.value, "std": self.std, "ci95": [self.low, self.high], "unit": unit}


def inflation(fitted: Fit) -> float:
    """Variance of the whitened residual, never below one: what the noise model leaves unexplained widens the intervals."""
    rows = np.concatenate(fitted.linear.residuals)
    used = rows[rows != 0.0]
    dof = max(len(used) - int(fitted.free.sum()) - sum(len(s) for s in fitted.states.values()), 1)
    return max(1.0, float(used @ used) / dof)


def estimates(predictor: Predictor, fitted: Fit, k: int) -> dict[str, Estimate]:
    """Estimates of member ``k``'s parameters, by name, as the curvature has them; a whole number is taken as known.

    A curvature knows only the valley that it was taken in: ``profile_likelihood`` looks beyond.
    """
    member = fitted.hypothesis.members[k]
    count = len(predictor.nominal)
    first = count + fitted.hypothesis.span(k).start
    within = np.zeros(len(fitted.x), dtype=bool)
    within[first : first + member.size] = True
    # What lies at an end of where it was searched is not known to be there: the other parameters' intervals allow for it.
    open_ = replace(fitted, free=fitted.free | (within & (np.linalg.norm(fitted.linear.matrix, axis=0) > 0.0)))
    sigma = np.sqrt(np.diag(covariance(open_, count, inflation(fitted))))
    sigma[~fitted.free] = np.nan
    u, whole = fitted.x[first : first + member.size], whole_numbers(member)
    out = {}
    for j, parameter in enumerate(member.effect.parameters):
        if whole[j]:
            value = float(round(float(from_internal(member, u)[j])))
            out[parameter.name] = Estimate(value, 0.0, value, value)
        elif np.isfinite(sigma[first + j]):
            out[parameter.name] = _inside(member, u, j, float(sigma[first + j]))
        else:
            out[parameter.name] = _at_bound(member, u, j, _bound_width(fitted, first + j, count))
    return out


def _inside(member: Candidate, u: Array, j: int, sigma: float) -> Estimate:
    """The estimate of a parameter that stands free, ``sigma`` its standard deviation in the fit's coordinates ``u``."""
    parameter, value = member.effect.parameters[j], float(from_internal(member, u)[j])
    if is_logarithmic(member)[j]:
        std = value * sigma
        reach = float(np.exp(NORMAL_95 * min(sigma, WIDEST_INTERVAL)))
        low, high = value / reach, value * reach
    else:
        std = sigma * float(member.scales[j])
        if parameter.name == "phase":
            # A whole turn more is the same phase; more than half a turn either way says nothing.
            value -= 2.0 * np.pi * round(value / (2.0 * np.pi))
            return Estimate(value, std, value - min(NORMAL_95 * std, np.pi), value + min(NORMAL_95 * std, np.pi))
        low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
        if member.effect.modifies and parameter.lower >= low and value > parameter.lower == 0.0:
            # Far from nothing, how another effect acts changes ever less with this number: it is known as a power of e is.
            reach = float(np.exp(NORMAL_95 * min(std / value, WIDEST_INTERVAL)))
            low, high = value / reach, value * reach
    return Estimate(value, std, max(low, parameter.lower), min(high, parameter.upper))


def _at_bound(member: Candidate, u: Array, j: int, width: float) -> Estimate:
    """The estimate of a parameter that lies at a bound: one-sided, ``width`` in the fit's coordinates."""
    parameter, own = member.effect.parameters[j], np.arange(member.size) == j
    ends = [float(from_internal(member, np.where(own, u + sense * NORMAL_95 * width, u))[j]) for sense in (1.0, -1.0)]
    low, high = max(min(ends), parameter.lower), min(max(ends), parameter.upper)
    return Estimate(float(from_internal(member, u)[j]), None, low, high)


def _bound_width(fitted: Fit, index: int, nominal: int) -> float:
    column = fitted.linear.matrix[:, index]
    information = float(column @ column) + (1.0 if index < nominal else 0.0)
    return min(float(1.0 / np.sqrt(information)), WIDEST_INTERVAL) if information > 0.0 else WIDEST_INTERVAL


def scaled(own: Estimate, factor: float, lower: float, upper: float) -> Estimate:
    """The estimate with its interval wider (or narrower) by a factor on either side, within what is possible."""
    std = None if own.std is None else own.std * factor
    low, high = own.value - factor * (own.value - own.low), own.value + factor * (own.high - own.value)
    return Estimate(own.value, std, max(low, lower), min(high, upper))


def across(
    member: Candidate, own: Mapping[str, Estimate], others: Sequence[Mapping[str, Estimate]]
) -> dict[str, Estimate]:
    """Estimates whose intervals reach over those of the same effect in other sets that the recordings do not part from this one.

    What stands beside an effect is part of what its numbers mean: beside a payload in place of a shifted centre of mass, every
    torque is another one (averaging over models: Hoeting et al., Statist. Sci. 14 (1999) 382). Sets in which the effect may as
    well be absent say what else it could be, and nothing of its size. Phases and whole numbers stay.
    """
    out = dict(own)
    others = [other for other in others if _present(member, other)]
    for name, estimate in own.items():
        if name in ("phase", "periods") or estimate.std is None:
            continue
        low = min([estimate.low, *(other[name].low for other in others)])
        high = max([estimate.high, *(other[name].high for other in others)])
        if (low, high) != (estimate.low, estimate.high):
            out[name] = replace(estimate, std=max(estimate.std, (high - low) / (2.0 * NORMAL_95)), low=low, high=high)
    return out


def no_more_exact_than_the_law(member: Candidate, own: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Estimates with the error of the effect's own model in them: it lies anywhere within its limits."""
    out = dict(own)
    for parameter in member.effect.parameters:
        found, share = own[parameter.name], parameter.inexact
        if share > 0.0:
            off = share * abs(found.value)
            std = None if found.std is None else float(np.hypot(found.std, off / np.sqrt(3.0)))
            low, high = max(found.low - off, parameter.lower), min(found.high + off, parameter.upper)
            out[parameter.name] = Estimate(found.value, std, low, high)
    return out


def _present(member: Candidate, values: Mapping[str, Estimate]) -> bool:
    """Whether an interval of how strongly an effect acts leaves out that it does not act."""
    if not member.effect.parameters:
        return True
    first = member.effect.parameters[0]
    size, origin = values[first.name], first.neutral if np.isfinite(first.neutral) else 0.0
    return abs(size.value - origin) > NORMAL_95 * (size.std or 0.0)
