"""Ways of a fit out of wrong valleys: everything else first, the nominal quantities last, along a bent valley, in another shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import RANKING_GAIN
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.prediction.coordinates import is_logarithmic, to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis, tolerances
from harness.diagnose.selection.bench import Bench
from harness.diagnose.selection.constants.starts import (
    AS_GOOD_COST_RATIO,
    BENT_BACK_STEP,
    BENT_STAGE_STEPS,
    DEAD_DAMPING_RATIO,
    FAR_WORSE_RATIO,
    FEWEST_BENT_STAGES,
    FOLLOWING_STEPS,
    MOST_BENT_STAGES,
    OFF_THE_WAY_RATIO,
    PROMISED_SHARES,
)
from harness.diagnose.selection.starts import like, shapeless

Array = NDArray[np.float64]


def in_shape(study: Bench, fitted: Fit, target: float) -> Fit:
    """The fit with general laws that act as their special cases begun again from other shapes.

    Where a law's second size is gone, its other numbers say nothing, and no small step leads back.
    """
    hypothesis = fitted.hypothesis
    for k, member in enumerate(hypothesis.members):
        values = study.predictor.effect_values(hypothesis, k, fitted.x)
        if fitted.score < AS_GOOD_COST_RATIO * study.samples or not shapeless(member, values):
            continue
        points = like(member, float(values[0]))
        starts = [study.predictor.with_values(hypothesis, k, fitted.x, point) for point in points]
        fitted = study.fit(hypothesis, starts, fitted, target=target)
    return fitted


def made_to_ring(study: Bench, fitted: Fit, most_steps: int) -> Fit:
    """The better of a fit and of the same begun anew with dead vibrations ringing, once for each set."""
    hypothesis = fitted.hypothesis
    start = None if hypothesis.identity in study.rung else ringing(study.predictor, fitted)
    if start is None:
        return fitted
    study.rung.add(hypothesis.identity)
    other = fit(
        study.objective(hypothesis), start, fitted.states, fixed=study.whole(hypothesis),
        most_steps=most_steps, enough=RANKING_GAIN, target=fitted.score, others=study.others(hypothesis),
    )  # fmt: skip
    return min(fitted, other, key=study.criterion)


def ringing(predictor: Predictor, fitted: Fit) -> Array | None:
    """The same point with vibrations that do not ring made to ring as most do; None if there are none.

    What is damped so strongly acts as a lag, and beside another lag it has a valley of its own.
    """
    hypothesis, x = fitted.hypothesis, fitted.x.copy()
    for k, member in enumerate(hypothesis.members):
        names = member.effect.parameter_names
        values = predictor.effect_values(hypothesis, k, fitted.x)
        if "damping_ratio" not in names or not member.effect.adds_coordinates:
            continue
        place = names.index("damping_ratio")
        if values[place] < DEAD_DAMPING_RATIO:
            continue
        values[place] = member.effect.parameters[place].scale(member.references)
        x = predictor.with_values(hypothesis, k, x, values)
    return None if np.array_equal(x, fitted.x) else x


def absent(predictor: Predictor, hypothesis: Hypothesis, k: int, x: Array) -> Array:
    """The parameter vector with member ``k`` at its neutral values, where those are within reach; angles stay as they are."""
    member, span = hypothesis.members[k], hypothesis.span(k)
    own = slice(len(predictor.nominal) + span.start, len(predictor.nominal) + span.stop)
    parameters = member.effect.parameters
    away = to_internal(member, np.array([p.neutral for p in parameters], dtype=np.float64))
    sized = np.array([k == 0 or p.unit != "rad" for k, p in enumerate(parameters)], dtype=bool)
    out = x.copy()
    out[own] = np.where(sized & np.isfinite(away) & np.logical_not(is_logarithmic(member)), away, x[own])
    return out


def brought_back(study: Bench, base: Fit, hypothesis: Hypothesis, start: Array) -> Fit | None:
    """A fit to go on from instead of a start that is far worse than the fit it extends; None if the start will do.

    A score test is linear, and lets everything else follow. So everything else follows first, with the new effect held at its
    promised size; where a swing slips out of its cycle on the way there, at a share of it.
    """
    neutral = absent(study.predictor, hypothesis, len(hypothesis.members) - 1, start)
    if np.array_equal(neutral, start):
        return None
    points = [neutral + share * (start - neutral) for share in PROMISED_SHARES]
    states = study.states_for(hypothesis, base)
    objective = study.objective(hypothesis)
    costs = [cost for cost, _ in objective.residuals([(x, states) for x in points])]
    if costs[0] < FAR_WORSE_RATIO * base.linear.cost:
        return None
    held = study.whole(hypothesis)
    held[len(start) - hypothesis.members[-1].size :] = True
    found = []
    for x in (points[0], points[int(np.argmin(costs))]):
        found.append(fit(objective, x, states, most_steps=FOLLOWING_STEPS, enough=RANKING_GAIN, fixed=held))
        if found[-1].score < base.score:
            break
    return min(found, key=lambda f: f.score)


def bent_back(
    study: Bench, near: Fit, x: Array, hypothesis: Hypothesis, most_steps: int, target: float = -np.inf
) -> Fit:
    """The fit of a hypothesis from a point with the nominal quantities as stated, and those freed only in the end.

    What was bent far to do without an effect stands at the end of a valley so narrow and curved that steps along it are
    short. Bent back at once, the effects alone find their size.
    """
    k = len(study.predictor.nominal)
    start = np.concatenate([np.zeros(k), x[k:]])
    held = study.whole(hypothesis)
    held[:k] = True
    straight = fit(
        study.objective(hypothesis), start, study.states_for(hypothesis, near),
        most_steps=most_steps, enough=RANKING_GAIN, fixed=held, target=FAR_WORSE_RATIO * near.cost, others=study.others(hypothesis),
    )  # fmt: skip
    if straight.cost > FAR_WORSE_RATIO * near.cost:
        straight = _led_back(study, near, hypothesis, held) or straight
    return study.fit(hypothesis, [straight.x], straight, most_steps=most_steps, target=target)


def _led_back(study: Bench, near: Fit, hypothesis: Hypothesis, held: NDArray[np.bool_]) -> Fit | None:
    """The fit with the nominal quantities as stated, reached along the valley from where they are bent and an effect is absent.

    They are bent back a little at a time and the effects fitted again, which keeps every swing in its cycle. None where the way
    is lost.
    """
    k = len(study.predictor.nominal)
    bent = near.x[:k]
    if hypothesis.without(len(hypothesis.members) - 1).keys != near.hypothesis.keys:
        return None
    x = absent(
        study.predictor,
        hypothesis,
        len(hypothesis.members) - 1,
        np.concatenate([near.x, np.ones(len(held) - len(near.x))]),
    )
    last, states, found = x, study.states_for(hypothesis, near), None
    stages = int(
        np.clip(
            np.ceil(np.abs(bent * tolerances(study.predictor.nominal)).max() / BENT_BACK_STEP),
            FEWEST_BENT_STAGES,
            MOST_BENT_STAGES,
        )
    )
    for stage in range(stages):
        # As much further as the last step went.
        ahead = np.concatenate([bent * (1.0 - (stage + 1) / stages), 2.0 * x[k:] - last[k:]])
        found = fit(
            study.objective(hypothesis), ahead, states,
            most_steps=BENT_STAGE_STEPS, enough=RANKING_GAIN, fixed=held,
        )  # fmt: skip
        if found.cost > OFF_THE_WAY_RATIO * near.cost:
            return None
        last, x, states = x, found.x, dict(found.states)
    return found
