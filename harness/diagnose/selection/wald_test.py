"""What a fit would leave without one of its members, by the linear view of it.

Where all else stands as it is, a member that is hardly there may still be missed: it has settled against the others. Their answer
to its absence is what the linear view tells, and good to little where little changes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import from_internal, to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis

Array = NDArray[np.float64]


def rise_without(fitted: Fit, nominal: int, k: int) -> float:
    """By how much the score rises without member ``k`` once all else has followed; inf for what has no size at which it is absent.

    nominal: number of leading parameters, with a unit normal prior.
    """
    member, span = fitted.hypothesis.members[k], fitted.hypothesis.span(k)
    own = fitted.x[nominal + span.start : nominal + span.stop]
    if not member.effect.parameters:
        return np.inf
    away = absent(member, own) - own[0]
    if not np.isfinite(away):
        return np.inf
    free = fitted.free.copy()
    free[nominal + span.start : nominal + span.stop] = False
    held = np.eye(nominal, len(fitted.x))
    rows = np.vstack([fitted.linear.matrix, held])
    here = np.concatenate([fitted.linear.vector, fitted.x[:nominal]])
    there = here + rows[:, nominal + span.start] * away
    followed = rows[:, free] @ np.linalg.lstsq(rows[:, free], -there, rcond=None)[0]
    left = there + followed
    return float(left @ left - here @ here)


def carried(before: Hypothesis, x: Array, after: Hypothesis, otherwise: Array) -> tuple[Array, Array]:
    """A set's numbers with those that another set has from there: the others as given, and with their members absent.

    Not finite in the second where a further member has no size at which it is absent.
    """
    nominal = len(otherwise) - after.size
    given = otherwise.copy()
    given[:nominal] = x[:nominal]
    without = given.copy()
    for k, member in enumerate(after.members):
        span = after.span(k)
        place = slice(nominal + span.start, nominal + span.stop)
        if member.key in before.keys:
            known = before.span(before.keys.index(member.key))
            given[place] = without[place] = x[nominal + known.start : nominal + known.stop]
        elif member.size:
            without[place.start] = absent(member, given[place])
    return given, without


def absent(member: Candidate, own: Array) -> float:
    """Where a member's first coordinate stands when it is absent."""
    values = from_internal(member, own)
    values[0] = member.effect.parameters[0].neutral
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(to_internal(member, values)[0])
