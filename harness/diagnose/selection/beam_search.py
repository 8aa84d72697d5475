"""The search over sets of effects: a beam of sets that grow, shrink and swap members, never one greedy line.

Single effects have their turn first, and what the best of them is known to be taken for before anything is added to it; beside
effects that are behind the best set one more is tried where both together promise more. Effort goes where it can matter: a set
that leaves only noise is not extended by what twice its score test's promise would not pay for; links, joints and plays, which
are dear to fit, wait until they promise a share of what is left. When one more effect takes away next to nothing of what a set
leaves above the noise, few effects will not explain the recordings: members are then kept only if they pay against noise as loud
as what is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Hypothesis, compatible, dear
from harness.diagnose.selection.constants.search import (
    ALIKE_PREDICTIONS,
    BEAM_WIDTH,
    CARRIED_STEPS,
    COMPLETE_COST_RATIO,
    DEAR_EFFECT_SHARE,
    DEAR_PROMISE,
    FAR_COST_RATIO,
    GENEROUS_PROMISE,
    HOPELESS_COST_RATIO,
    LARGEST_SET,
    MEMBER_ALTERNATIVES,
    MOST_CARRIED_SETS,
    MOST_STUDY_FITS,
    NEAR_EVIDENCE,
    OFFERED_PAIRS,
    PLAINLY_MORE_THAN_NOISE,
    PROSPECTS,
    STALLED_SHARE,
    STRAIGHTENING_EFFECTS,
    TRIED_EFFECTS,
    UNDER_WAY_GAIN,
)
from harness.diagnose.selection.pruning import pruned
from harness.diagnose.selection.rewrite import Room, Turn
from harness.diagnose.selection.rewrites.catalogue import rewritten
from harness.diagnose.selection.score_tests import Score
from harness.diagnose.selection.study import Study

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Effort:
    """How widely to search.

    beam: sets kept a round. tries: further effects fitted for each of them. largest: effects in a set. swaps: alternatives
    fitted for every member of the best set. most_fits: of one study; what needs more is not among few effects of the catalogue.
    """

    beam: int = BEAM_WIDTH
    tries: int = TRIED_EFFECTS
    largest: int = LARGEST_SET
    swaps: int = MEMBER_ALTERNATIVES
    most_fits: int = MOST_STUDY_FITS


def grow(
    study: Study,
    seeds: Sequence[Fit],
    effort: Effort,
    progress: Progress,
    *,
    to_begin_with: bool = False,
    stop: Callable[[Fit], bool] = lambda _: False,
) -> list[Fit]:
    """All fits worth keeping, best first, found by extending seeds one effect at a time and pruning backwards.

    to_begin_with: only to find where another study may begin, so that the first set that leaves nothing but noise is enough.
    stop: asked about the best set after every round, whether to go no further.
    """
    growth = Growth(study, effort, progress, {f.hypothesis.identity: f for f in seeds}, to_begin_with)
    if to_begin_with and any(study.only_noise(f) for f in seeds):
        return growth.ordered()
    frontier, excess = growth.ordered()[: effort.beam], np.inf
    # Single effects have their turn first: what one of them explains needs none of the sets that others began with.
    nothing = [f for f in seeds if not f.hypothesis.members]
    frontier = nothing + [f for f in frontier if f.hypothesis.members]
    for _ in range(effort.largest + 2):
        before, found = growth.best, len(growth.changed)
        for base in frontier:
            growth.extend(base)
        growth.shrink(growth.changed[found:], before)
        if (to_begin_with and study.only_noise(growth.ordered()[0])) or stop(growth.ordered()[0]):
            # What leaves no more than noise only beside a bent model may be a poor place to begin.
            growth.straighten()
            break
        growth.exchange()
        growth.prospect()
        growth.straighten()
        ordered = growth.ordered()
        last, excess = excess, growth.lowest - study.samples
        if (
            len(ordered[0].hypothesis.members) > 1
            and not study.only_noise(ordered[0])
            and excess > (1.0 - STALLED_SHARE) * last
        ):
            # At this pace no set of few effects gets there; what is still found only soaks up what something else makes.
            study.spent = True
            break
        frontier = [f for f in ordered[: effort.beam] if f.hypothesis.identity not in growth.expanded]
        if not frontier or (len(growth.changed) == found and growth.best > before - 1e-6):
            break
    return growth.ordered()


@dataclass(eq=False)
class Growth:
    """A search under way.

    known: the best fit of every set. to_begin_with: see ``grow``. changed: fits noted one after another, better ones of known sets
    included. expanded: sets that further effects were tried beside; complete: those of them beside which nothing promised enough.
    swapped: sets whose members' relatives were tried; straightened: those for whose bent nominal quantities an effect was sought.
    """

    study: Study
    effort: Effort
    progress: Progress
    known: dict[frozenset[str], Fit]
    to_begin_with: bool
    changed: list[Fit] = field(default_factory=list)
    expanded: set[frozenset[str]] = field(default_factory=set)
    complete: list[Fit] = field(default_factory=list)
    swapped: set[frozenset[str]] = field(default_factory=set)
    straightened: set[frozenset[str]] = field(default_factory=set)

    def ordered(self) -> list[Fit]:
        """All fits, best first."""
        return sorted(self.known.values(), key=self.study.criterion)

    @property
    def best(self) -> float:
        """The criterion of the best set."""
        return min(map(self.study.criterion, self.known.values()))

    @property
    def lowest(self) -> float:
        """The least score of any set."""
        return min(f.score for f in self.known.values())

    def _plainest(self) -> Fit:
        """The best set, or a smaller one that leaves nothing but noise and is nearly as good."""
        best = self.ordered()[0]
        limit = self.study.criterion(best) + UNPARTED_EVIDENCE
        alike = [f for f in self.ordered() if self.study.only_noise(f) and self.study.criterion(f) < limit]
        return min([best, *alike], key=lambda f: len(f.hypothesis.members))

    def note(self, found: Fit, *, aloud: bool = False) -> None:
        """Keep a fit that is new or better than the known one of its set; aloud: and tell of it."""
        old = self.known.get(found.hypothesis.identity)
        if old is not None and old.score <= found.score:
            return
        self.known[found.hypothesis.identity] = found
        self.changed.append(found)
        if aloud:
            tell(self.study, " + ".join(found.hypothesis.keys), self.progress)

    def extend(self, base: Fit) -> None:
        """Fit the most promising further effects beside a set, unless there is no hope for any."""
        study, best = self.study, self.best
        if base.hypothesis.identity in self.expanded or len(study.fits) >= self.effort.most_fits:
            return
        self.expanded.add(base.hypothesis.identity)
        if self._idle(base, best):
            return
        promising = self._promising(base, best)
        if not promising:
            self.complete.append(base)
        slow = any(dear(member) for member in base.hypothesis.members)
        for found in _diverse(promising, self.effort.tries // 2 if slow else self.effort.tries):
            # Beside a set near the noise, what promises to leave far more is left to the search for its alternatives.
            near = self.lowest < HOPELESS_COST_RATIO * study.samples
            if near and base.score - found.gain > FAR_COST_RATIO * self.lowest:
                continue
            if near and dear(found.candidate) and base.score - DEAR_PROMISE * found.gain > self.lowest:
                continue
            grown = study.extend(base, found)
            self.note(grown, aloud=True)
            if self.to_begin_with and study.only_noise(grown):
                break

    def _idle(self, base: Fit, best: float) -> bool:
        """Whether there is no use in adding to a set."""
        study = self.study
        # Beside a set at the noise floor, only one that is nearly as good can still become better.
        if self.lowest < COMPLETE_COST_RATIO * study.samples and study.criterion(base) > best + NEAR_EVIDENCE:
            return True
        # What leaves far more than a set near the noise does would need an effect that the other has no use for.
        if self.lowest < HOPELESS_COST_RATIO * study.samples and base.score > FAR_COST_RATIO * self.lowest:
            return True
        # What a smaller set explains as well, needs no further effect beside the larger one.
        smaller = (f for key, f in self.known.items() if key < base.hypothesis.identity and study.only_noise(f))
        if any(study.criterion(f) < study.criterion(base) + UNPARTED_EVIDENCE for f in smaller):
            return True
        full = base.hypothesis.things >= self.effort.largest and not self._modifiable(base)
        return full or _needless(study, base) or any(_alike(base, other) for other in self.complete)

    def _modifiable(self, base: Fit) -> bool:
        """Whether there is another form of what is in a set."""
        return any(c.effect.modifies and compatible(base.hypothesis, c) for c in self.study.candidates)

    def _promising(self, base: Fit, best: float) -> list[Score]:
        """Further effects whose score test promises more than their price."""
        study, members = self.study, len(base.hypothesis.members)
        # Beside little more than noise, what is dear to run can wait for the study that this one begins.
        waits = self.to_begin_with and base.score < PLAINLY_MORE_THAN_NOISE * study.samples
        tests = study.among(base, study.cheap) if waits else study.likely(base)
        found = [s for s in tests if s.gain > study.price(s.candidate, members)]
        if base.hypothesis.things >= self.effort.largest:
            found = [s for s in found if s.candidate.effect.modifies]
        # What is dear to fit waits until what explains most is there, and its own share of the rest is worth it.
        worth = DEAR_EFFECT_SHARE * (base.score - study.samples)
        found = [s for s in found if s.gain > worth or not dear(s.candidate)]
        if study.only_noise(base):
            # Little is left there, so that the linear view can be trusted: what it has no hope of is not fitted.
            own = study.criterion(base)
            found = [s for s in found if own + study.price(s.candidate, members) - GENEROUS_PROMISE * s.gain < best]
        return found

    def shrink(self, fresh: Sequence[Fit], best: float) -> None:
        """Take members away from the best of fresh fits, if it is better than what was best."""
        fitted = min(fresh, key=self.study.criterion, default=None)
        if fitted is None or len(fitted.hypothesis.members) < 2 or self.study.criterion(fitted) > best:
            return
        self._note_smaller(fitted)

    def _note_smaller(self, fitted: Fit) -> None:
        """Note the fits of a set without each of its members."""
        for k in range(len(fitted.hypothesis.members)):
            self.note(self.study.reduce(fitted, k))

    def exchange(self) -> None:
        """Give relatives of the best set's members, and more general laws, their turn."""
        study, best = self.study, self._without_needless()
        members = best.hypothesis.members
        enough = study.only_noise(best)
        single = len(members) == 1 and not enough and not dear(members[0])
        if (single or (enough and len(members) > 1)) and best.hypothesis.identity not in self.swapped:
            # Nothing more is needed, or nothing is built on it yet: before more is added, the members' relatives get their turn.
            self.swapped.add(best.hypothesis.identity)
            for _, found in rewritten(study, best, Turn.KIN, Room(self.effort.most_fits, quick=single)):
                for other in found:
                    self.note(other)
            best = self._plainest()
        if not study.only_noise(best):
            for _, found in rewritten(study, best, Turn.WIDER, Room(self.effort.most_fits)):
                for wider in found:
                    self.note(wider, aloud=True)

    def _without_needless(self) -> Fit:
        """The plainest set, with nothing in it that the recordings do not ask for: what is not needed needs no relative either."""
        study, best, seen = self.study, self._plainest(), set[frozenset[str]]()
        while study.only_noise(best) and len(best.hypothesis.members) > 1 and best.hypothesis.identity not in seen:
            seen.add(best.hypothesis.identity)
            self._note_smaller(best)
            best = self._plainest()
        return best

    def prospect(self) -> None:
        """Fit what single effects behind the best set promise together with one more.

        Two effects may each explain little by itself where one that is neither explains some of both.
        """
        study, best = self.study, self.best
        plainest = self._plainest()
        if study.only_noise(plainest) and len(plainest.hypothesis.members) < 2:
            return
        singles = [f for f in self.ordered() if len(f.hypothesis.members) == 1 and not dear(f.hypothesis.members[0])]
        if study.only_noise(plainest):
            singles = [f for f in singles if f.score < FAR_COST_RATIO * self.lowest]
        offers = [
            (study.criterion(base) - found.gain + study.price(found.candidate, 1), base, found)
            for base in singles[:PROSPECTS]
            for found in study.likely(base)
        ]
        for promised, base, found in sorted(offers, key=lambda offer: offer[0])[:OFFERED_PAIRS]:
            if promised < best and not dear(found.candidate) and len(study.fits) < self.effort.most_fits:
                self.note(study.extend(base, found), aloud=True)

    def straighten(self) -> None:
        """Fit what may have bent the best set's nominal quantities out of their tolerance, and what the empty set's.

        Beside effects that did part of its work by mistake, what bent the empty set has little left to do.
        """
        best = self.ordered()[0]
        if len(self.study.fits) >= 2 * self.effort.most_fits or not self.study.stretched(best):
            return
        for base in filter(None, (best, self.known.get(frozenset()))):
            identity = base.hypothesis.identity
            full = base.hypothesis.things >= self.effort.largest
            if identity in self.straightened or full or not self.study.stretched(base):
                continue
            self.straightened.add(identity)
            for _, found in rewritten(self.study, base, Turn.STRAIGHTER, Room(count=STRAIGHTENING_EFFECTS)):
                for straight in found:
                    self.note(straight, aloud=True)


