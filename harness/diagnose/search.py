"""The search over sets of effects: a beam of sets that grow, shrink and swap members, never one greedy line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from harness.diagnose.fit import Fit
from harness.diagnose.hypothesis import Hypothesis
from harness.diagnose.predict import to_internal
from harness.diagnose.study import Study, compatible

Progress = Callable[[str], None]
FLOOR = 1.15  # times the cost of noise alone, below which a set counts as complete
NEAR = 60.0  # in the criterion
HOPELESS = 2.0  # times the cost of noise alone


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


def grow(study: Study, seeds: Sequence[Fit], effort: Effort, progress: Progress) -> list[Fit]:
    """All fits worth keeping, best first, found by extending seeds one effect at a time and pruning backwards."""
    known: dict[frozenset[str], Fit] = {f.hypothesis.identity: f for f in seeds}
    frontier = list(seeds)
    expanded: set[frozenset[str]] = set()
    best = min(study.criterion(f) for f in seeds)
    for _ in range(effort.largest + 2):
        fresh: list[Fit] = []
        lowest = min(f.score for f in known.values())
        for base in frontier:
            if base.hypothesis.identity in expanded or len(study.fits) >= effort.most_fits:
                continue
            expanded.add(base.hypothesis.identity)
            # Beside a set at the noise floor, only one that is nearly as good can still become better.
            if lowest < FLOOR * study.samples and study.criterion(base) > best + NEAR:
                continue
            members = len(base.hypothesis.members)
            if members >= effort.largest or _needless(study, base):
                continue
            promising = [s for s in study.ranked(base) if s.gain > study.price(s.candidate, members)]
            for found in _diverse(promising, effort.tries):
                grown = study.extend(base, found)
                if grown.hypothesis.identity not in known:
                    known[grown.hypothesis.identity] = grown
                    fresh.append(grown)
                    progress(" + ".join(grown.hypothesis.keys))
        for fitted in sorted(fresh, key=study.criterion)[:1]:
            if len(fitted.hypothesis.members) < 2 or study.criterion(fitted) > best:
                continue
            for k in range(len(fitted.hypothesis.members)):
                smaller = study.reduce(fitted, k)
                if smaller.hypothesis.identity not in known:
                    known[smaller.hypothesis.identity] = smaller
                    fresh.append(smaller)
        ordered = sorted(known.values(), key=study.criterion)
        improved = study.criterion(ordered[0]) < best - 1e-6
        best = study.criterion(ordered[0])
        frontier = [f for f in ordered[: effort.beam] if f.hypothesis.identity not in expanded]
        if not frontier or (not fresh and not improved):
            break
    return sorted(known.values(), key=study.criterion)


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


def polish(study: Study, ordered: list[Fit], effort: Effort, progress: Progress) -> list[Fit]:
    """Swap members of the best set for alternatives until nothing improves; all fits known then, best first."""
    # Far above the noise something outside the catalogue is at work, and one round of swaps is enough to know its rivals.
    for _ in range(3 if ordered[0].score < HOPELESS * study.samples else 1):
        best = ordered[0]
        if len(study.fits) >= effort.most_fits:
            break
        before = study.criterion(best)
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
