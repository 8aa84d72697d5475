"""Intervals of effect parameters: from the curvature of the likelihood, nominal tolerances and initial states profiled out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from harness.diagnose.coordinates import from_internal, is_logarithmic
from harness.diagnose.fit import Fit, covariance, fit
from harness.diagnose.hypothesis import whole_numbers
from harness.diagnose.objective import States
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
MOST_DOUBLED, OUTWARD_STEPS = 5, 10  # times that an interval is doubled outward; steps of a fit there
FARTHEST = 4.0  # of a logarithm, that it may reach
UNKNOWN = 1.0  # of a logarithm: what is as uncertain as that is wide enough
# What vibrates fits the noise a little at every frequency, in valleys a hundredth wide: twice the logarithm of how many there are.
VALLEYS = 8.0


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


def reached(study: Study, fitted: Fit, index: int, width: float) -> float:
    """How far from where it stands a parameter may lie, everything else fitted again; ``width`` at least, in the fit's coordinates.

    Of what vibrates a fit knows one of many narrow valleys, and its curvature says nothing of the next. A place counts if a fit
    there is as likely as the truth would be beside the best of so many valleys.
    """
    limit = fitted.score + float(chi2.ppf(0.95, 1)) * inflation(fitted) + VALLEYS
    objective = study.objective(fitted.hypothesis).on(fitted.windows)
    lower, upper = objective.bounds()
    held = study.whole(fitted.hypothesis)
    held[index] = True

    def likely(x: Array, states: States) -> Fit | None:
        if not lower[index] <= x[index] <= upper[index]:
            return None
        found = fit(objective, x, states, fixed=held, most_steps=OUTWARD_STEPS, enough=0.2, target=limit)
        return found if found.score < limit else None

    good, last = width, fitted
    for power in range(1, MOST_DOUBLED + 1):
        # Beyond a ridge there may be as good a valley.
        away = 2.0**power * width
        further = likely(_moved(last, index, fitted.x[index] + away), last.states) if abs(away) < FARTHEST else None
        if further is not None:
            good, last = away, further
    for factor in (2.0**0.5, 2.0**0.25) if last is not fitted else ():
        if likely(_moved(last, index, fitted.x[index] + factor * good), last.states) is not None:
            good *= factor
    return good


def _moved(fitted: Fit, index: int, value: float) -> Array:
    x = fitted.x.copy()
    x[index] = value
    return x


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
            down, up = -WIDE * min(s, 20.0), WIDE * min(s, 20.0)
            if study is not None and member.effect.adds_coordinates and s < UNKNOWN:
                down, up = reached(study, fitted, first + j, down), reached(study, fitted, first + j, up)
            low, high = value * float(np.exp(down)), value * float(np.exp(up))
            std = value * max(s, (up - down) / (2.0 * WIDE))
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


def across(own: Mapping[str, Estimate], others: Sequence[Mapping[str, Estimate]]) -> dict[str, Estimate]:
    """Estimates whose intervals reach over those of the same effect in other sets that the recordings do not part from this one.

    What stands beside an effect is part of what its numbers mean: beside a payload in place of a shifted centre of mass, every
    torque is another one (averaging over models: Hoeting et al., Statist. Sci. 14 (1999) 382). Phases and whole numbers stay.
    """
    out = dict(own)
    for name, estimate in own.items():
        if name in ("phase", "periods") or estimate.std is None:
            continue
        low = min([estimate.low, *(other[name].low for other in others)])
        high = max([estimate.high, *(other[name].high for other in others)])
        if (low, high) != (estimate.low, estimate.high):
            out[name] = replace(estimate, std=max(estimate.std, (high - low) / (2.0 * WIDE)), low=low, high=high)
    return out


def _bound_width(fitted: Fit, index: int, nominal: int) -> float:
    column = fitted.linear.matrix[:, index]
    information = float(column @ column) + (1.0 if index < nominal else 0.0)
    return min(float(1.0 / np.sqrt(information)), 20.0) if information > 0.0 else 20.0
