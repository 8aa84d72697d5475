"""How firmly a finding stands, and how its numbers repeat from recording to recording."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.claims.averaged import of_other_sets
from harness.diagnose.claims.conclude import Claim, Conclusion
from harness.diagnose.claims.constants import (
    BEYOND_BELIEF_RATIO,
    MANY_WAVES,
    MANY_WAVES_RATIO,
    PLAIN_LAW_RATIO,
    SURE_PROBABILITY,
    UNASKED_BELIEF_RATIO,
    VAGUE_RATIO,
    WAVE_RATIO,
)
from harness.diagnose.criticism.constants import FAKED_RATIO
from harness.diagnose.criticism.remainder import above_floor, slower_than_scatter
from harness.diagnose.estimation.constants import FEWEST_CLUSTERS, NORMAL_95
from harness.diagnose.estimation.discrepancy import responses
from harness.diagnose.estimation.dispersion import Dispersion, dispersion
from harness.diagnose.estimation.intervals import Estimate, scaled
from harness.diagnose.estimation.least_squares import Fit, covariance
from harness.diagnose.estimation.misfit import Misfit, sandwich
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.constants.weighing import FEWEST_WAVES
from harness.diagnose.selection.outcome import Outcome, judge
from harness.diagnose.selection.state_evidence import placed, waves_seen
from harness.effects.effect import Family, Parameter
from harness.effects.scale import pull

Array = NDArray[np.float64]

FIRMEST_FIRST = ESTABLISHED, LIKELY, POSSIBLE = "established", "likely", "possible"


@dataclass(frozen=True, eq=False)
class Repeated:
    """The fit of all recordings seen recording by recording, or stretch by stretch where there are too few of them.

    expected: by how much the force that is left out makes standard deviations larger than the curvature says, (P,); None where
    there is no such force. recordings: whether by recordings. beside: whether estimates are those beside a force over the state,
    and so as uncertain already.
    """

    fitted: Fit
    spread: Dispersion
    expected: Array | None
    recordings: bool
    beside: bool


def repeated(outcome: Outcome, conclusion: Conclusion) -> Repeated | None:
    """How the numbers of what is told spread, by the force that is left out and over the recordings; None where nothing can be
    said.
    """
    best, beside = conclusion.best, outcome.evidence is not None and not conclusion.by_free_runs
    names = [outcome.problem.runs[window.run].name for window in best.windows]
    by_recording = len(set(names)) >= FEWEST_CLUSTERS
    clusters: list[Any] = names if by_recording else list(range(len(names)))
    count = len(outcome.predictor.nominal)
    expected = _expected(outcome, best, count, beside=beside)
    found = dispersion(best, count, clusters, expected)
    return None if found is None else Repeated(best, found, expected, by_recording, beside)


def _expected(outcome: Outcome, best: Fit, count: int, *, beside: bool) -> Array | None:
    """Standard deviations that the force which is left out says, in units of the curvature's; None where there is none."""
    left = outcome.study.likelihood.discrepancy
    if not isinstance(left, Misfit):
        return None
    if beside and outcome.evidence is not None:
        by_curvature = np.zeros(len(best.x))
        by_curvature[best.free] = np.sqrt(np.diag(covariance(best, count))[best.free])
        spread = outcome.evidence.beside(outcome.study, best).spread
        return np.asarray(np.divide(spread, by_curvature, out=np.ones(len(best.x)), where=by_curvature > 0.0))
    found = responses(outcome.predictor, left.sensors, best, pull(outcome.problem.system), outcome.period)
    return None if found is None else sandwich(best, count, left, found)


