"""What else it could be: effects that could stand in the place of a member, weighed on all recordings.

Odds of e⁵ part hypotheses; beyond, evidence is called very strong. A law of which a finding, or its rival, is a special case is
listed if it fits as well with the numbers that make the difference held at typical values. A set that takes back damping or
friction which the model states gives way to one that cannot be told from it, has fewer effects and leaves the model as it is.
What stands beside an effect is part of what its numbers mean: a soft base passes for a slow sensor, and beside it a friction that
the load makes may not be parted from plain damping although beside the sensor it is; such rivals say what would have to be true
with them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.claims.constants import (
    CROSSED_EVIDENCE,
    DEAR_RIVAL_PROMISE,
    FEW_MEMBERS,
    FEWEST_RIVALS_TOLD,
    HOPEFUL_LACK,
    MOST_CROSSED_RIVALS,
    MOST_GENERAL_RIVALS,
    MOST_PLACED_RIVALS,
    MOST_RIVAL_FITS,
    MOST_RIVALS,
    MOST_WIDENED_RIVALS,
    RIVAL_PROMISE,
    SHAKEN_RATIO,
)
from harness.diagnose.estimation.constants import LOST, RANKING_GAIN
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.constants import STRONG_EVIDENCE, UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, compatible, contains, dear
from harness.diagnose.selection.beam_search import exhausted, finished
from harness.diagnose.selection.cogging_periods import replaced
from harness.diagnose.selection.constants.search import CARRIED_STEPS, FAR_COST_RATIO, NEAR_EVIDENCE
from harness.diagnose.selection.constants.weighing import VALLEYS_EVIDENCE
from harness.diagnose.selection.exchange import Swap, exchanged, known_in_place_of, related, swaps
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.pruning import pruned
from harness.diagnose.selection.rewrite import Room, Turn
from harness.diagnose.selection.rewrites.catalogue import rewritten
from harness.diagnose.selection.rewrites.general_law import generalized
from harness.diagnose.selection.search_bounds import beyond_the_ends
from harness.diagnose.selection.starts import like
from harness.diagnose.selection.study import Study


def in_place_of(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Fits with member ``k`` replaced: by candidates whose score test promises a similar gain, by its relatives, and all known."""
    study = outcome.study
    if len(best.hypothesis.members) <= FEW_MEMBERS or not exhausted(study, best):
        _fit_in_place_of(study, best, k)
    known = [f for _, f in known_in_place_of(study, best, k)]
    # What is still under way along a narrow valley may come as near as any.
    return [f for f in finished(study, [best, *known]) if f.hypothesis.identity != best.hypothesis.identity]


def _fit_in_place_of(study: Study, best: Fit, k: int) -> None:
    """Fit what may stand in the place of member ``k``."""
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    own = without.score - best.score
    found = [f for _, own in rewritten(study, best, Turn.IN_PLACE, Room(MOST_RIVAL_FITS, member=k)) for f in own]
    for scored in study.ranked(without):
        if len(study.fits) >= MOST_RIVAL_FITS or len(found) >= MOST_RIVALS or scored.gain < RIVAL_PROMISE * own:
            break
        if dear(scored.candidate) and scored.gain < DEAR_RIVAL_PROMISE * own:
            continue
        if scored.candidate.key != member.key and not related(member, scored.candidate):
            found.append(study.extend(without, scored))
    # A general law in the place of another member helps only what comes near already.
    limit = min(best.score + HOPEFUL_LACK * max(own, 0.0), FAR_COST_RATIO * best.score)
    hopeful = sorted((f for f in found if f.score < limit and f is not best), key=lambda f: f.score)
    for base in (best, *hopeful[:MOST_WIDENED_RIVALS]):
        generalized(study, base)


def with_the_same(outcome: Outcome, best: Fit, key: str) -> list[Fit]:
    """Other sets that hold a member of the best one too and that are at least a twentieth as likely, sizes and all.

    Of a free decay no more than ratios are known: an arm a thousand times as heavy that rubs a thousand times as much fits as well.
    """
    study, limit = outcome.study, _limit(outcome, best, STRONG_EVIDENCE) + outcome.study.surprise(best)
    others = (f for identity, f in study.fits.items() if key in identity and identity != best.hypothesis.identity)
    return [f for f in others if f.score < LOST and study.evidence(f) + study.surprise(f) < limit]


def _limit(outcome: Outcome, best: Fit, apart: float) -> float:
    """The evidence of sets that are ``apart`` from the best one."""
    vibrates = any(m.effect.adds_coordinates for m in best.hypothesis.members)
    return outcome.study.evidence(best) + apart + (VALLEYS_EVIDENCE if vibrates else 0.0)


