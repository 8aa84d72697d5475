"""From a search to what may be claimed: every effect must earn its place on data it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from harness.diagnose.creep import creeps, motion_where_held
from harness.diagnose.event import event_as_well
from harness.diagnose.exchange import specialized
from harness.diagnose.fit import Fit, fit
from harness.diagnose.held_only import held_out_repeats, with_all
from harness.diagnose.hypothesis import Candidate
from harness.diagnose.investigate import Outcome, heldout_z, judge, judge_straight, trained, training_gain
from harness.diagnose.locate import rmse
from harness.diagnose.remainder import SETS_IN, Remains, Test, examine, jump, wandering
from harness.diagnose.rivals import APART, near, preferred
from harness.diagnose.screen import scanned
from harness.diagnose.starts import FOLLOWS
from harness.diagnose.stretches import by_channel, follows_itself
from harness.diagnose.study import BEGUN, STRETCHED, Study
from harness.diagnose.uncertainty import estimates
from harness.effects.effect import Family
from harness.effects.scale import references

Array = NDArray[np.float64]

INEXACT = 1e-3  # of what an effect does, to which its law may be wrong; less than that beside it is no effect
PRACTICAL = 0.05  # an effect must change the prediction by this share of the noise at least
HELD_OUT = 1.5  # standard deviations by which it must improve data held out
BLIND = (
    4.0  # noise standard deviations between predictions of data held out, up to which those cannot confirm an effect
)
# Share of what an effect explains, below which training says nothing of it, unless that pays its price. (A weak spring may show in
# the difference between amplitudes alone: tolerances leave half a hundredth of it to the training.)
UNREPEATED = 0.002
CONTRARY = 3.0  # standard deviations by which they then may fall short
AMPLE = 5.0  # times its price that such an effect must gain
MANY = 3  # members from which on a set may piece together what nobody has named,
CROWDED = 3.0  # so that each must gain so many times its price
FAKED = (
    10.0  # an effect must explain so many times what the remainder still holds, or the remainder might have faked it
)
NEEDED = (
    0.05  # share of what an effect explains that an unnamed force must leave, to which its linear response is trusted
)
CARRIES = (
    1.4  # times that the held-out free run's error grows without an effect that is claimed beside such a remainder
)
RUNG = 0.9  # share of what a wave explains, from which on something that rings may be it
AMPLY = 1.8  # times that it grows without an effect that is claimed whatever the data held out give by themselves
UNPROVEN = 30.0  # in the criterion, by which a set is better that does not stand on data held out
BETTER = 12.0  # in the criterion, by which an unnamed force must do better than an effect that explains all
STEADY, STEADY_FREQUENCY = 0.4, 0.03  # relative differences between separate recordings
STEADY_PHASE = 0.6  # rad
UNSURE = 3.0  # standard deviations that separate estimates may always be apart
WORSE = 5.0  # standard deviations by which data held out may be left worse than those fitted to
LEVEL = (
    1e-5  # chance at which a test of the remainder counts; all recordings are tested at once, a dozen questions each
)
AT_FLOOR = 1.2  # held-out residual over the noise floor up to which a model counts as complete


@dataclass(frozen=True, eq=False)
class Claim:
    """One member of the best set, weighed. gain: of the training cost; heldout_z: see ``investigate.heldout_z``.

    delta_bic: how much worse the set is without it; rivals: candidates that could stand in its place; probability: its share
    of the posterior over all sets fitted.
    """

    candidate: Candidate
    index: int
    gain: float
    heldout_z: float
    delta_bic: float
    rivals: tuple[str, ...]
    rival_candidates: tuple[Candidate, ...]
    probability: float


@dataclass(frozen=True, eq=False)
class Conclusion:
    """Verdict and what supports it.

    best: the fit claimed, on all recordings; own: on the training ones; held: judged on the data held out. level: what is left of
    those over the noise [1]. unproven: keys of what is doubted because nothing that it was not fitted to bears it out. only_held:
    keys of what shows in the data held out alone; ``own`` and ``held`` are then of the fit to all recordings.
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
        inexact = 0.0 if straightens else (INEXACT * _strongest_beside(outcome, fitted, k)) ** 2
        enough = gain > max(price, inexact)
        visible = gain > PRACTICAL**2 * study.samples
        z = heldout_z(outcome, smaller, fitted) if enough and visible else -np.inf
        # What the nominal model had to be stretched beyond its tolerance to imitate cannot show on data held out: the
        # stretched model predicts them as well. The stretch itself is then the evidence.
        needed = HELD_OUT
        if enough and visible and straightens:
            needed = -WORSE
        elif enough and visible and gain > AMPLE * price:
            needed = min(needed, _contrary(outcome, smaller, fitted))
        # What only the data held out ask for has been fitted to them, and must be confirmed within them.
        repeated = z > needed and (
            _in_training(outcome, smaller, fitted, price)
            or (gain > AMPLE * price and held_out_repeats(outcome, smaller, fitted, price))
        )
        if not repeated and min(z, gain / 100.0) < worst_value:
            worst, worst_value = k, min(z, gain / 100.0)
    return worst < 0, worst


