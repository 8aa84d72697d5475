"""The search over sets of effects: a beam of sets that grow, shrink and swap members, never one greedy line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.coordinates import to_internal
from harness.diagnose.fit import Fit
from harness.diagnose.hypothesis import Candidate, Hypothesis
from harness.diagnose.study import HOPELESS, Study, compatible

Progress = Callable[[str], None]
FLOOR = 1.15  # times the cost of noise alone, below which a set counts as complete
NEAR = 60.0  # in the criterion
UNDER_WAY = 200.0  # in the criterion
MOST_CARRIED = 4
CARRIED_STEPS = 40
FAR = 3.0  # times what the best set leaves
LEAST_SHARE = 0.05  # of a member's gain that a relative's score test must promise
ALIKE = 0.01  # of the noise's variance
CLEARLY = 3.0  # standard deviations of the cost of noise alone
SLOWLY = 0.05  # of what is left above the noise, that one more effect takes away at least
GENEROUS = 2.0  # times what the linear view promises


@dataclass(frozen=True)
class Effort:
    """How widely to search.

    beam: sets kept a round. tries: further effects fitted for each of them. largest: effects in a set. swaps: alternatives
    fitted for every member of the best set. most_fits: of one study; what needs more is not among few effects of the catalogue.
    """

    beam: int = 2
    tries: int = 4
    largest: int = 4
    swaps: int = 3
    most_fits: int = 30


def grow(
    study: Study, seeds: Sequence[Fit], effort: Effort, progress: Progress, *, to_begin_with: bool = False
) -> list[Fit]:
    """All fits worth keeping, best first, found by extending seeds one effect at a time and pruning backwards.

    to_begin_with: only to find where another study may begin, so that the first set that leaves nothing but noise is enough.
    """
    known: dict[frozenset[str], Fit] = {f.hypothesis.identity: f for f in seeds}
    fresh: list[Fit] = []

    def note(found: Fit) -> bool:
        """Keep a fit that is new or better than the known one of its set; whether it is."""
        old = known.get(found.hypothesis.identity)
        if old is not None and old.score <= found.score:
            return False
        known[found.hypothesis.identity] = found
        fresh.append(found)
        return True

    frontier = list(seeds)
    excess = np.inf
    expanded: set[frozenset[str]] = set()
    finished: list[Fit] = []
    swapped: set[frozenset[str]] = set()
    best = min(study.criterion(f) for f in seeds)
    if to_begin_with and any(_only_noise(study, f) for f in seeds):
        return sorted(seeds, key=study.criterion)
    for _ in range(effort.largest + 2):
        fresh.clear()
        for base in frontier:
            lowest = min(f.score for f in known.values())
            if base.hypothesis.identity in expanded or len(study.fits) >= effort.most_fits:
                continue
            expanded.add(base.hypothesis.identity)
            # Beside a set at the noise floor, only one that is nearly as good can still become better.
            if lowest < FLOOR * study.samples and study.criterion(base) > best + NEAR:
                continue
            # What leaves far more than a set near the noise does would need an effect that the other has no use for.
            if lowest < HOPELESS * study.samples and base.score > FAR * lowest:
                continue
            members = len(base.hypothesis.members)
            if members >= effort.largest or _needless(study, base) or any(_alike(base, done) for done in finished):
                continue
            promising = [s for s in study.ranked(base) if s.gain > study.price(s.candidate, members)]
            if _only_noise(study, base):
                # Little is left there, so that the linear view can be trusted: what it has no hope of is not fitted.
                own = study.criterion(base)
                promising = [s for s in promising if own + study.price(s.candidate, members) - GENEROUS * s.gain < best]
            if not promising:
                finished.append(base)
            for found in _diverse(promising, effort.tries):
                lowest = min(f.score for f in known.values())
                # Beside a set near the noise, what promises to leave far more is left to the search for its alternatives.
                if lowest < HOPELESS * study.samples and base.score - found.gain > FAR * lowest:
                    continue
                grown = study.extend(base, found)
                if note(grown):
                    progress(" + ".join(grown.hypothesis.keys))
        for fitted in sorted(fresh, key=study.criterion)[:1]:
            if len(fitted.hypothesis.members) < 2 or study.criterion(fitted) > best:
                continue
            for k in range(len(fitted.hypothesis.members)):
                note(study.reduce(fitted, k))
        ordered = sorted(known.values(), key=study.criterion)
        complete = _only_noise(study, ordered[0])
        if complete and to_begin_with:
            break
        if complete and len(ordered[0].hypothesis.members) > 1 and ordered[0].hypothesis.identity not in swapped:
            # Nothing more is needed, so before more is added, the members' relatives get their turn.
            swapped.add(ordered[0].hypothesis.identity)
            for k in range(len(ordered[0].hypothesis.members)):
                for other in relatives(study, ordered[0], k, effort.most_fits):
                    note(other)
            ordered = sorted(known.values(), key=study.criterion)
        if not _only_noise(study, ordered[0]):
            for wider in generalized(study, ordered[0]):
                if note(wider):
                    progress(" + ".join(wider.hypothesis.keys))
            ordered = sorted(known.values(), key=study.criterion)
        improved = study.criterion(ordered[0]) < best - 1e-6
        best = study.criterion(ordered[0])
        before, excess = excess, min(f.score for f in known.values()) - study.samples
        if (
            len(ordered[0].hypothesis.members) > 1
            and not _only_noise(study, ordered[0])
            and excess > (1.0 - SLOWLY) * before
        ):
            # At this pace no set of few effects gets there; what is still found only soaks up what something else makes.
            study.spent = True
            break
        frontier = [f for f in ordered[: effort.beam] if f.hypothesis.identity not in expanded]
        if not frontier or (not fresh and not improved):
            break
    return sorted(known.values(), key=study.criterion)


def _only_noise(study: Study, fitted: Fit) -> bool:
    """Whether a fit leaves no more than noise alone would at times."""
    return fitted.score <= study.samples + CLEARLY * float(np.sqrt(2.0 * study.samples))


def exhausted(study: Study, fitted: Fit) -> bool:
    """Whether a set leaves more than noise and growing does not make it leave less: then the catalogue has no explanation in few
    effects, and what else could stand in a member's place is idle to ask."""
    return study.spent and fitted.score > FLOOR * study.samples