def loosened(outcome: Outcome, how: Repeated | None, key: str, values: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Estimates as far apart as recordings of the rig are; as they are where noise is all that is left.

    Those that are averaged over sets beside a force (``averaged``) know of the force; others have it from here.
    """
    if how is None or outcome.force is None or key not in how.fitted.hypothesis.keys:
        return dict(values)
    factors = how.spread.factors
    if how.beside and how.expected is not None:
        factors = factors / how.expected
    factors = factors[_own(outcome, how.fitted, key)]
    member = how.fitted.hypothesis.members[how.fitted.hypothesis.keys.index(key)]
    pairs = zip(member.effect.parameters, factors, strict=True)
    return {p.name: scaled(values[p.name], float(factor), p.lower, p.upper) for p, factor in pairs}


def repeatability(outcome: Outcome, how: Repeated | None, key: str) -> list[dict[str, Any]]:
    """Every parameter of a finding as it is without one of the recordings, by the linear view of the fit."""
    if how is None or not how.recordings or key not in how.fitted.hypothesis.keys:
        return []
    rows = []
    k = how.fitted.hypothesis.keys.index(key)
    member, places = how.fitted.hypothesis.members[k], _own(outcome, how.fitted, key)
    for name, (x, std) in how.spread.without.items():
        values = [
            outcome.predictor.effect_values(how.fitted.hypothesis, k, x + sense * np.nan_to_num(std))
            for sense in (0.0, -NORMAL_95, NORMAL_95)
        ]
        parameters = {
            p.name: {"value": values[0][j], "ci95": sorted((values[1][j], values[2][j]))}
            for j, p in enumerate(member.effect.parameters)
            if np.isfinite(std[places][j])
        }
        rows.append({"recording": str(name), "left_out": True, "parameters": parameters})
    return rows


def grade(
    outcome: Outcome,
    conclusion: Conclusion,
    claim: Claim,
    values: Mapping[str, Estimate],
    rows: Sequence[Mapping[str, Any]],
    foretold: bool = True,
) -> str:
    """How firmly a claim stands.

    Where noise is all that is left: established; possible, if none of its numbers is known to a factor of ten (of two that only
    together do what the recordings ask for, neither is known to be there); where an error of a known shape is left, likely, or
    possible if it may as well be absent, is far larger than what it is named for ever is (a model that is far off bends
    whatever can be bent), or is a wave over the angle of which no more was seen than any smooth force looks like.

    Where the time was up before sets could be weighed beside the force that they leave out, possible, whatever they leave; or where
    free runs of what is told are no nearer to the data held out than those of the nominal model. Where it was up before all that
    could be in its place was asked, likely at most, and possible if it is far larger than usual, if nominal quantities are bent far
    outside their tolerance (something else is missing, and nobody has asked what), or if it explains less than the noise is (only
    the noise's colour tells it then, and that was not looked at).

    Told for its free runs alone: possible, where sets beside a force have its number elsewhere. Beside a force that is left out:
    possible, if sets without it and all that it cannot be told from are not much less likely (averaged over all; Hoeting et al.,
    Stat. Sci. 14 (1999) 382), if it was chosen among many places (one of them always fits some of what something else makes), if
    it may as well be absent, if it explains less than what is left (it may be part of that), or, being no plain law of a single
    number, not far more (it may be bent to what nobody has named), or if, being no friction, it is far larger than usual and does
    not explain nearly everything; likely, if one of those that it cannot be told from may be in its place, there are too few
    recordings to say whether it repeats, leaving one out takes it away, or its size is not known to a factor of ten; else
    established.

    values: its parameters; rows: see ``repeatability``; foretold: see ``foretells``.
    """
    firmest = LIKELY if conclusion.hurried else ESTABLISHED
    if conclusion.hurried and _unasked(outcome, conclusion, claim, values):
        return POSSIBLE
    unweighed = conclusion.hurried and outcome.evidence is None
    if unweighed and (
        outcome.force is not None
        or above_floor(conclusion.level, outcome.study.likelihood)
        or slower_than_scatter(outcome.study.likelihood)
    ):
        return POSSIBLE
    if outcome.force is None:
        if effect_says_not_what(claim.candidate, values):
            return POSSIBLE
        if not conclusion.remains.significant:
            return firmest
        unsure = beyond_belief(BEYOND_BELIEF_RATIO, claim.candidate, values) or may_be_absent(claim.candidate, values)
        return POSSIBLE if unsure or _any_smooth_force(outcome, conclusion, claim) else LIKELY
    if outcome.evidence is not None and (claim.of_class < SURE_PROBABILITY or not foretold):
        return POSSIBLE
    if (
        outcome.evidence is not None
        and conclusion.by_free_runs
        and not _at_that_size(outcome, conclusion, claim, values)
    ):
        return POSSIBLE
    itself = outcome.evidence is None or claim.probability >= SURE_PROBABILITY
    excess = conclusion.remains.excess
    whole = _is_a_wave(claim) and _seen_whole(outcome, conclusion, claim)
    found = beside_a_remainder(
        claim.candidate, values, rows, gain=claim.gain, excess=excess, itself=itself, whole=whole
    )
    return firmest if found == ESTABLISHED else found


def _unasked(outcome: Outcome, conclusion: Conclusion, claim: Claim, values: Mapping[str, Estimate]) -> bool:
    """Whether a claim would need what the time was up for: tests of what is left, and of what else it could be."""
    if beyond_belief(UNASKED_BELIEF_RATIO, claim.candidate, values):
        return True
    study, best = outcome.study, conclusion.best
    return outcome.force is None and (study.stretched(best) or claim.gain < best.cost)


def no_firmer_than_its_law(claims: Mapping[str, Claim], grades: Mapping[str, str]) -> dict[str, str]:
    """Grades by key, of what only says how another law acts no firmer than that law's: without it, it is nothing."""
    out = dict(grades)
    for key, claim in claims.items():
        member = claim.candidate
        laws = [f"{name}@{member.site}" for name in member.effect.modifies]
        out[key] = max([grades[key], *(grades[law] for law in laws if law in grades)], key=FIRMEST_FIRST.index)
    return out


def verdict_of(verdict: str, grades: Iterable[str]) -> str:
    """The verdict once findings are graded: nothing is partly explained by what is no more than possible."""
    return "unexplained" if verdict == "partly_explained" and all(grade == POSSIBLE for grade in grades) else verdict


def beside_a_remainder(
    member: Candidate,
    values: Mapping[str, Estimate],
    rows: Sequence[Mapping[str, Any]],
    *,
    gain: float,
    excess: float,
    itself: bool,
    whole: bool = False,
) -> str:
    """How firmly an effect stands where more than noise is left, by its own numbers.

    gain: what it explains (squares); excess: what is left beyond the noise, in the same unit; itself: whether nothing else may be
    in its place; whole: whether so much was seen of what was chosen among many places that no smooth force looks like it.
    """
    effect = member.effect
    if gain < (PLAIN_LAW_RATIO if effect.plain else FAKED_RATIO) * excess:
        return POSSIBLE
    if (placed(member) and not whole) or may_be_absent(member, values):
        return POSSIBLE
    rubs = effect.family is Family.DISSIPATION  # as much as it likes, of whatever gear is on a joint
    if not rubs and gain < WAVE_RATIO * excess and beyond_belief(UNASKED_BELIEF_RATIO, member, values):
        # A base askew by twenty degrees may stand for what nobody has named; where next to nothing is left, it is what it is.
        return POSSIBLE
    first = next(iter(effect.parameters), None)
    stands = [
        first is None
        or first.name not in row["parameters"]
        or not _holds(first.neutral, *row["parameters"][first.name]["ci95"])
        for row in rows
    ]
    unknown = first is not None and _vague(first, values[first.name])
    return ESTABLISHED if stands and all(stands) and not unknown and itself else LIKELY


def _any_smooth_force(outcome: Outcome, conclusion: Conclusion, claim: Claim) -> bool:
    """Whether a claim is a force over the angle of which no more was seen than any smooth force looks like."""
    force = claim.candidate.effect.law is not None
    return force and _is_a_wave(claim) and not _seen_whole(outcome, conclusion, claim)


def _is_a_wave(claim: Claim) -> bool:
    """Whether it is one over an angle."""
    return "periods" in claim.candidate.effect.parameter_names


def _seen_whole(outcome: Outcome, conclusion: Conclusion, claim: Claim) -> bool:
    """Whether more of it was seen than any smooth force looks like."""
    waves = waves_seen(outcome.study, conclusion.best, claim.index)
    return no_smooth_force(waves, claim.gain, conclusion.remains.excess)


def no_smooth_force(waves: float, gain: float, excess: float) -> bool:
    """Whether so many waves over an angle were seen, and explain so much of what there is, that no smooth force looks like them."""
    ratio = MANY_WAVES_RATIO if waves >= MANY_WAVES else WAVE_RATIO
    return waves >= FEWEST_WAVES and gain >= ratio * excess


def foretells(outcome: Outcome, conclusion: Conclusion) -> bool:
    """Whether free runs of what is told are nearer to the data held out than those of the nominal model within its tolerance."""
    return outcome.evidence is None or conclusion.held.cost < judge(outcome, outcome.empty).cost


def _at_that_size(outcome: Outcome, conclusion: Conclusion, claim: Claim, values: Mapping[str, Estimate]) -> bool:
    """Whether sets beside a force, too, have the first number of a claim that is told by free runs where its interval has it."""
    assert outcome.evidence is not None
    others = of_other_sets(outcome, outcome.evidence, conclusion.best, claim.index)
    if others is None:
        return True
    own = values[next(iter(claim.candidate.effect.parameters)).name]
    return own.low <= others[1] and others[0] <= own.high


def beyond_belief(ratio: float, member: Candidate, values: Mapping[str, Estimate]) -> bool:
    """Whether a number, at the near end of its interval, is more than so many times what it usually is."""
    for parameter in member.effect.parameters:
        usual = parameter.plausible
        if usual is None or not (usual.inverse or np.isfinite(parameter.neutral)):
            continue
        ends = np.array([values[parameter.name].low, values[parameter.name].high])
        with np.errstate(divide="ignore"):
            away = np.abs(1.0 / ends) if usual.inverse else np.abs(ends - parameter.neutral)
        if np.min(away) > ratio * usual.size(member.references):
            return True
    return False


def may_be_absent(member: Candidate, values: Mapping[str, Estimate]) -> bool:
    """Whether the interval of how strongly an effect acts holds that it does not."""
    first = next(iter(member.effect.parameters), None)
    return first is not None and _holds(first.neutral, values[first.name].low, values[first.name].high)


def effect_says_not_what(member: Candidate, values: Mapping[str, Estimate]) -> bool:
    """Whether none of an effect's numbers is known to a factor of ten: recordings say that something is there, not what."""
    return bool(values) and all(_vague(p, values[p.name]) for p in member.effect.parameters)


def _vague(parameter: Parameter, value: Estimate) -> bool:
    """Whether an interval reaches ten times as far from the effect's absence as the estimate is; of what is absent where it is
    infinite, as stiffness is, in reciprocals."""
    ends = np.array([value.low, value.high, value.value])
    if np.isinf(parameter.neutral):
        with np.errstate(divide="ignore"):
            away = np.abs(1.0 / ends)
    else:
        away = np.abs(ends - (parameter.neutral if np.isfinite(parameter.neutral) else 0.0))
    return bool(np.max(away[:2]) > VAGUE_RATIO * away[2])


def _holds(neutral: float, low: float, high: float) -> bool:
    return low <= neutral <= high


def _own(outcome: Outcome, fitted: Fit, key: str) -> slice:
    """Where a member's parameters stand in the vector."""
    span = fitted.hypothesis.span(fitted.hypothesis.keys.index(key))
    first = len(outcome.predictor.nominal)
    return slice(first + span.start, first + span.stop)
