"""What must be doubted: findings that something nobody has named could have made, and laws that a remainder does not part."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from harness.diagnose.criticism.creep import creeps
from harness.diagnose.criticism.crosstalk import leaking
from harness.diagnose.criticism.locate import rmse
from harness.diagnose.criticism.probe import Test
from harness.diagnose.criticism.relaxation import RELAXES
from harness.diagnose.criticism.remainder import SETS_IN, Remains, examine, jump, wandering
from harness.diagnose.criticism.single_event import event_as_well
from harness.diagnose.criticism.vertical_shaking import shaken_sideways, shaken_up_and_down
from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.exchange import known_in_place_of, related, relatives, specialized
from harness.diagnose.selection.investigation import Outcome, judge, judge_straight, trained
from harness.diagnose.selection.score_tests import nuisance, scanned
from harness.diagnose.selection.study import Study
from harness.effects.effect import Effect, Family
from harness.effects.scale import references

FAKED = (
    10.0  # an effect must explain so many times what the remainder still holds, or the remainder might have faked it
)
NEEDED = (
    0.05  # share of what an effect explains that an unnamed force must leave, to which its linear response is trusted
)
CARRIES = (
    1.4  # times that the held-out free run's error grows without an effect that is claimed beside such a remainder
)
AMPLY = 1.8  # times that it grows without an effect that is claimed whatever the data held out give by themselves
MOST_UNPARTED = 4  # relatives fitted for what beside a remainder might as well be the law
BETTER = 12.0  # in the criterion, by which an unnamed force must do better than an effect that explains all
STEADY, STEADY_FREQUENCY = 0.4, 0.03  # relative differences between separate recordings
STEADY_PHASE = 0.6  # rad
UNSURE = 3.0  # standard deviations that separate estimates may always be apart
LEVEL = (
    1e-5  # chance at which a test of the remainder counts; all recordings are tested at once, a dozen questions each
)
AT_FLOOR = 1.2  # held-out residual over the noise floor up to which a model counts as complete


def examined(outcome: Outcome, fitted: Fit) -> Remains:
    """The tests of what a fit leaves, at every joint."""
    system = outcome.problem.system
    torques = [references(system, joint).torque for joint in system.joint_names]
    likelihood = outcome.study.likelihood
    return examine(outcome.predictor, likelihood, fitted, system.joint_names, torques, outcome.period, LEVEL)


def _imitated(outcome: Outcome, best: Fit, smaller: Fit, margin: float = 0.0, *, exact: bool = False) -> bool:
    """Whether a force, or error of a reading, that nobody has named does better by ``margin`` than what a member does.

    exact: ask only for what brings what it promises.
    """
    study = outcome.study
    tests: list[Test] | tuple[Test, ...]
    if exact:
        space = nuisance(smaller, outcome.predictor)
        tests = [jump(outcome.predictor, study.likelihood, smaller, space)]
        tests += wandering(outcome.predictor, study.likelihood, smaller, outcome.period, space)
        tests += leaking(outcome.predictor, study.likelihood, smaller, space, study.loudness(smaller))
    else:
        tests = examined(outcome, smaller).tests
    missing = [m.effect for m in best.hypothesis.members if m.key not in smaller.hypothesis.keys]
    barred: list[str] = []
    # A friction or drag that sets in soon after the start is hardly another thing than one that always acts.
    if any(effect.family is Family.DISSIPATION for effect in missing):
        barred.append(SETS_IN)
    if not any(_tuned_to_relax(effect) for effect in missing):
        barred.append(RELAXES)
    named = [t for t in tests if t.places >= 0 and not t.name.startswith(tuple(barred))]
    return _do_better(study, best, smaller, named, margin)


def _do_better(study: Study, best: Fit, smaller: Fit, tests: Sequence[Test], margin: float = 0.0) -> bool:
    """Whether what one of the tests names, beside ``smaller``, does better by ``margin`` than what ``best`` has more."""
    own = smaller.score - best.score
    there = max(smaller.score - study.samples, own)

    def worth(gain: float, exact: bool) -> float:
        # A linear gain that promises more than there is says only that it might do as well.
        return gain if exact or gain < there else own

    worths = [worth(t.gain, t.exact) - t.price(study.samples) for t in tests]
    worths += [worth(t.together[0], t.exact) - t.price_together(study.samples) for t in tests]
    return bool(study.criterion(smaller) - max(worths, default=0.0) < study.criterion(best) - margin)


def imitated_together(outcome: Outcome, best: Fit, remains: Remains) -> list[str]:
    """Members that a single force or jump that nobody has named explains, better than they do together.

    A force of a shape that the catalogue does not have may be pieced together from several that it has. Beside a remainder every
    force that nobody has named explains something; only what brings what it promises is then asked for, of single members too.
    """
    found: list[str] = []
    members = range(len(best.hypothesis.members))
    for size in range(1 if remains.significant else 2, len(members) + 1):
        for some in combinations(members, size):
            keys = [best.hypothesis.keys[k] for k in some]
            smaller = best
            for key in keys:
                smaller = (
                    outcome.study.below(smaller, smaller.hypothesis.keys.index(key))
                    if key in smaller.hypothesis.keys
                    else smaller
                )
            if _imitated(outcome, best, smaller, BETTER, exact=remains.significant) or _filtered(
                outcome, best, smaller
            ):
                found += [key for key in keys if key not in found]
    return found


def _filtered(outcome: Outcome, best: Fit, smaller: Fit) -> bool:
    """Whether what ``best`` has more are filters of sensors, several of them, and one force that relaxes might do as well.

    Where the swing is nearly linear any force with a memory looks like some filters. One such force is likelier than two filters
    that come together, whatever its elements cost.
    """
    missing = [m.effect for m in best.hypothesis.members if m.key not in smaller.hypothesis.keys]
    if len(missing) < 2 or any(effect.sensor is None or effect.sensor.memory is None for effect in missing):
        return False
    own = smaller.score - best.score
    tests = examined(outcome, smaller).tests
    return any(
        t.gain >= min(own, smaller.score - outcome.study.samples) - BETTER for t in tests if t.name.startswith(RELAXES)
    )


def _excess(study: Study, best: Fit, remains: Remains) -> float:
    """What a set leaves above the noise, by the tests of the remainder or by all of its cost."""
    everywhere = float(np.sqrt(best.linear.cost / max(study.samples, 1.0)))
    return max(remains.excess, (everywhere**2 - AT_FLOOR**2) * study.samples)


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


def _steady(outcome: Outcome, own: Fit, k: int) -> bool:
    """Whether the data held out, fitted by themselves, give member ``k`` about the same size as the training did.

    What only soaks up a remainder seldom does so twice with the same numbers.
    """
    study, held = outcome.study, outcome.held_windows
    if own.hypothesis.identity not in outcome.alone:
        states = judge(outcome, own).states
        outcome.alone[own.hypothesis.identity] = fit(
            study.objective(own.hypothesis).on(held), own.x, states, most_steps=20
        )
    other = outcome.alone[own.hypothesis.identity]
    a, b = (outcome.predictor.effect_values(f.hypothesis, k, f.x) for f in (own, other))
    spreads = [estimates(outcome.predictor, f, k) for f in (own, other)]
    for j, parameter in enumerate(own.hypothesis.members[k].effect.parameters):
        origin = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
        one, two = a[j] - origin, b[j] - origin
        if parameter.name == "phase":
            if abs(np.angle(np.exp(1j * (one - two)))) > STEADY_PHASE:
                return False
        elif parameter.name == "frequency" or j == 0:
            reach = (STEADY_FREQUENCY if parameter.name == "frequency" else STEADY) * max(abs(one), abs(two))
            unsure = float(np.linalg.norm([s[parameter.name].std or 0.0 for s in spreads]))
            if abs(one - two) > max(reach, UNSURE * unsure):
                return False
    return True


def doubtful(outcome: Outcome, best: Fit, k: int, remains: Remains) -> bool:
    """Whether member ``k`` may only stand in for something that nobody has named."""
    study = outcome.study
    smaller = study.below(best, k)
    if _nowhere(outcome, best, k) or creeps(outcome, best, k):
        return True
    if _shakes(best.hypothesis.members[k]) and (
        event_as_well(outcome, best, smaller) or _up_and_down_as_well(outcome, best, smaller, remains)
    ):
        return True
    if not remains.significant:
        return _imitated(outcome, best, smaller, BETTER)
    if beside_force(outcome, best, k):
        # A force that nobody has named, and that has this law in it, explains what is left beside the law as well.
        beside = max((min(t.worth(study.samples), best.score) for t in remains.tests if t.places >= 0), default=0.0)
        return _imitated(outcome, best, smaller, BETTER + max(beside, 0.0))
    if smaller.score - best.score >= FAKED * _excess(study, best, remains) and not _imitated(outcome, best, smaller):
        return False
    return not firm(outcome, best, k)


def _up_and_down_as_well(outcome: Outcome, best: Fit, smaller: Fit, remains: Remains) -> bool:
    """Whether a support that moves up and down does as well as what shakes in the way that ``best`` has it: either is as likely."""
    study, vertical = outcome.study, shaken_up_and_down(outcome.study, smaller)
    if _do_better(study, best, smaller, [vertical]):
        return True
    if not remains.significant:
        return False
    # What does not explain all has only gained more by a fit than the other by a linear view, where the swing is changed much.
    sideways = shaken_sideways(outcome.study, smaller)
    return sideways is not None and vertical.worth(study.samples) > sideways.worth(study.samples)


def firm(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether predictions of data held out need member ``k``, amply, or else at the size that those data give by themselves.

    Never of a force or error that could be put at many places: one of them always fits some of what something else makes, and
    recordings of one rig repeat that (beside a force that is left out it is possible, and told as no more). Nor of what a sensor or
    drive does if a force might do it: not even the side is then known.
    """
    anywhere = placed(best.hypothesis.members[k]) and outcome.force is None
    if anywhere or _nowhere(outcome, best, k) or a_force_as_well(outcome, best, k):
        return False
    smaller = outcome.study.below(best, k)
    if carries(outcome, best, smaller, AMPLY):
        return True
    return carries(outcome, best, smaller, CARRIES) and _steady(outcome, trained(outcome, best), k)


