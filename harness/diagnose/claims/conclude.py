"""From a search to what may be claimed: every effect must earn its place on data it was not fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.claims.constants import (
    AMPLE_GAIN_RATIO,
    BLIND_SIGMAS,
    CONTRARY_SIGMAS,
    CROWDED_PRICE_RATIO,
    CROWDED_SET,
    HELD_OUT_SIGMAS,
    INEXACT_LAW_SHARE,
    MOST_SETS_ASKED,
    PRACTICAL_SHARE,
    RINGING_SHARE,
    SURE_PROBABILITY,
    UNPROVEN_EVIDENCE,
    UNREPEATED_SHARE,
)
from harness.diagnose.claims.cut_short import LEFT, UNCRITICISED, UNJUDGED, UNSEARCHED, Reached
from harness.diagnose.claims.held_out_only import held_out_repeats, with_all
from harness.diagnose.claims.idle_members import without_idle
from harness.diagnose.claims.plain_laws import fit_ordinary, plain_laws
from harness.diagnose.claims.posterior import posterior
from harness.diagnose.claims.predictive_check import foretold, level, parts
from harness.diagnose.claims.rivals import beside_another, known_near, near, preferred
from harness.diagnose.criticism.check import Asked, left_by
from harness.diagnose.criticism.constants import CARRIES_RATIO, HELD_OUT_MISFIT_SIGMAS
from harness.diagnose.criticism.doubt import doubtful, doubtful_together
from harness.diagnose.criticism.held_out import a_force_as_well, carries, firm
from harness.diagnose.criticism.members import beside_force
from harness.diagnose.criticism.remainder import Remains, answers, asked_of, examine
from harness.diagnose.criticism.unparted import special_case, unparted
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linearisation import linearise
from harness.diagnose.problem.constants import ORDINARY_LAWS_SHARE, REMAINDER_SHARE, UNPARTED_EVIDENCE
from harness.diagnose.problem.deadline import Spared, Stage, TimeUp
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.constants.search import STRETCHED_CHANCE, VIBRATION_PRICE
from harness.diagnose.selection.constants.starts import FOLLOWED_FREQUENCY_RATIO
from harness.diagnose.selection.outcome import Outcome, heldout_z, judge, judged, trained, training_gain
from harness.diagnose.selection.rewrites.special_case import specialized
from harness.diagnose.selection.state_evidence import Evidence
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Claim:
    """One member of the best set, weighed. gain: of the training cost; heldout_z: see ``investigate.heldout_z``.

    delta_bic: how much worse the set is without it; rivals: candidates that could stand in its place; beside: keys of what other
    members would then have to be, of rivals that only could so; probability, of_class: posterior over all sets fitted that it is
    there, and that it or a rival is.
    """

    candidate: Candidate
    index: int
    gain: float
    heldout_z: float
    delta_bic: float
    rivals: tuple[str, ...]
    rival_candidates: tuple[Candidate, ...]
    beside: Mapping[str, tuple[str, ...]]
    probability: float
    of_class: float


@dataclass(frozen=True, eq=False)
class Conclusion:
    """Verdict and what supports it.

    best: the fit claimed, on all recordings; own: on the training ones; held: judged on the data held out. level: what is left of
    those over the noise [1]. unproven: keys of what is doubted because nothing that it was not fitted to bears it out. only_held:
    keys of what shows in the data held out alone; ``own`` and ``held`` are then of the fit to all recordings. by_free_runs:
    whether it is told for its free runs alone, although beside a force over the state other sets are likelier. loosely:
    whether the data held out are noise only about what the training recordings leave likely, and not about the likeliest
    numbers. cut_short: what the time was up for, of ``UNSEARCHED``, ``UNJUDGED`` and ``UNCRITICISED``, and therefore is not
    claimed; or empty. hurried: whether it was up for any of the search or of what follows it.
    """

    verdict: str
    best: Fit
    own: Fit
    held: Fit
    claims: tuple[Claim, ...]
    remains: Remains
    doubted: tuple[str, ...]
    level: float
    unproven: tuple[str, ...] = ()
    only_held: tuple[str, ...] = ()
    cut_short: str = ""
    hurried: bool = False
    by_free_runs: bool = False
    loosely: bool = False

    @property
    def imitated(self) -> tuple[str, ...]:
        """Keys of what is doubted because something that nobody has named could have done its work."""
        return tuple(key for key in self.doubted if key not in self.unproven)


def _passes(outcome: Outcome, fitted: Fit) -> tuple[bool, int]:
    """Whether every member earns its place; and the member that fails most clearly (−1 if none)."""
    study = outcome.study
    worst, worst_value = -1, np.inf
    for k, member in enumerate(fitted.hypothesis.members):
        smaller = study.below(fitted, k)
        gain = smaller.score - fitted.score
        price = _price(study, smaller, fitted, k)
        straightens = _straightens(outcome, smaller, fitted, member)
        # No law that is inexact bends a nominal quantity so far.
        inexact = 0.0 if straightens else (INEXACT_LAW_SHARE * _strongest_beside(outcome, fitted, k)) ** 2
        enough = gain > max(price, inexact)
        visible = gain > PRACTICAL_SHARE**2 * study.samples
        z = heldout_z(outcome, smaller, fitted) if enough and visible else -np.inf
        # What the nominal model had to be stretched beyond its tolerance to imitate cannot show on data held out: the
        # stretched model predicts them as well. The stretch itself is then the evidence.
        needed = HELD_OUT_SIGMAS
        if enough and visible and straightens:
            needed = -HELD_OUT_MISFIT_SIGMAS
        elif enough and visible and gain > AMPLE_GAIN_RATIO * price:
            needed = min(needed, _contrary(outcome, smaller, fitted))
        # What only the data held out ask for has been fitted to them, and must be confirmed within them.
        repeated = z > needed and (
            _in_training(outcome, smaller, fitted, price)
            or (gain > AMPLE_GAIN_RATIO * price and held_out_repeats(outcome, smaller, fitted, price))
        )
        if not repeated and min(z, gain / 100.0) < worst_value:
            worst, worst_value = k, min(z, gain / 100.0)
    return worst < 0, worst


def _price(study: Study, smaller: Fit, fitted: Fit, k: int) -> float:
    """What member ``k`` has to gain: its numbers, the vibrations it begins, and more where many are told together."""
    begun = max(fitted.vibrating - smaller.vibrating, 0.0)
    price = study.price(fitted.hypothesis.members[k], len(fitted.hypothesis.members) - 1) + VIBRATION_PRICE * begun
    return price * CROWDED_PRICE_RATIO if fitted.hypothesis.things >= CROWDED_SET else price


def _in_training(outcome: Outcome, smaller: Fit, larger: Fit, price: float) -> bool:
    """Whether the training data speak for the larger set by themselves."""
    return training_gain(outcome, smaller, larger) > min(price, UNREPEATED_SHARE * (smaller.score - larger.score))


def _strongest_beside(outcome: Outcome, fitted: Fit, k: int) -> float:
    """What the strongest other member explains by itself [noise standard deviations]."""
    nothing = outcome.study.empty().score
    others = (j for j in range(len(fitted.hypothesis.members)) if j != k)
    explained = [nothing - outcome.study.alone(fitted, j).score for j in others]
    return float(np.sqrt(max([0.0, *explained])))


def _contrary(outcome: Outcome, smaller: Fit, larger: Fit) -> float:
    """The ``heldout_z`` below which data held out speak against the larger set; infinite if they must speak for it.

    Predictions D² apart (in units of the noise) gain D² ± 2 D if the larger set is right. Where D is small, as for a stop that the
    motion held out does not reach, those data cannot confirm it; they can only contradict.
    """
    one, other = judge(outcome, smaller), judge(outcome, larger)
    pairs = zip(one.linear.residuals, other.linear.residuals, strict=True)
    apart = float(np.sqrt(sum(float(np.sum((a - b) ** 2)) for a, b in pairs)))
    if apart > BLIND_SIGMAS:
        return np.inf
    least = apart**2 - 2.0 * CONTRARY_SIGMAS * apart
    return float(np.sign(least) * np.sqrt(abs(least)))


def _straightens(outcome: Outcome, smaller: Fit, larger: Fit, member: Candidate) -> bool:
    """Whether the nominal model would have to leave its tolerance to do without a member, beside what is left unexplained."""
    study = outcome.study
    chance = float(chi2.sf(max(smaller.prior - larger.prior, 0.0) / study.loudness(larger), member.size))
    return chance * len(study.candidates) < STRETCHED_CHANCE


def settle(outcome: Outcome, best: Fit) -> Fit:
    """The best set all of whose members earn their place: the first such near the top, or the best one pruned."""
    study = outcome.study
    good, worst = _passes(outcome, best)
    if good:
        return best
    near = [f for f in outcome.ordered if study.criterion(f) < study.criterion(best) + UNPARTED_EVIDENCE][
        :MOST_SETS_ASKED
    ]
    for fitted in near:
        if fitted is not best and _passes(outcome, fitted)[0]:
            return fitted
    fitted = best
    while not good:
        fitted = study.reduce(fitted, worst)
        good, worst = _passes(outcome, fitted)
    return fitted


def _pays(study: Study, best: Fit, k: int) -> bool:
    """Whether member ``k`` gains more than its price beside the others."""
    member = best.hypothesis.members[k]
    return study.below(best, k).score - best.score > study.price(member, len(best.hypothesis.members) - 1)


def conclude(outcome: Outcome) -> Conclusion:
    """Weigh what the search found and judge it on the data held out; what is doubted is left out, and the rest weighed again.

    Where the time is up, what has been reached: never a firmer verdict than the work that was done.
    """
    deadline, reached = outcome.predictor.deadline, Reached(outcome.best)
    unsearched = bool(deadline.not_tried)
    try:
        found = _concluded(outcome, reached)
    except TimeUp:
        with deadline.spared(Spared.TO_ITS_END):
            found = _as_far_as(outcome, reached)
    if unsearched and found.verdict == "consistent":
        found = replace(found, verdict="unexplained", cut_short=UNSEARCHED)
    return replace(found, hurried=unsearched or bool(found.cut_short))


def _as_far_as(outcome: Outcome, reached: Reached) -> Conclusion:
    """The conclusion that the work done so far allows."""
    deadline, best = outcome.predictor.deadline, reached.settled
    if best is None:
        deadline.leave(*LEFT[UNJUDGED])
        own, held = _so_far(outcome, reached.wanted)
        nothing = Remains(False, (), 0.0)
        return Conclusion(
            "unexplained", reached.wanted, own, held, (), nothing, (), level(outcome, held), cut_short=UNJUDGED
        )
    deadline.leave(*LEFT["told" if reached.criticised else UNCRITICISED])
    if not reached.by_free_runs:
        best = without_idle(outcome, best)
    claims = _claims(outcome, best, None)
    firm = reached.criticised and not reached.incomplete
    without, with_ = ("consistent", "explained") if firm else ("unexplained", "partly_explained")
    own, held = _so_far(outcome, best, by_free_runs=reached.by_free_runs)
    remains = reached.remains or Remains(False, (), 0.0)
    return Conclusion(
        with_ if claims else without, best, own, held, claims, remains, reached.doubted, level(outcome, held),
        cut_short="" if reached.criticised else UNCRITICISED, by_free_runs=reached.by_free_runs,
    )  # fmt: skip


def _so_far(outcome: Outcome, best: Fit, *, by_free_runs: bool = False) -> tuple[Fit, Fit]:
    """The set on the training data and on those held out, or in a pinch as it stands on all of them."""
    return outcome.predictor.deadline.attempt(
        *LEFT["errors"],
        lambda: _numbers(outcome, best, by_free_runs=by_free_runs), lambda: (best, best), spared=True,
    )  # fmt: skip


def _numbers(outcome: Outcome, best: Fit, *, by_free_runs: bool) -> tuple[Fit, Fit]:
    """The set on the training data, with the numbers that are told, and on those held out. by_free_runs: see ``Conclusion``."""
    own, evidence = trained(outcome, best), outcome.evidence
    if evidence is None or by_free_runs or not best.hypothesis.members:
        return own, judge(outcome, best)
    return _beside_the_force(outcome, evidence, own)


def _concluded(outcome: Outcome, reached: Reached) -> Conclusion:
    """The conclusion, with all that it takes."""
    study, deadline = outcome.study, outcome.predictor.deadline
    deadline.begin(Stage.RIVALS)
    wanted = deadline.attempt(
        *LEFT["rivals"],
        # Beside a force over the state sets have been weighed with it; under noise alone the most bent one would do best.
        lambda: preferred(outcome, outcome.best) if outcome.evidence is None else outcome.best,
        lambda: min(study.fits.values(), key=study.criterion, default=outcome.best),
    )
    deadline.begin(Stage.CRITICISM)
    reached.wanted = wanted
    if outcome.evidence is None:
        best, remains, incomplete, doubted, unproven = _criticised(outcome, wanted, reached)
    else:
        # What else may have made it, a force that nobody has named above all, is in that evidence, and so are the data held out.
        best, doubted, unproven = without_idle(outcome, outcome.reweigh(wanted)), (), ()
        reached.settled = best
        if best.hypothesis.members:
            # Kept for what is told, and worked out while there is time.
            outcome.evidence.beside(outcome.training, trained(outcome, best))
        remains, incomplete = _remains_beside(outcome, best)
    # A force that is left out is a remainder, whatever the tests beside it say.
    incomplete = incomplete or bool(doubted) or outcome.force is not None
    reached.settled, reached.remains, reached.incomplete, reached.criticised = best, remains, incomplete, True
    instead = None
    if outcome.evidence is None:
        claims = _claims(outcome, best, remains)
    else:
        # Where the time may be up among rivals, what free runs say comes before them.
        claims = _claims(outcome, best, None if deadline.limited else remains)
        deadline.attempt(
            *LEFT["ordinary"], lambda: fit_ordinary(outcome.study, best), lambda: None, share=ORDINARY_LAWS_SHARE
        )
        instead = plain_laws(outcome, best, sure=_beyond_doubt(outcome, best, claims))
        if instead is not None:
            best = outcome.reweigh(instead)
            remains, _ = _remains_beside(outcome, best)
            reached.settled, reached.remains, reached.by_free_runs = best, remains, True
        if instead is not None or deadline.limited:
            claims = _claims(outcome, best, remains)
    without, with_ = ("unexplained", "partly_explained") if incomplete else ("consistent", "explained")
    only: tuple[str, ...] = ()
    if outcome.evidence is None:
        only = tuple(c.candidate.key for c in claims if not _told_by_training(outcome, best, c.index))
    own, held = with_all(outcome, best) if only else _numbers(outcome, best, by_free_runs=instead is not None)
    return Conclusion(
        with_ if claims else without, best, own, held, claims, remains, doubted, level(outcome, held), unproven, only,
        by_free_runs=instead is not None, loosely=not incomplete and not only and parts(outcome, held),
    )  # fmt: skip


def _beyond_doubt(outcome: Outcome, best: Fit, claims: Sequence[Claim]) -> bool:
    """Whether the evidence beside a force speaks for any member of a set beyond doubt, and its free runs do not gainsay that."""
    if not any(claim.of_class >= SURE_PROBABILITY for claim in claims):
        return False
    _, held = _numbers(outcome, best, by_free_runs=False)
    return held.cost < judge(outcome, outcome.empty).cost


def _remains_beside(outcome: Outcome, best: Fit) -> tuple[Remains, bool]:
    """What a set leaves beside a force that is left out, and that it is more than noise: that much is known without any test."""
    return outcome.predictor.deadline.within(
        REMAINDER_SHARE, *LEFT["remains"],
        lambda: _remains(outcome, best), lambda: (Remains(True, (), best.linear.cost), True),
    )  # fmt: skip


def _criticised(
    outcome: Outcome, wanted: Fit, reached: Reached
) -> tuple[Fit, Remains, bool, tuple[str, ...], tuple[str, ...]]:
    """Of a set under noise alone what stands, what that leaves, whether it is more than noise, and keys of what is doubted; the
    latter again as far as nothing but what it was fitted to bears it out."""
    study = outcome.study
    best = reached.settled = settle(outcome, wanted)
    doubted: list[str] = []
    if study.criterion(best) - study.criterion(wanted) > UNPROVEN_EVIDENCE:
        # What training speaks for beyond doubt and the data held out do not bear out is no finding, but nothing is well either.
        doubted += [key for key in wanted.hypothesis.keys if key not in best.hypothesis.keys]
    unproven = reached.doubted = tuple(doubted)
    best = reached.settled = outcome.reweigh(best)
    study = outcome.study
    remains, incomplete = _remains(outcome, best)
    shaky = [key for k, key in enumerate(best.hypothesis.keys) if doubtful(outcome, best, k, remains)]
    together = doubtful_together(outcome, best, remains)
    while True:
        if shaky or together:
            best, fresh = _without_doubtful(outcome, best, shaky, together)
            doubted += fresh
            reached.doubted, reached.settled = tuple(doubted), best
            best = outcome.reweigh(best)
            study = outcome.study
            # What made a law more general may have been left out with the doubtful.
            best = min([best, *specialized(study, best)], key=study.criterion)
        else:
            special = special_case(outcome, best, remains)
            if special is None:
                return best, remains, incomplete, tuple(doubted), unproven
            best = outcome.reweigh(special)
            study = outcome.study
        # What has leant on the doubtful must stand without it, beside all that is left then.
        remains, incomplete = _remains(outcome, best)
        shaky = [key for k, key in enumerate(best.hypothesis.keys) if not _stands(outcome, best, k, remains)]
        together = []


def _beside_the_force(outcome: Outcome, evidence: Evidence, own: Fit) -> tuple[Fit, Fit]:
    """A set with its numbers where they and the force that it leaves out are likeliest by the training recordings, and held out."""
    training = outcome.training
    x = evidence.beside(training, own).x
    objective, frozen = training.objective(own.hypothesis), np.ones(len(x), dtype=bool)
    there = fit(objective, x, own.states, fixed=frozen, others=training.others(own.hypothesis))
    view = linearise(objective, x, there.states, upper=objective.bounds()[1], fixed=~own.free)
    return replace(there, free=own.free, linear=view), judged(outcome, own, there)


def _stands(outcome: Outcome, best: Fit, k: int, remains: Remains) -> bool:
    """Whether member ``k`` may still be claimed once others have been left out: what they explained is a remainder now."""
    if not _pays(outcome.study, best, k):
        return False
    if beside_force(outcome, best, k):
        return not doubtful(outcome, best, k, remains)
    if not carries(outcome, best, outcome.study.below(best, k), CARRIES_RATIO):
        return False
    return not a_force_as_well(outcome, best, k) and not doubtful(outcome, best, k, remains)


def _told_by_training(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether the training data speak for member ``k`` of the set by themselves."""
    smaller = outcome.study.below(best, k)
    return _in_training(outcome, smaller, best, _price(outcome.study, smaller, best, k))


