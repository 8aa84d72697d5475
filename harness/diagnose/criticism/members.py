"""Kinds of members that are doubted in different ways: plain laws, what was chosen among many places, what shakes or relaxes."""

from __future__ import annotations

from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.outcome import Outcome
from harness.effects.effect import Effect, Family


def beside_force(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` is a plain law that was weighed beside a force that is left out.

    That evidence has the force in it already, so that what every rig has need not explain many times as much as the force.
    """
    return outcome.force is not None and best.hypothesis.members[k].effect.plain


def nowhere(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` acts from a place on, and which side of the middle that is on is not known: it is then no stop."""
    parameter = next(iter(best.hypothesis.members[k].effect.parameters), None)
    if parameter is None or parameter.search != "range" or parameter.lower >= 0.0:
        return False
    place = estimates(outcome.predictor, best, k)[parameter.name]
    return place.low <= 0.0 <= place.high


def tuned_to_relax(effect: Effect) -> bool:
    """Whether it would be a coincidence if an effect looked like a force that relaxes at a joint.

    Any spring, inertia or damping there is one, at a single frequency. What acts at certain times is another thing.
    """
    if effect.family is Family.BASE:
        return effect.adds_coordinates
    return effect.family in (Family.ELASTICITY, Family.SENSOR, Family.INPUT)


def shakes(member: Candidate) -> bool:
    """Whether an effect is a force that comes and goes steadily with time, whatever the motion."""
    return member.effect.side == "dynamics" and {"frequency", "phase"} <= set(member.effect.parameter_names)
