"""Whether predictions of data held out need a member of a set, so that a remainder cannot have faked it."""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.alternatives import tests_of
from harness.diagnose.criticism.check import Asked
from harness.diagnose.criticism.constants import (
    AMPLY_CARRIES_RATIO,
    CARRIES_RATIO,
    FAKED_RATIO,
    HELD_OUT_FIT_STEPS,
    NEEDED_SHARE,
    STEADY_FREQUENCY_DIFFERENCE,
    STEADY_PHASE_DIFFERENCE,
    STEADY_SIGMAS,
    STEADY_SIZE_DIFFERENCE,
)
from harness.diagnose.criticism.locate import rmse
from harness.diagnose.criticism.members import nowhere
from harness.diagnose.criticism.remainder import asked_of
from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.selection.outcome import Outcome, judge, judge_straight, trained
from harness.diagnose.selection.state_evidence import placed


def firm(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether predictions of data held out need member ``k``, amply, or else at the size that those data give by themselves.

    Never of a force or error that could be put at many places: one of them always fits some of what something else makes, and
    recordings of one rig repeat that (beside a force that is left out it is possible, and told as no more). Nor of what a sensor or
    drive does if a force might do it: not even the side is then known.
    """
    anywhere = placed(best.hypothesis.members[k]) and outcome.force is None
    if anywhere or nowhere(outcome, best, k) or a_force_as_well(outcome, best, k):
        return False
    smaller = outcome.study.below(best, k)
    if carries(outcome, best, smaller, AMPLY_CARRIES_RATIO):
        return True
    return carries(outcome, best, smaller, CARRIES_RATIO) and steady(outcome, trained(outcome, best), k)


def carries(outcome: Outcome, best: Fit, smaller: Fit, times: float) -> bool:
    """Whether predictions of data held out, the remainder's error included, become clearly worse without the effect.

    Real recordings always keep a remainder far above the noise of their sensors. What removes most of the error of a free run
    over data that it was not fitted to is no artefact of that remainder, whatever else is at work.
    """
    # A nominal model bent out of its tolerance may predict as well what the effect is there for; that is no way to do without it.
    study = outcome.study
    bent = study.stretched(smaller, study.loudness(smaller))
    # Nor is it a way to do with it.
    held = (judge_straight if bent and study.stretched(best, study.loudness(best)) else judge)(outcome, best)
    without = judge_straight(outcome, smaller) if bent else judge(outcome, smaller)
    channels = range(len(outcome.problem.channels))
    return any(rmse(outcome, without, c) > times * rmse(outcome, held, c) for c in channels)


def steady(outcome: Outcome, own: Fit, k: int) -> bool:
    """Whether the data held out, fitted by themselves, give member ``k`` about the same size as the training did.

    What only soaks up a remainder seldom does so twice with the same numbers.
    """
    study, held = outcome.study, outcome.held_windows
    if own.hypothesis.identity not in outcome.alone:
        states = judge(outcome, own).states
        outcome.alone[own.hypothesis.identity] = fit(
            study.objective(own.hypothesis).on(held), own.x, states, most_steps=HELD_OUT_FIT_STEPS
        )
    other = outcome.alone[own.hypothesis.identity]
    a, b = (outcome.predictor.effect_values(f.hypothesis, k, f.x) for f in (own, other))
    spreads = [estimates(outcome.predictor, f, k) for f in (own, other)]
    for j, parameter in enumerate(own.hypothesis.members[k].effect.parameters):
        origin = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
        one, two = a[j] - origin, b[j] - origin
        if parameter.name == "phase":
            if abs(np.angle(np.exp(1j * (one - two)))) > STEADY_PHASE_DIFFERENCE:
                return False
        elif parameter.name == "frequency" or j == 0:
            reach = (STEADY_FREQUENCY_DIFFERENCE if parameter.name == "frequency" else STEADY_SIZE_DIFFERENCE) * max(
                abs(one), abs(two)
            )
            unsure = float(np.linalg.norm([s[parameter.name].std or 0.0 for s in spreads]))
            if abs(one - two) > max(reach, STEADY_SIGMAS * unsure):
                return False
    return True


def a_force_as_well(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether what member ``k``, of a sensor or of a drive, explains is also explained by a force that nobody has named; what a
    base does, or a link that bends, by one that relaxes.

    The force may act on both sides of the comparison, so that what it explains of a remainder says nothing about the member.
    """
    study, effect = outcome.study, best.hypothesis.members[k].effect
    asked = [check for check in asked_of(Asked.OF_EVERY_FIT) if check.on_both_sides(effect)]
    smaller = study.below(best, k)

    def left(fitted: Fit) -> dict[tuple[str, str], float]:
        there = max(fitted.score - study.samples, 0.0)
        return {(t.name, t.where[0]): max(there - t.gain, 0.0) for t in tests_of(study, fitted, asked)}

    without, with_ = left(smaller), left(best)
    least = NEEDED_SHARE * (smaller.score - best.score)
    return any(without[key] < max(FAKED_RATIO * with_[key], least) for key in without.keys() & with_.keys())