def _left_out(outcome: Outcome, best: Fit, keys: list[str]) -> Fit:
    """The fit without some of its members."""
    while any(key in keys for key in best.hypothesis.keys):
        best = outcome.study.reduce(best, [key in keys for key in best.hypothesis.keys].index(True))
    return best


def _without_doubtful(outcome: Outcome, best: Fit, shaky: list[str], together: list[str]) -> tuple[Fit, list[str]]:
    """The fit without the doubtful, and what was left out.

    together: doubted together, and left out at once. shaky: doubted one by one; the weakest goes first, for beside one less that
    is doubtful another may be firm.
    """
    dropped = list(together)
    best = _left_out(outcome, best, together)
    left = [key for key in shaky if key not in together]
    while left:
        gains = {key: outcome.study.below(best, best.hypothesis.keys.index(key)).score - best.score for key in left}
        weakest = min(left, key=gains.__getitem__)
        dropped.append(weakest)
        best = _left_out(outcome, best, [weakest])
        left = [key for key in left if key != weakest and not firm(outcome, best, best.hypothesis.keys.index(key))]
    return best, dropped


def _remains(outcome: Outcome, best: Fit) -> tuple[Remains, bool]:
    """What a set of effects leaves, and whether that is more than noise anywhere."""
    left = left_by(outcome.study, best, outcome)
    remains = examine(left, Asked.OF_EVERY_FIT, Asked.OF_WHAT_IS_TOLD)
    if outcome.force is not None:
        # All of what is left is the model's own error, and any part of it may have been explained by a law that is not there.
        remains = replace(remains, significant=True, excess=max(remains.excess, best.linear.cost))
    if remains.significant:
        further = [test for _, test in answers(left, asked_of(Asked.BESIDE_A_REMAINDER))]
        remains = replace(remains, tests=(*remains.tests, *further))
    return remains, remains.significant or not foretold(outcome, best)