def _nowhere(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` acts from a place on, and which side of the middle that is on is not known: it is then no stop."""
    parameter = next(iter(best.hypothesis.members[k].effect.parameters), None)
    if parameter is None or parameter.search != "range" or parameter.lower >= 0.0:
        return False
    place = estimates(outcome.predictor, best, k)[parameter.name]
    return place.low <= 0.0 <= place.high


def a_force_as_well(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether what member ``k``, of a sensor or of a drive, explains is also explained by a force that nobody has named; what a
    base does, or a link that bends, by one that relaxes.

    The force may act on both sides of the comparison, so that what it explains of a remainder says nothing about the member.
    """
    effect = best.hypothesis.members[k].effect
    if effect.side == "dynamics" and not _tuned_to_relax(effect):
        return False
    study = outcome.study
    smaller = study.below(best, k)

    def asked(test: Test) -> bool:
        return test.name.startswith(RELAXES) or (effect.side != "dynamics" and test.places == 0 and not test.exact)

    def left(fitted: Fit) -> dict[tuple[str, str], float]:
        there = max(fitted.score - study.samples, 0.0)
        forces = (t for t in examined(outcome, fitted).tests if asked(t))
        return {(t.name, t.where[0]): max(there - t.gain, 0.0) for t in forces}

    without, with_ = left(smaller), left(best)
    least = NEEDED * (smaller.score - best.score)
    return any(without[key] < max(FAKED * with_[key], least) for key in without.keys() & with_.keys())


def _tuned_to_relax(effect: Effect) -> bool:
    """Whether it would be a coincidence if an effect looked like a force that relaxes at a joint.

    Any spring, inertia or damping there is one, at a single frequency. What acts at certain times is another thing.
    """
    if effect.family is Family.BASE:
        return effect.adds_coordinates
    return effect.family in (Family.ELASTICITY, Family.SENSOR, Family.INPUT)


def _shakes(member: Candidate) -> bool:
    """Whether an effect is a force that comes and goes steadily with time, whatever the motion."""
    return member.effect.side == "dynamics" and {"frequency", "phase"} <= set(member.effect.parameter_names)


def beside_force(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` is a plain law that was weighed beside a force that is left out.

    That evidence has the force in it already, so that what every rig has need not explain many times as much as the force.
    """
    return outcome.force is not None and plain(best.hypothesis.members[k].effect)


def plain(effect: Effect) -> bool:
    """Whether an effect is a usual law of the motion with a single number, which little else can be bent to."""
    return effect.side == "dynamics" and len(effect.parameters) == 1 and effect.rarity <= 0.0


def placed(member: Candidate) -> bool:
    """Whether an effect was chosen among many places: numbers of periods, frequencies, angles."""
    return scanned(member) or "phase" in member.effect.parameter_names


def special_case(outcome: Outcome, best: Fit, remains: Remains) -> Fit | None:
    """The set with a law replaced by a special case of it, where beside a remainder nothing establishes the more general one.

    What makes a law more general is then weighed as an effect of its own would be: its other numbers may have gone to whatever
    nobody has named.
    """
    if not remains.significant:
        return None
    limit = best.score + FAKED * _excess(outcome.study, best, remains)
    plainer = sorted(specialized(outcome.study, best), key=lambda f: f.score)
    return next((f for f in plainer if f.score < limit and not carries(outcome, best, f, AMPLY)), None)


def unparted(outcome: Outcome, best: Fit, k: int, remains: Remains) -> list[Candidate]:
    """Relatives of member ``k`` that beside a remainder might as well be the law, by what they leave and by what they predict.

    Likelihoods part laws as if nothing but noise were left; beside a remainder the best one may have taken up most of it.
    """
    if not remains.significant:
        return []
    study, member = outcome.study, best.hypothesis.members[k]
    relatives(study, best, k, len(study.fits) + MOST_UNPARTED)
    limit = best.score + FAKED * _excess(study, best, remains)
    likeliest = sorted(known_in_place_of(study, best, k), key=lambda pair: pair[1].score)[: 2 * MOST_UNPARTED]
    return [
        new
        for new, other in likeliest
        if related(member, new) and other.score < limit and not carries(outcome, best, other, AMPLY)
    ]