def _price(study: Study, smaller: Fit, fitted: Fit, k: int) -> float:
    """What member ``k`` has to gain: its numbers, the vibrations it begins, and more where many are told together."""
    begun = max(fitted.vibrating - smaller.vibrating, 0.0)
    price = study.price(fitted.hypothesis.members[k], len(fitted.hypothesis.members) - 1) + BEGUN * begun
    return price * CROWDED if fitted.hypothesis.things >= MANY else price


def _in_training(outcome: Outcome, smaller: Fit, larger: Fit, price: float) -> bool:
    """Whether the training data speak for the larger set by themselves."""
    return training_gain(outcome, smaller, larger) > min(price, UNREPEATED * (smaller.score - larger.score))


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
    if apart > BLIND:
        return np.inf
    least = apart**2 - 2.0 * CONTRARY * apart
    return float(np.sign(least) * np.sqrt(abs(least)))


def _straightens(outcome: Outcome, smaller: Fit, larger: Fit, member: Candidate) -> bool:
    """Whether the nominal model would have to leave its tolerance to do without a member, beside what is left unexplained."""
    study = outcome.study
    chance = float(chi2.sf(max(smaller.prior - larger.prior, 0.0) / study.loudness(larger), member.size))
    return chance * len(study.candidates) < STRETCHED


def settle(outcome: Outcome, best: Fit) -> Fit:
    """The best set all of whose members earn their place: the first such near the top, or the best one pruned."""
    study = outcome.study
    good, worst = _passes(outcome, best)
    if good:
        return best
    near = [f for f in outcome.ordered if study.criterion(f) < study.criterion(best) + APART][:6]
    for fitted in near:
        if fitted is not best and _passes(outcome, fitted)[0]:
            return fitted
    fitted = best
    while not good:
        fitted = study.reduce(fitted, worst)
        good, worst = _passes(outcome, fitted)
    return fitted


def _probabilities(outcome: Outcome) -> dict[str, float]:
    """Posterior probability of every effect, summed over the sets fitted."""
    fits = list(outcome.study.fits.values())
    values = np.array([outcome.study.criterion(f) for f in fits])
    weights = np.exp(-0.5 * (values - values.min()))
    weights /= weights.sum()
    out: dict[str, float] = {}
    for f, w in zip(fits, weights, strict=True):
        for key in f.hypothesis.keys:
            out[key] = out.get(key, 0.0) + float(w)
    return out


