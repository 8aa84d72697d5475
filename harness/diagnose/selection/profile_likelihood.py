"""Intervals that look beyond the valley a fit stands in: by fitting everything else again at other values.

What vibrates fits the noise a little at every frequency, in many narrow valleys, and a number at a bound has no curvature: there
the number is fixed farther and farther out. Intervals reach over the same effect's in every other set that is at least a twentieth
as likely and cannot do without it, and to other numbers of periods, where the phase is then open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import NORMAL_95, RANKING_GAIN, WIDEST_INTERVAL
from harness.diagnose.estimation.intervals import Estimate, inflation
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.objective import States
from harness.diagnose.prediction.coordinates import is_logarithmic
from harness.diagnose.problem.hypothesis import Candidate, whole_numbers
from harness.diagnose.selection.constants.weighing import (
    END_REFINEMENTS,
    FARTHEST_LOGARITHM,
    MOST_DOUBLINGS,
    MOST_HALVINGS,
    MOST_NEIGHBOURS,
    OUTWARD_STEPS,
    PROFILE_95,
    UNKNOWN_LOGARITHM,
    VALLEYS_EVIDENCE,
)
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


def whole_interval(study: Study, fitted: Fit, index: int, lower: float, upper: float) -> tuple[float, float]:
    """Whole numbers from lower to upper that the data leave open at 95 %, by fitting everything else again for each."""
    limit = fitted.score + PROFILE_95 * inflation(fitted)
    value = study.counted(fitted, index)
    ends = []
    for sense in (-1.0, 1.0):
        reach = 0.0
        while abs(reach) < MOST_NEIGHBOURS and lower <= value + reach + sense <= upper:
            if study.neighbour(fitted, index, reach + sense).score > limit:
                break
            reach += sense
        ends.append(value + reach)
    return ends[0], ends[1]


def as_likely(study: Study, best: Fit, k: int) -> list[Array]:
    """Values of member ``k`` where other fits of the same hypothesis have ended, no less likely than the ends of an interval."""
    limit = best.score + PROFILE_95 * inflation(best)
    ends = study.ends.get(best.hypothesis.keys, ())
    return [study.predictor.effect_values(best.hypothesis, k, x) for score, x in ends if score < limit]


def reached(study: Study, fitted: Fit, index: int, width: float, valleys: float = VALLEYS_EVIDENCE) -> float:
    """How far from where it stands a parameter may lie, everything else fitted again; ``width`` at least, in the fit's coordinates.

    Of what vibrates a fit knows one of many narrow valleys, and its curvature says nothing of the next. A place counts if a fit
    there is as likely as the truth would be beside the best of so many valleys.
    """
    limit = fitted.score + PROFILE_95 * inflation(fitted) + valleys
    objective = study.objective(fitted.hypothesis).on(fitted.windows)
    lower, upper = objective.bounds()
    held = study.whole(fitted.hypothesis)
    held[index] = True

    def likely(x: Array, states: States) -> Fit | None:
        if not lower[index] <= x[index] <= upper[index]:
            return None
        found = fit(objective, x, states, fixed=held, most_steps=OUTWARD_STEPS, enough=RANKING_GAIN, target=limit)
        return found if found.score < limit else None

    good, last = width, fitted
    for power in range(1, MOST_DOUBLINGS + 1):
        # Beyond a ridge there may be as good a valley.
        away = 2.0**power * width
        further = (
            likely(_moved(last, index, fitted.x[index] + away), last.states) if abs(away) < FARTHEST_LOGARITHM else None
        )
        if further is not None:
            good, last = away, further
    for factor in (2.0**0.5, 2.0**0.25) if last is not fitted else ():
        if likely(_moved(last, index, fitted.x[index] + factor * good), last.states) is not None:
            good *= factor
    return good


def kept_within(study: Study, fitted: Fit, index: int, width: float) -> float:
    """How far from where it stands a parameter may lie, everything else fitted again; ``width`` at most, in the fit's coordinates.

    For what a change of other parameters makes up for but for squares: the curvature says next to nothing of it.
    """
    limit = fitted.score + PROFILE_95 * inflation(fitted)
    objective = study.objective(fitted.hypothesis).on(fitted.windows)
    lower, upper = objective.bounds()
    held = study.whole(fitted.hypothesis)
    held[index] = True

    def likely(away: float) -> bool:
        x = _moved(fitted, index, float(np.clip(fitted.x[index] + away, lower[index], upper[index])))
        return (
            fit(
                objective, x, fitted.states, fixed=held, most_steps=OUTWARD_STEPS, enough=RANKING_GAIN, target=limit
            ).score
            < limit
        )

    good, bad = width, 0.0
    for _ in range(MOST_HALVINGS):
        if likely(good):
            break
        good, bad = 0.5 * good, good
    for _ in range(END_REFINEMENTS if bad else 0):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if likely(middle) else (good, middle)
    return bad or good


def _moved(fitted: Fit, index: int, value: float) -> Array:
    x = fitted.x.copy()
    x[index] = value
    return x


def profiled(study: Study, fitted: Fit, k: int, read: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Estimates of member ``k``'s parameters, with other whole numbers tried, other valleys of what vibrates, and what lies at an
    end of where it was searched followed inwards.

    read: the estimates that the curvature gives.
    """
    member = fitted.hypothesis.members[k]
    first = len(study.predictor.nominal) + fitted.hypothesis.span(k).start
    log, whole = is_logarithmic(member), whole_numbers(member)
    out = dict(read)
    for j, parameter in enumerate(member.effect.parameters):
        own = read[parameter.name]
        if whole[j]:
            low, high = whole_interval(study, fitted, first + j, parameter.lower, parameter.upper)
            out[parameter.name] = _whole(own, low, high)
        elif (
            log[j]
            and member.effect.adds_coordinates
            and own.std is not None
            and own.std < UNKNOWN_LOGARITHM * own.value
        ):
            narrow = NORMAL_95 * min(own.std / own.value, WIDEST_INTERVAL)
            down, up = (reached(study, fitted, first + j, sense * narrow) for sense in (-1.0, 1.0))
            low = max(own.value * float(np.exp(down)), parameter.lower)
            high = min(own.value * float(np.exp(up)), parameter.upper)
            std = max(own.std, own.value * (up - down) / (2.0 * NORMAL_95))
            out[parameter.name] = replace(own, std=std, low=low, high=high)
        elif log[j] and own.std is None and not member.effect.adds_coordinates and 0.0 < own.low < own.high:
            # At an end of where it was searched, a parameter may do so little that its slope is that of the solver's steps.
            widths = float(np.log(own.low / own.value)), float(np.log(own.high / own.value))
            down, up = (reached(study, fitted, first + j, width, 0.0) if width else 0.0 for width in widths)
            out[parameter.name] = replace(
                own,
                low=max(own.value * float(np.exp(down)), parameter.lower),
                high=min(own.value * float(np.exp(up)), parameter.upper),
            )
        elif member.effect.sensor is not None and member.effect.sensor.at_first and own.std is not None and not log[j]:
            # Let go later with the speed gained by then is the same motion but for squares: what stood still parts the two.
            scale = float(member.scales[j])
            widest = 2.0 * NORMAL_95 * own.std / scale
            down, up = (kept_within(study, fitted, first + j, sense * widest) for sense in (-1.0, 1.0))
            low, high = max(own.value + down * scale, parameter.lower), min(own.value + up * scale, parameter.upper)
            out[parameter.name] = replace(own, std=(high - low) / (2.0 * NORMAL_95), low=low, high=high)
    return out


def spanning(member: Candidate, own: Mapping[str, Estimate], places: Sequence[Array]) -> dict[str, Estimate]:
    """Estimates whose intervals reach to other places that are as likely; ``places``: the member's values there."""
    whole = whole_numbers(member)
    names = member.effect.parameter_names
    moved = any(round(float(there[j])) != own[names[j]].value for there in places for j in np.flatnonzero(whole))
    out = dict(own)
    for j, name in enumerate(names):
        found = own[name]
        if name == "phase":
            if moved:
                # Of waves of different length the phases cannot be compared.
                spread, value = np.pi / np.sqrt(3.0), found.value
                out[name] = Estimate(value, spread, value - np.pi, value + np.pi)
            continue
        low = min([found.low, *(float(there[j]) for there in places)])
        high = max([found.high, *(float(there[j]) for there in places)])
        out[name] = _whole(found, low, high) if whole[j] else replace(found, low=low, high=high)
    return out


def _whole(found: Estimate, low: float, high: float) -> Estimate:
    """The estimate of a whole number that may lie from ``low`` to ``high``."""
    return Estimate(found.value, 0.25 * (high - low), float(round(low)), float(round(high)))