def _alike(one: Fit, other: Fit) -> bool:
    """Whether two fits predict the same but for a small part of the noise, so that neither can be improved if the other cannot."""
    if one.windows != other.windows:
        return False
    pairs = zip(one.linear.residuals, other.linear.residuals, strict=True)
    return sum(float(np.sum((a - b) ** 2)) for a, b in pairs) < ALIKE * sum(len(r) for r in one.linear.residuals)


def _needless(study: Study, fitted: Fit) -> bool:
    """Whether a simpler effect in a member's place does better: then nothing is to be built on the more general one."""
    own = study.criterion(fitted)
    keys = fitted.hypothesis.identity
    for member in fitted.hypothesis.members:
        for name in member.effect.simpler:
            other = study.fits.get((keys - {member.key}) | {f"{name}@{member.site}"})
            if other is not None and study.criterion(other) < own:
                return True
    return False


def generalized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a law of which it is a special case, begun from what the member was fitted to.

    A score test from absence cannot see such a law behind its special case: they act alike to first order.
    """
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        for wider in study.candidates:
            if wider.site != member.site or member.effect.name not in wider.effect.simpler:
                continue
            rest = base.hypothesis.without(k)
            key = (base.hypothesis.identity, wider.key)
            if not compatible(rest, wider):
                continue
            if key in study.widened:
                found.append(study.fits[rest.with_(wider).identity])
                continue
            study.widened.add(key)
            others = study.without(base, k)
            starts = [np.concatenate([others, to_internal(wider, p)]) for p in like(wider, float(values[0]))]
            found.append(study.fit(rest.with_(wider), starts, base, target=base.score))
    return found


def specialized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a special case of it, begun from what the member was fitted to.

    A fit of the special case that was begun elsewhere may have ended in a wrong valley.
    """
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        rest = base.hypothesis.without(k)
        for simpler in study.candidates:
            if simpler.site != member.site or simpler.effect.name not in member.effect.simpler:
                continue
            if not compatible(rest, simpler):
                continue
            key = (base.hypothesis.identity, simpler.key)
            hypothesis = rest.with_(simpler)
            if key not in study.widened:
                study.widened.add(key)
                own = to_internal(simpler, values[: len(simpler.effect.parameters)])
                study.fit(hypothesis, [np.concatenate([study.without(base, k), own])], base)
            found.append(study.fits[hypothesis.identity])
    return found