def _claims(outcome: Outcome, best: Fit, remains: Remains | None) -> tuple[Claim, ...]:
    """What is claimed of a set. remains: what it leaves; None to look for nothing further that could stand in a member's place."""
    study = outcome.study
    weighed = outcome.predictor.deadline.attempt(
        *LEFT["weighed"], lambda: posterior(outcome, best), lambda: posterior(outcome, best, at_hand=True)
    )
    claims = []
    for k, member in enumerate(best.hypothesis.members):
        smaller = study.below(best, k)
        gain = smaller.score - best.score
        alike = near(outcome, best, k) if remains is not None else known_near(outcome, best, k)
        others = [m for other in alike for m in other.hypothesis.members]
        others += unparted(outcome, best, k, remains) if remains is not None else []
        others = [m for m in others if m.key not in best.hypothesis.keys] + _out_of_step(study, best, k)
        others += [m for m in _adding_up(outcome, best, k) if m.key not in {other.key for other in others}]
        known = {m.key for m in others}
        further = {c: partners for c, partners in beside_another(outcome, best, k).items() if c.key not in known}
        rivals = list({m.key: m for m in [*others, *further]}.values())
        beside = {c.key: tuple(m.key for m in partners) for c, partners in further.items()}
        claims.append(
            Claim(
                member, k, gain, heldout_z(outcome, smaller, best), gain - study.numbers(member) * float(np.log(study.samples)),
                tuple(r.key for r in rivals), tuple(rivals), beside, weighed.of([member.key]),
                weighed.of([member.key, *(r.key for r in rivals)]),
            )
        )  # fmt: skip
    return tuple(claims)