def _imitated(outcome: Outcome, best: Fit, smaller: Fit, margin: float = 0.0, *, exact: bool = False) -> bool:
    """Whether a force, or jump or course of a reading, that nobody has named does better by ``margin`` than what a member does.

    exact: ask only for what brings what it promises.
    """
    study = outcome.study
    tests: list[Test] | tuple[Test, ...]
    if exact:
        tests = [jump(outcome.predictor, study.likelihood, smaller)]
        tests += wandering(outcome.predictor, study.likelihood, smaller, outcome.period)
    else:
        tests = _examined(outcome, smaller).tests
    # A friction or drag that sets in soon after the start is hardly another thing than one that always acts.
    lasting = any(
        m.effect.family is Family.DISSIPATION for m in best.hypothesis.members if m.key not in smaller.hypothesis.keys
    )
    named = [t for t in tests if t.places >= 0 and not (lasting and t.name.startswith(SETS_IN))]

    own = smaller.score - best.score
    there = max(smaller.score - study.samples, own)

    def worth(gain: float, exact: bool) -> float:
        # A linear gain that promises more than there is says only that it might do as well.
        return gain if exact or gain < there else own

    prices = [worth(t.gain, t.exact) - t.price(study.samples) for t in named]
    prices += [worth(t.together[0], t.exact) - t.price_together(study.samples) for t in named]
    return bool(study.criterion(smaller) - max(prices, default=0.0) < study.criterion(best) - margin)


def _imitated_together(outcome: Outcome, best: Fit, remains: Remains) -> list[str]:
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
            if _imitated(outcome, best, smaller, BETTER, exact=remains.significant):
                found += [key for key in keys if key not in found]
    return found


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


def _stretched(outcome: Outcome, best: Fit) -> Test | None:
    """A test that counts if the nominal quantities had to leave their stated tolerance to fit, which is a remainder too."""
    z = best.x[: len(outcome.predictor.nominal)]
    if not outcome.study.stretched(best):
        return None
    chance = float(chi2.sf(best.prior, max(len(z), 1)))
    worst = int(np.argmax(np.abs(z)))
    quantity = outcome.predictor.nominal[worst]
    where = f"{quantity.kind} of {quantity.name} by {z[worst]:+.1f} of its σ"
    return Test("nominal quantities outside their tolerance", best.prior, len(z), chance, where=(where,), places=-1)


def _pays(study: Study, best: Fit, k: int) -> bool:
    """Whether member ``k`` gains more than its price beside the others."""
    member = best.hypothesis.members[k]
    return study.below(best, k).score - best.score > study.price(member, len(best.hypothesis.members) - 1)


def _carries(outcome: Outcome, best: Fit, smaller: Fit, times: float) -> bool:
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


def _does_not_carry_over(outcome: Outcome, best: Fit) -> Test | None:
    """A test that counts if no one set of parameters fits the training data and those held out as well as each would allow.

    Under the right model the cost that the data held out add is chi-squared with as many degrees of freedom as they have samples
    (Chow, Econometrica 28 (1960) 591), however loosely the training data alone pin the parameters.
    """
    likelihood = outcome.study.likelihood
    judged = likelihood.samples(outcome.held_windows)
    own = trained(outcome, best)
    fitted = likelihood.samples(own.windows)
    if min(fitted, judged) < 2.0:
        return None
    level = max(own.linear.cost / fitted, likelihood.rounded)
    added = best.score - own.score
    rise = float(np.log(max(added, 1e-300) / judged / level))
    z = rise / float(np.sqrt(2.0 / fitted + 2.0 / judged))
    if z < WORSE:
        return None
    # Noise may be louder there, and is no misfit as long as its samples do not follow one another.
    chance = max(float(norm.sf(z)), follows_itself(by_channel(best, outcome.held_windows)))
    if chance >= LEVEL:
        return None
    where = f"mean square {np.exp(rise):.2f} times that of the training data"
    return Test("a worse fit of the data held out", added - judged * level, 1, chance, (where,), -1)