def tell(study: Study, what: str, progress: Progress) -> None:
    """Show what is done, behind the best set so far and what it leaves."""
    best = min(study.fits.values(), key=study.criterion)
    left = float(np.sqrt(best.cost / max(study.samples, 1.0)))
    progress(f"best so far {' + '.join(best.hypothesis.keys) or 'nothing'}, leaving {left:.3g} × noise; {what}")


def exhausted(study: Study, fitted: Fit) -> bool:
    """Whether a set leaves more than noise and growing does not make it leave less: then the catalogue has no explanation in few
    effects, and what else could stand in a member's place is idle to ask."""
    return study.spent and fitted.score > COMPLETE_COST_RATIO * study.samples


def _alike(one: Fit, other: Fit) -> bool:
    """Whether two fits predict the same but for a small part of the noise, so that neither can be improved if the other cannot."""
    if one.windows != other.windows:
        return False
    pairs = zip(one.linear.residuals, other.linear.residuals, strict=True)
    return sum(float(np.sum((a - b) ** 2)) for a, b in pairs) < ALIKE_PREDICTIONS * sum(
        len(r) for r in one.linear.residuals
    )


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


def _diverse(promising: Sequence[Score], count: int) -> list[Score]:
    """The best scores, but not more than half of them at one effect's different sites."""
    chosen: list[Score] = []
    per_effect: dict[str, int] = {}
    for found in promising:
        name = found.candidate.effect.name
        if per_effect.get(name, 0) >= max(2, count // 2):
            continue
        per_effect[name] = per_effect.get(name, 0) + 1
        chosen.append(found)
        if len(chosen) == count:
            break
    return chosen


def finished(study: Study, ordered: Sequence[Fit]) -> list[Fit]:
    """The fits with the best ones carried to their end where they were still under way, best first.

    A contender that walks along a narrow valley would else lose to one that had a shorter way.
    """
    best = study.criterion(ordered[0])
    if ordered[0].score > HOPELESS_COST_RATIO * study.samples:
        return list(ordered)
    open_ones = [f for f in ordered if not f.converged and study.criterion(f) < best + UNDER_WAY_GAIN]
    for fitted in open_ones[:MOST_CARRIED_SETS]:
        if fitted.hypothesis.identity not in study.carried:
            study.carried.add(fitted.hypothesis.identity)
            study.fit(fitted.hypothesis, [fitted.x], fitted, most_steps=CARRIED_STEPS)
    known = {f.hypothesis.identity: study.fits.get(f.hypothesis.identity, f) for f in ordered}
    return sorted(known.values(), key=study.criterion)


def polish(study: Study, ordered: list[Fit], effort: Effort, progress: Progress) -> list[Fit]:
    """Rewrite the best set in every way until nothing improves; all fits known then, best first."""
    # Above the noise something outside the catalogue is at work, and one round of swaps is enough to know its rivals.
    complete = ordered[0].score < HOPELESS_COST_RATIO * study.samples and not study.left_out
    for _ in range(3 if complete else 1):
        ordered = finished(study, ordered)
        if exhausted(study, ordered[0]):
            break
        before = study.criterion(ordered[0])
        best = pruned(study, ordered[0])
        if len(study.fits) >= effort.most_fits:
            break
        for way, _ in rewritten(study, best, Turn.POLISHING, Room(2 * effort.most_fits, effort.swaps)):
            tell(study, way.what, progress)
        ordered = sorted(study.fits.values(), key=study.criterion)
        if study.criterion(ordered[0]) > before - 1e-6:
            break
        ordered = grow(study, ordered[: effort.beam], effort, progress)
    return ordered


def transfer(study: Study, fits: Sequence[Fit], count: int, progress: Progress) -> list[Fit]:
    """The best hypotheses of one study fitted again on the windows of another, from where they stood."""
    out: list[Fit] = []
    for old in fits[:count]:
        hypothesis: Hypothesis = old.hypothesis
        near = old.beginning(study.windows)
        # What was near the best under one estimate of the noise or on other windows need not be under this one.
        within = min((f.score for f in out), default=-np.inf) + NEAR_EVIDENCE
        out.append(study.fit(hypothesis, [old.x], near, target=within))
        tell(study, "free runs of " + (" + ".join(hypothesis.keys) or "the nominal model"), progress)
    return out