def near(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Rivals of member ``k`` that the recordings do not part from the best set, likeliest first."""
    study, limit = outcome.study, _limit(outcome, best, UNPARTED_EVIDENCE)
    found = sorted((f for f in in_place_of(outcome, best, k) if study.evidence(f) < limit), key=study.evidence)
    # Of what cannot be told apart, more general laws are not told either.
    in_place = [f for f in found if len(f.hypothesis.members) == len(best.hypothesis.members)]
    found += _instead_of_several(study, best, k) + _several_instead(study, best, k)
    for base in (best, *in_place[:MOST_GENERAL_RIVALS]):
        own = k if base is best else [key in best.hypothesis.keys for key in base.hypothesis.keys].index(False)
        known = {f.hypothesis.identity for f in found} | {best.hypothesis.identity}
        wider = (f for f in unseen(outcome, base, own) if f.score < best.score + UNPARTED_EVIDENCE)
        found += [f for f in wider if f.hypothesis.identity not in known]
    return found


def known_near(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """The same of what has been fitted anyhow."""
    study, limit = outcome.study, _limit(outcome, best, UNPARTED_EVIDENCE)
    found = [f for _, f in known_in_place_of(study, best, k) if f.score < LOST and study.evidence(f) < limit]
    return sorted(found, key=study.evidence) + _instead_of_several(study, best, k) + _several_instead(study, best, k)


def beside_another(outcome: Outcome, best: Fit, k: int) -> dict[Candidate, tuple[Candidate, ...]]:
    """Candidates that the recordings do not part from member ``k`` beside what another member could as well be, and beside what.

    What is told apart beside one of two effects that look alike need not be beside the other.
    """
    study, limit = outcome.study, _limit(outcome, best, UNPARTED_EVIDENCE)
    found: dict[Candidate, tuple[Candidate, ...]] = {}
    for swap in swaps(study, best):
        if swap.k == k or swap.fit.score >= LOST or study.evidence(swap.fit) > limit:
            continue
        own = swap.fit.hypothesis.keys.index(best.hypothesis.keys[k])
        for candidate, other in known_in_place_of(study, swap.fit, own):
            if other.score < LOST and study.evidence(other) < study.evidence(swap.fit) + UNPARTED_EVIDENCE:
                found[candidate] = (*found.get(candidate, ()), swap.candidate)
    return found


def _crossed(outcome: Outcome, best: Fit) -> list[Fit]:
    """Fits with a member exchanged beside what another one could as well be: see ``beside_another``."""
    study, limit = outcome.study, _limit(outcome, best, UNPARTED_EVIDENCE)
    if len(best.hypothesis.members) > FEW_MEMBERS and exhausted(study, best):
        return []
    every = [swap for swap in swaps(study, best) if swap.fit.score < LOST]
    aside = [swap for swap in every if study.evidence(swap.fit) < limit]
    pairs: dict[frozenset[str], tuple[Swap, Swap]] = {}
    for one in aside:
        for two in every:
            if one.k != two.k and two.worse < CROSSED_EVIDENCE:
                pairs.setdefault(frozenset({one.candidate.key, two.candidate.key}), (one, two))
    found: list[Fit] = []
    for one, two in sorted(pairs.values(), key=lambda pair: pair[0].worse + pair[1].worse):
        if len(found) >= MOST_CROSSED_RIVALS or len(study.fits) >= MOST_RIVAL_FITS:
            break
        both = exchanged(study, best, one, two, target=one.fit.score + UNPARTED_EVIDENCE)
        found += [] if both is None else [both]
    return found


def _instead_of_several(study: Study, best: Fit, k: int) -> list[Fit]:
    """Known sets in which one effect stands in the place of member ``k`` and of others, that do as well for their number."""
    own, limit = best.hypothesis, study.criterion(best) + UNPARTED_EVIDENCE
    return [
        f
        for identity, f in study.fits.items()
        if own.members[k].key not in identity
        and len(identity - own.identity) == 1
        and len(identity) < len(own.members)
        and f.score < LOST
        and study.criterion(f) < limit
    ]


def _several_instead(study: Study, best: Fit, k: int) -> list[Fit]:
    """Known sets in which several effects stand in the place of member ``k``, that do better although they are not told."""
    kept, limit = best.hypothesis.without(k).identity, study.criterion(best)
    return [
        f
        for identity, f in study.fits.items()
        if kept < identity and best.hypothesis.members[k].key not in identity and len(identity) > len(kept) + 1
        if _takes_back(study, f) and f.score < LOST and study.criterion(f) < limit
    ]


def _takes_back(study: Study, fitted: Fit) -> bool:
    """Whether a set takes away some of the dissipation that the model states."""
    own = fitted.hypothesis
    return any(study.predictor.takes_back(own, k, fitted.x) for k in range(len(own.members)))


def as_stated(study: Study, best: Fit) -> Fit:
    """The best set, or the likeliest known one that cannot be told from it, has fewer effects and takes nothing back of what the
    model states.

    Friction that falls with speed acts like friction and less damping than stated. One law that leaves the model as it is comes
    first.
    """
    if not _takes_back(study, best):
        return best
    simpler = [f for k in range(len(best.hypothesis.members)) for f in _instead_of_several(study, best, k)]
    return min((f for f in simpler if not _takes_back(study, f)), key=study.criterion, default=best)


def unseen(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Fits with a law of which member ``k`` is a special case, that do as well although they differ from it by design.

    The numbers that make the difference are held at typical values: the law pays for nothing, and is not told from its special
    case unless the recordings contradict it there.
    """
    study, base = outcome.study, best.hypothesis
    found = []
    for wider in study.candidates:
        rest = base.without(k)
        if not contains(wider, base.members[k]):
            continue
        if not compatible(rest, wider):
            continue
        points = like(wider, float(study.predictor.effect_values(base, k, best.x)[0]))
        # Of many shapes the last ones hardly differ from the special case whatever the recording.
        for point in points if len(points) <= 2 else [points[len(points) // 2]]:
            start = np.concatenate([study.without(best, k), to_internal(wider, point)])
            held = np.concatenate([study.whole(rest), np.arange(wider.size) > 0])
            fitted = fit(
                study.objective(rest.with_(wider)), start,
                study.states_for(rest.with_(wider), best), fixed=held, enough=RANKING_GAIN,
            )  # fmt: skip
            if fitted.score < best.score + UNPARTED_EVIDENCE:
                found.append(fitted)
                break
    return found


def preferred(outcome: Outcome, best: Fit) -> Fit:
    """The best set with each member exchanged for a rival that does better, if there is one."""
    study = outcome.study
    if exhausted(study, best):
        return pruned(study, best, study.loudness(best))
    best = pruned(study, best)
    for _ in range(len(best.hypothesis.members) + 1):
        # To the end: what the search only had to rank may have stopped short.
        best = study.fit(best.hypothesis, [best.x], best, most_steps=CARRIED_STEPS)
        shaken = _shaken(outcome, best)
        if shaken:
            best = study.fit(best.hypothesis, shaken, best, most_steps=CARRIED_STEPS, target=best.score)
        best = beyond_the_ends(study, replaced(study, best))
        others = [f for k in range(len(best.hypothesis.members)) for f in in_place_of(outcome, best, k)]
        # The place where a force over the angle fits best beside a wrong member need not be the one beside the right one.
        close = [f for f in others if study.criterion(f) < study.criterion(best) + NEAR_EVIDENCE]
        others += [replaced(study, f) for f in sorted(close, key=study.criterion)[:MOST_PLACED_RIVALS]]
        others += [beyond_the_ends(study, f) for f in close]
        others += _crossed(outcome, best)
        others += [f for _, own in rewritten(study, best, Turn.FEWER, Room(MOST_RIVAL_FITS)) for f in own]
        better = min(others, key=study.criterion, default=best)
        if study.criterion(better) > study.criterion(best) - 1e-6:
            break
        best = better
    list(rewritten(study, best, Turn.LAST, Room(MOST_RIVAL_FITS)))
    return as_stated(study, best)


def _shaken(outcome: Outcome, best: Fit) -> list[NDArray[np.float64]]:
    """Other starts for laws whose shape is a number of its own: a fit may have ended in a wrong valley of it."""
    study = outcome.study
    starts = []
    for k, member in enumerate(best.hypothesis.members):
        values = study.predictor.effect_values(best.hypothesis, k, best.x)
        for j, parameter in enumerate(member.effect.parameters):
            if j == 0 or parameter.lower < 0.0 or parameter.name in ("phase", "periods", "frequency"):
                continue
            for factor in (SHAKEN_RATIO, 1.0 / SHAKEN_RATIO):
                other = values.copy()
                other[j] = np.clip(other[j] * factor, parameter.lower, parameter.upper)
                x = study.predictor.with_values(best.hypothesis, k, best.x, other)
                # The nominal quantities may have been bent to the wrong valley.
                x[: len(study.predictor.nominal)] = 0.0
                starts.append(x)
    return starts


def ranking(outcome: Outcome, best: Fit, count: int) -> list[Fit]:
    """The likeliest hypotheses fitted, of those far from the best one none but the first few; the one claimed comes first."""
    computed = [
        f for f in outcome.study.fits.values() if f.cost < LOST and f.hypothesis.identity != best.hypothesis.identity
    ]
    shortlist = sorted(computed, key=outcome.study.criterion)
    near = [f for k, f in enumerate(shortlist) if k < FEWEST_RIVALS_TOLD or f.score < FAR_COST_RATIO * best.score]
    return [best, *near][:count]
