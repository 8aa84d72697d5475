"""Intervals of effect parameters: from the curvature of the likelihood, nominal tolerances and initial states profiled out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from harness.diagnose.coordinates import from_internal, is_logarithmic
from harness.diagnose.fit import Fit, covariance
from harness.diagnose.hypothesis import whole_numbers
from harness.diagnose.predict import Predictor
from harness.diagnose.study import Study

Array = NDArray[np.float64]

WIDE = float(norm.ppf(0.975))


@dataclass(frozen=True)
class Estimate:
    """Value, standard deviation and 95 % interval in SI; std is None where the value lies at a bound of what is possible."""

    value: float
    std: float | None
    low: float
    high: float


def inflation(fitted: Fit) -> float:
    """Variance of the whitened residual, never below one: what the noise model leaves unexplained widens the intervals."""
    rows = np.concatenate(fitted.linear.residuals)
    used = rows[rows != 0.0]
    dof = max(len(used) - int(fitted.free.sum()) - sum(len(s) for s in fitted.states.values()), 1)
    return max(1.0, float(used @ used) / dof)


MOST_NEIGHBOURS = 5


def whole_interval(study: Study, fitted: Fit, index: int) -> tuple[float, float]:
    """Whole numbers that the data leave open at 95 %, by fitting everything else again for each."""
    limit = fitted.score + float(chi2.ppf(0.95, 1)) * inflation(fitted)
    value = study.counted(fitted, index)
    ends = []
    for sense in (-1.0, 1.0):
        reach = 0.0
        while abs(reach) < MOST_NEIGHBOURS and value + reach + sense >= 1.0:
            if study.neighbour(fitted, index, reach + sense).score > limit:
                break
            reach += sense
        ends.append(value + reach)
    return ends[0], ends[1]


def as_likely(study: Study, best: Fit) -> list[Array]:
    """Parameter vectors at which other fits of the same hypothesis have ended, no less likely than the ends of an interval."""
    limit = best.score + float(chi2.ppf(0.95, 1)) * inflation(best)
    return [x for score, x in study.ends.get(best.hypothesis.keys, ()) if score < limit]


def estimates(
    predictor: Predictor, fitted: Fit, k: int, study: Study | None = None, others: Sequence[Array] = ()
) -> dict[str, Estimate]:
    """Estimates of member k's parameters, by name.

    study: of the fit, to try other whole numbers in. others: parameter vectors that are as likely; intervals reach to them, since
    a curvature knows only the valley that it was taken in (a vibration fits at more than one damping).
    """
    member = fitted.hypothesis.members[k]
    span = fitted.hypothesis.span(k)
    first = len(predictor.nominal) + span.start
    within = np.zeros(len(fitted.x), dtype=bool)
    within[first : first + member.size] = True
    # What lies at an end of where it was searched is not known to be there: the other parameters' intervals allow for it.
    open_ = replace(fitted, free=fitted.free | (within & (np.linalg.norm(fitted.linear.matrix, axis=0) > 0.0)))
    sigma = np.sqrt(np.diag(covariance(open_, len(predictor.nominal), inflation(fitted))))
    sigma[~fitted.free] = np.nan
    log = is_logarithmic(member)
    whole = whole_numbers(member)
    u = fitted.x[first : first + member.size]
    values = from_internal(member, u)
    out = {}
    for j, parameter in enumerate(member.effect.parameters):
        s = float(sigma[first + j])
        value = float(values[j])
        if whole[j]:
            low, high = whole_interval(study, fitted, first + j) if study is not None else (value, value)
            out[parameter.name] = Estimate(
                float(round(value)), 0.25 * (high - low), float(round(low)), float(round(high))
            )
            continue
        if parameter.name == "phase" and np.isfinite(s):
            # A whole turn more is the same phase; more than half a turn either way says nothing.
            value -= 2.0 * np.pi * round(value / (2.0 * np.pi))
            std = s * float(member.scales[j])
            reach = min(WIDE * std, np.pi)
            out[parameter.name] = Estimate(value, std, value - reach, value + reach)
            continue
        if not np.isfinite(s):
            # At a bound: one-sided, from the curvature there if it can be had.
            width = _bound_width(fitted, first + j, len(predictor.nominal))
            edge = from_internal(member, np.where(np.arange(member.size) == j, u + WIDE * width, u))[j]
            other = from_internal(member, np.where(np.arange(member.size) == j, u - WIDE * width, u))[j]
            low, high = sorted((float(edge), float(other)))
            out[parameter.name] = Estimate(value, None, max(low, parameter.lower), min(high, parameter.upper))
            continue
        if log[j]:
            low, high = value * float(np.exp(-WIDE * min(s, 20.0))), value * float(np.exp(WIDE * min(s, 20.0)))
            std = value * s
        else:
            std = s * float(member.scales[j])
            low, high = value - WIDE * std, value + WIDE * std
        out[parameter.name] = Estimate(value, std, max(low, parameter.lower), min(high, parameter.upper))
    elsewhere = [from_internal(member, x[first : first + member.size]) for x in others]
    moved = any(round(float(there[j])) != round(float(values[j])) for there in elsewhere for j in np.flatnonzero(whole))
    for j, parameter in enumerate(member.effect.parameters):
        found = out[parameter.name]
        if parameter.name == "phase":
            if moved:
                # Of waves of different length the phases cannot be compared.
                out[parameter.name] = replace(
                    found, std=np.pi / np.sqrt(3.0), low=found.value - np.pi, high=found.value + np.pi
                )
            continue
        low = min([found.low, *(float(there[j]) for there in elsewhere)])
        high = max([found.high, *(float(there[j]) for there in elsewhere)])
        if whole[j]:
            low, high = float(round(low)), float(round(high))
            found = replace(found, std=0.25 * (high - low))
        out[parameter.name] = replace(found, low=low, high=high)
    return out


def _bound_width(fitted: Fit, index: int, nominal: int) -> float:
    column = fitted.linear.matrix[:, index]
    information = float(column @ column) + (1.0 if index < nominal else 0.0)
    return min(float(1.0 / np.sqrt(information)), 20.0) if information > 0.0 else 20.0