LARGER = 1.5  # times the special case's amplitude: a start for amplitudes that it does not have


def like(wider: Candidate, amplitude: float) -> list[NDArray[np.float64]]:
    """Starting values of a more general law that acts about as strongly as its special case of ``amplitude``."""
    first, *others = wider.effect.parameters
    choices = [(LARGER * amplitude,) if p.unit == first.unit else p.start_values(wider.references) for p in others]
    points = [np.array([amplitude, *rest]) for rest in product(*choices)]
    return [np.clip(p, wider.effect.lower, wider.effect.upper) for p in points]


def _diverse(promising: Sequence[object], count: int) -> list:
    """The best scores, but not more than half of them at one effect's different sites."""
    chosen: list = []
    per_effect: dict[str, int] = {}
    for found in promising:
        name = found.candidate.effect.name  # type: ignore[attr-defined]
        if per_effect.get(name, 0) >= max(2, count // 2):
            continue
        per_effect[name] = per_effect.get(name, 0) + 1
        chosen.append(found)
        if len(chosen) == count:
            break
    return chosen


def related(member: Candidate, other: Candidate) -> bool:
    """Whether two candidates are forms of one thing, or known for being taken for one another."""
    a, b = member.effect, other.effect
    if a.name in b.simpler or b.name in a.simpler:
        return member.site == other.site
    return a.name in b.confusable_with or b.name in a.confusable_with


def _same_units(member: Candidate, other: Candidate) -> bool:
    """Whether the numbers of two candidates may be compared one by one."""
    return [p.unit for p in member.effect.parameters] == [p.unit for p in other.effect.parameters]


def relatives(study: Study, best: Fit, k: int, most_fits: int) -> list[Fit]:
    """Fits with member ``k`` replaced by what it is related to, as long as the study has fewer than ``most_fits``.

    A law that acts alike may be far from linear, so that a score test says little of it. The member itself is among them where the
    score test sees a better place for it than it has: another number of periods, another frequency, found beside other company.
    """
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    own = without.score - best.score
    found = []
    for scored in study.ranked(without):
        if scored.candidate.key == member.key:
            found.append(study.extend(without, scored))
            continue
        if not related(member, scored.candidate):
            continue
        if len(study.fits) >= most_fits:
            break
        if _same_units(member, scored.candidate):
            # What is measured in the same units is likely to be as large.
            alike = study.predictor.effect_values(best.hypothesis, k, best.x)
            law = scored.candidate.effect
            found.append(study.extend(without, replace(scored, start=np.clip(alike, law.lower, law.upper))))
        elif scored.gain > LEAST_SHARE * own:
            found.append(study.extend(without, scored))
    return found


def alternatives(study: Study, best: Fit, k: int, effort: Effort) -> list[Fit]:
    """Fits with member ``k`` of the best set replaced by another candidate, the most promising ones, best first."""
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    needed = study.criterion(without) - study.criterion(best)
    found = []
    tried = 0
    for scored in study.ranked(without):
        if scored.candidate.key == member.key or tried >= effort.swaps:
            continue
        if len(study.fits) >= 2 * effort.most_fits:
            break
        if scored.gain < 0.3 * min(needed, without.score - best.score):
            break
        tried += 1
        found.append(study.extend(without, scored))
    return sorted(found, key=study.criterion)


def pruned(study: Study, fitted: Fit, louder: float = 1.0) -> Fit:
    """The set without members, and without generality, that do not pay for themselves beside the others.

    louder: variance of the noise, in units of what it is taken to be: what the set leaves, where that is no noise.
    """

    def criterion(of: Fit) -> float:
        return study.criterion(of) - of.score * (1.0 - 1.0 / louder)

    while fitted.hypothesis.members:
        fewer = [study.reduce(fitted, k) for k in range(len(fitted.hypothesis.members))]
        smaller = min([*fewer, *specialized(study, fitted)], key=criterion)
        if criterion(smaller) > criterion(fitted):
            break
        fitted = smaller
    return fitted


def finished(study: Study, ordered: Sequence[Fit]) -> list[Fit]:
    """The fits with the best ones carried to their end where they were still under way, best first.

    A contender that walks along a narrow valley would else lose to one that had a shorter way.
    """
    best = study.criterion(ordered[0])
    if ordered[0].score > HOPELESS * study.samples:
        return list(ordered)
    open_ones = [f for f in ordered if not f.converged and study.criterion(f) < best + UNDER_WAY]
    for fitted in open_ones[:MOST_CARRIED]:
        if fitted.hypothesis.identity not in study.carried:
            study.carried.add(fitted.hypothesis.identity)
            study.fit(fitted.hypothesis, [fitted.x], fitted, most_steps=CARRIED_STEPS)
    known = {f.hypothesis.identity: study.fits.get(f.hypothesis.identity, f) for f in ordered}
    return sorted(known.values(), key=study.criterion)


def polish(study: Study, ordered: list[Fit], effort: Effort, progress: Progress) -> list[Fit]:
    """Swap members of the best set for alternatives until nothing improves; all fits known then, best first."""
    # Far above the noise something outside the catalogue is at work, and one round of swaps is enough to know its rivals.
    for _ in range(3 if ordered[0].score < HOPELESS * study.samples else 1):
        ordered = finished(study, ordered)
        if exhausted(study, ordered[0]):
            break
        before = study.criterion(ordered[0])
        best = pruned(study, ordered[0])
        if len(study.fits) >= effort.most_fits:
            break
        for k in range(len(best.hypothesis.members)):
            alternatives(study, best, k, effort)
            progress("alternatives to " + best.hypothesis.keys[k])
        ordered = sorted(study.fits.values(), key=study.criterion)
        if study.criterion(ordered[0]) > before - 1e-6:
            break
        ordered = grow(study, ordered[: effort.beam], effort, progress)
    return ordered


def transfer(study: Study, fits: Sequence[Fit], count: int, progress: Progress) -> list[Fit]:
    """The best hypotheses of one study fitted again on the windows of another, from where they stood."""
    out = []
    for old in fits[:count]:
        hypothesis: Hypothesis = old.hypothesis
        near = Fit(hypothesis, old.windows, old.x, old.states, old.linear, old.prior, old.converged, old.free)
        states_known = {
            w: old.states[v] for w in study.windows for v in old.windows if (v.run, v.first) == (w.run, w.first)
        }
        near = Fit(hypothesis, old.windows, old.x, states_known, old.linear, old.prior, old.converged, old.free)
        out.append(study.fit(hypothesis, [old.x], near))
        progress("free runs of " + (" + ".join(hypothesis.keys) or "the nominal model"))
    return out


def internal(study: Study, fitted: Fit, k: int) -> np.ndarray:
    """Internal coordinates of member k's SI values in a fit."""
    return to_internal(fitted.hypothesis.members[k], study.predictor.effect_values(fitted.hypothesis, k, fitted.x))


__all__ = ["Effort", "alternatives", "compatible", "grow", "internal", "polish", "transfer"]