def conclude(outcome: Outcome) -> Conclusion:
    """Weigh what the search found and judge it on the data held out; what is doubted is left out, and the rest weighed again."""
    study = outcome.study
    wanted = preferred(outcome, outcome.best)
    best = settle(outcome, wanted)
    doubted: list[str] = []
    if study.criterion(best) - study.criterion(wanted) > UNPROVEN:
        # What training speaks for beyond doubt and the data held out do not bear out is no finding, but nothing is well either.
        doubted += [key for key in wanted.hypothesis.keys if key not in best.hypothesis.keys]
    unproven = tuple(doubted)
    remains, incomplete = _remains(outcome, best)
    shaky = [key for k, key in enumerate(best.hypothesis.keys) if _doubtful(outcome, best, k, remains)]
    together = _imitated_together(outcome, best, remains)
    if shaky or together:
        best, fresh = _without_doubtful(outcome, best, shaky, together)
        while fresh:
            doubted += fresh
            # What has leant on the doubtful must stand without it.
            fresh = [
                key
                for k, key in enumerate(best.hypothesis.keys)
                if not _pays(study, best, k)
                or not _carries(outcome, best, study.below(best, k), CARRIES)
                or _a_force_as_well(outcome, best, k)
            ]
            best = _left_out(outcome, best, fresh)
        # What made a law more general may have been left out with the doubtful.
        best = min([best, *specialized(study, best)], key=study.criterion)
        remains, incomplete = _remains(outcome, best)
    incomplete = incomplete or bool(doubted)
    claims = _claims(outcome, best)
    without, with_ = ("unexplained", "partly_explained") if incomplete else ("consistent", "explained")
    verdict = with_ if claims else without
    only = tuple(c.candidate.key for c in claims if not _told_by_training(outcome, best, c.index))
    own, held = with_all(outcome, best) if only else (trained(outcome, best), judge(outcome, best))
    return Conclusion(verdict, best, own, held, claims, remains, tuple(doubted), _level(outcome, held), unproven, only)


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
        left = [key for key in left if key != weakest and not _firm(outcome, best, best.hypothesis.keys.index(key))]
    return best, dropped


def _examined(outcome: Outcome, fitted: Fit) -> Remains:
    """The tests of what a fit leaves, at every joint."""
    system = outcome.problem.system
    torques = [references(system, joint).torque for joint in system.joint_names]
    likelihood = outcome.study.likelihood
    return examine(outcome.predictor, likelihood, fitted, system.joint_names, torques, outcome.period, LEVEL)


def _remains(outcome: Outcome, best: Fit) -> tuple[Remains, bool]:
    """What a set of effects leaves, and whether that is more than noise anywhere."""
    held = judge(outcome, best)
    remains = _examined(outcome, best)
    bent = _stretched(outcome, best)
    if bent is not None:
        # What bends the model so far could as well make what is weaker than that.
        remains = replace(remains, excess=max(remains.excess, bent.gain))
    for test in (bent, _does_not_carry_over(outcome, best)):
        if test is not None:
            remains = replace(remains, significant=True, tests=(*remains.tests, test))
    crept = motion_where_held(outcome, best) if remains.significant else None
    if crept is not None:
        remains = replace(remains, tests=(*remains.tests, crept))
    # Held-out noise may be louder than elsewhere; it is a misfit if its samples follow one another.
    floor = AT_FLOOR * np.sqrt(outcome.study.likelihood.rounded)
    above = _level(outcome, held) > floor and follows_itself(by_channel(held, held.windows)) < LEVEL
    return remains, remains.significant or above


def _level(outcome: Outcome, held: Fit) -> float:
    """What is left of the data held out, over the noise [1]."""
    return float(np.sqrt(held.cost / max(outcome.study.likelihood.samples(outcome.held_windows), 1.0)))


def _doubtful(outcome: Outcome, best: Fit, k: int, remains: Remains) -> bool:
    """Whether member ``k`` may only stand in for something that nobody has named."""
    study = outcome.study
    smaller = study.below(best, k)
    if _nowhere(outcome, best, k) or creeps(outcome, best, k):
        return True
    if _shakes(best.hypothesis.members[k]) and event_as_well(outcome, best, smaller):
        return True
    if not remains.significant:
        return _imitated(outcome, best, smaller, BETTER)
    everywhere = float(np.sqrt(best.linear.cost / max(study.samples, 1.0)))
    excess = max(remains.excess, (everywhere**2 - AT_FLOOR**2) * study.samples)
    if smaller.score - best.score >= FAKED * excess and not _imitated(outcome, best, smaller):
        return False
    return not _firm(outcome, best, k)