def _out_of_step(study: Study, best: Fit, k: int) -> list[Candidate]:
    """What looks like member ``k`` if that is a wave with a phase of its own in every recording: a shaken base that nobody started
    with the recordings, as far as joints still follow one.

    The catalogue's has one phase for all of them, so no fit of it says this. Or something that rings by itself.
    """
    member = best.hypothesis.members[k]
    if not member.out_of_step:
        return []
    values = member.effect.named(study.predictor.effect_values(best.hypothesis, k, best.x))
    swing = member.references.frequency / (2.0 * np.pi)
    followed = values["frequency"] <= FOLLOWED_FREQUENCY_RATIO * swing
    without = study.below(best, k).score

    def alike(other: Candidate) -> bool:
        if not other.effect.adds_coordinates:
            return followed
        # What hardly dies away rings in every recording as it was released.
        rung = study.known(best.hypothesis.without(k).with_(other))
        return rung is not None and without - rung.score > RINGING_SHARE * (without - best.score)

    return [c for c in study.candidates if c.effect.name in member.effect.confusable_with and alike(c)]


def _adding_up(outcome: Outcome, best: Fit, k: int) -> list[Candidate]:
    """What adds up with member ``k`` to one number that alone shows: a late sensor after a late release, seen by that sensor alone.

    Any part of the waiting may be the sensor's, so that a set with both fits as well, and is never asked for.
    """
    member = best.hypothesis.members[k]
    sensor = member.effect.sensor
    if sensor is None or not (sensor.every_channel and sensor.at_first) or len(outcome.problem.channels) > 1:
        return []
    taken = best.hypothesis.keys
    return [c for c in outcome.study.candidates if c.effect.name == "sensor_delay" and c.key not in taken]