def _nowhere(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` acts from a place on, and which side of the middle that is on is not known: it is then no stop."""
    parameter = next(iter(best.hypothesis.members[k].effect.parameters), None)
    if parameter is None or parameter.search != "range" or parameter.lower >= 0.0:
        return False
    place = estimates(outcome.predictor, best, k)[parameter.name]
    return place.low <= 0.0 <= place.high


def _a_force_as_well(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether what member ``k``, of a sensor or of a drive, explains is also explained by a force that nobody has named.

    The force may act on both sides of the comparison, so that what it explains of a remainder says nothing about the member.
    """
    if best.hypothesis.members[k].effect.side == "dynamics":
        return False
    study = outcome.study
    smaller = study.below(best, k)

    def left(fitted: Fit) -> dict[tuple[str, str], float]:
        there = max(fitted.score - study.samples, 0.0)
        forces = (t for t in _examined(outcome, fitted).tests if t.places == 0 and not t.exact)
        return {(t.name, t.where[0]): max(there - t.gain, 0.0) for t in forces}

    without, with_ = left(smaller), left(best)
    least = NEEDED * (smaller.score - best.score)
    return any(without[key] < max(FAKED * with_[key], least) for key in without.keys() & with_.keys())


def _shakes(member: Candidate) -> bool:
    """Whether an effect is a force that comes and goes steadily with time, whatever the motion."""
    return member.effect.side == "dynamics" and {"frequency", "phase"} <= set(member.effect.parameter_names)


def _placed(member: Candidate) -> bool:
    """Whether an effect was chosen among many places: numbers of periods, frequencies, angles."""
    return scanned(member) or "phase" in member.effect.parameter_names


def _firm(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether predictions of data held out need member ``k``, amply, or else at the size that those data give by themselves.

    Never of a force or error that could be put at many places: one of them always fits some of what something else makes, and
    recordings of one rig repeat that. Nor of what a sensor or drive does if a force might do it: not even the side is then known.
    """
    if _nowhere(outcome, best, k) or _placed(best.hypothesis.members[k]) or _a_force_as_well(outcome, best, k):
        return False
    smaller = outcome.study.below(best, k)
    if _carries(outcome, best, smaller, AMPLY):
        return True
    return _carries(outcome, best, smaller, CARRIES) and _steady(outcome, trained(outcome, best), k)


def _claims(outcome: Outcome, best: Fit) -> tuple[Claim, ...]:
    study = outcome.study
    probabilities = _probabilities(outcome)
    claims = []
    for k, member in enumerate(best.hypothesis.members):
        smaller = study.below(best, k)
        gain = smaller.score - best.score
        others = [m for other in near(outcome, best, k) for m in other.hypothesis.members]
        others = [m for m in others if m.key not in best.hypothesis.keys] + _out_of_step(study, best, k)
        rivals = list({m.key: m for m in others}.values())
        claims.append(
            Claim(
                member, k, gain, heldout_z(outcome, smaller, best), gain - study.numbers(member) * float(np.log(study.samples)),
                tuple(r.key for r in rivals), tuple(rivals), min(1.0, probabilities.get(member.key, 0.0)),
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
    followed = values["frequency"] <= FOLLOWS * swing
    without = study.below(best, k).score

    def alike(other: Candidate) -> bool:
        if not other.effect.adds_coordinates:
            return followed
        # What hardly dies away rings in every recording as it was released.
        rung = study.known(best.hypothesis.without(k).with_(other))
        return rung is not None and without - rung.score > RUNG * (without - best.score)

    return [c for c in study.candidates if c.effect.name in member.effect.confusable_with and alike(c)]
