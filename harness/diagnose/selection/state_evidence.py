"""Which set of laws recordings speak for where every one of them leaves a force out.

Sets are weighed with the force that they leave integrated out, as a function of the state (``estimation.state_force``), and of
those that are not parted so the plainest is taken: what nobody would look for first needs evidence of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.autoregression import surprise_of_innovations
from harness.diagnose.estimation.beside_state_force import Beside, along_the_recordings, beside
from harness.diagnose.estimation.constants import ENOUGH_SURPRISE, LOST
from harness.diagnose.estimation.effective_samples import hanging_together
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.state_force import StateForce
from harness.diagnose.problem.constants import STRONG_EVIDENCE, UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import EVERYWHERE, Candidate, Hypothesis
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.constants.weighing import FEWEST_WAVES, NEARER_FIT_RATIO
from harness.diagnose.selection.score_tests import carry_state
from harness.diagnose.selection.study import Study
from harness.diagnose.selection.wald_test import carried
from harness.effects.scale import pull

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Evidence:
    """What recordings say of sets with the force that these leave integrated out.

    rough: noise as the channels scatter; looked: squares that fits leave without the force.
    """

    force: StateForce
    rough: Likelihood
    looked: dict[tuple[frozenset[str], tuple[Window, ...], bytes], float] = field(default_factory=dict)

    def has(self, fitted: Fit) -> bool:
        """Whether a set has been looked at in its windows."""
        return (fitted.hypothesis.identity, fitted.windows) in self.force.known

    def beside(self, study: Study, fitted: Fit, *, by_itself: bool = False) -> Beside:
        """A set and the force that it leaves out, together; however the set was weighed for the fit that this begins at.

        It is begun from sets that have been looked at, where there are such ones; by_itself: from its own fit, too.
        """
        own, key = fitted.hypothesis.identity, (fitted.hypothesis.identity, fitted.windows)
        found: Beside | None = self.force.known.get(key)
        if found is not None and study.predictor.deadline.over:
            return found
        part = self._likeliest_of(fitted, lambda other: other < own)
        whole = self._likeliest_of(fitted, lambda other: own < other and len(other) == len(own) + 1)

        def behind(other: Beside | None, by: float) -> bool:
            return other is not None and (found is None or other.surprise < found.surprise - by)

        def begun(at: Beside | None) -> Beside | None:
            pair = key, own if at is None else at.hypothesis.identity
            if pair in self.force.begun and not (at is None and self._far_nearer(study, fitted)):
                return found
            left = self._left_alone(study, fitted) if at is None else 0.0
            starts = () if at is None else self._starts(study, fitted, at)
            objective = study.objective_under(self.rough, fitted)
            other = beside(self.force, objective, fitted, study.whole(fitted.hypothesis), starts)
            self.force.begun[pair] = left
            return other if found is None or other.surprise < found.surprise else found

        # No part of a set is likelier than the set: where it seems so, the set has ended elsewhere. What is far less likely than a
        # set of one more may have ended where a joint sticks in the wrong place.
        if behind(part, ENOUGH_SURPRISE):
            found = begun(part)
        if behind(whole, 2.0 * UNPARTED_EVIDENCE):
            found = begun(whole)
        alone = part is None and behind(whole, 2.0 * UNPARTED_EVIDENCE)
        if by_itself or found is None or alone or self._far_nearer(study, fitted):
            found = begun(None)
        assert found is not None  # begun by itself at the latest
        self.force.known[key] = found
        return found

    def _far_nearer(self, study: Study, fitted: Fit) -> bool:
        """Whether a fit leaves far less than the one from which its set was begun: that one had ended in a wrong valley."""
        own = fitted.hypothesis.identity
        before = self.force.begun.get(((own, fitted.windows), own))
        return before is not None and self._left_alone(study, fitted) < NEARER_FIT_RATIO * before

    def _left_alone(self, study: Study, fitted: Fit) -> float:
        """Squares that a fit leaves without the force, under the sensors' noise."""
        key = fitted.hypothesis.identity, fitted.windows, fitted.x.tobytes()
        if key not in self.looked:
            self.looked[key], _ = study.residuals_under(self.rough, fitted)
        return self.looked[key]

    def _likeliest_of(self, fitted: Fit, such: Callable[[frozenset[str]], bool]) -> Beside | None:
        """The likeliest of such sets that have been looked at in the same windows, with a force beside it."""
        rows = [
            found
            for (identity, windows), found in self.force.known.items()
            if windows == fitted.windows and such(identity) and found.nodes is not None
        ]
        return min(rows, key=lambda found: found.surprise, default=None)

    def _starts(self, study: Study, fitted: Fit, other: Beside) -> list[Beside]:
        """A set from where another one stands beside the force; what that has not as the own fit has it, and absent."""
        hypothesis = fitted.hypothesis
        own, gone = carried(other.hypothesis, other.x, hypothesis, fitted.x)
        starts = [own] if np.array_equal(own, gone) or not np.isfinite(gone).all() else [own, gone]
        states = {w: carry_state(study.predictor, other.hypothesis, hypothesis, s) for w, s in other.states.items()}
        return [replace(other, x=start, states=states) for start in starts]

    def loudness(self, found: Beside) -> Array:
        """Variance of every channel beside a set and its force, in units of the sensors', as samples that err together leave it."""
        if found.shape is not None:
            return np.asarray(found.shape.louder * self.force.together)
        left, counts = self._left(found)
        return np.asarray(np.maximum(left / np.maximum(counts, 1), 1.0) * self.force.together)

    def _left(self, found: Beside) -> tuple[Array, Array]:
        """Squares that a set and its force leave of every channel, (C,), and of how many readings."""
        channels = [r.reshape(self.force.channels, -1) for r in found.residuals]
        left = np.sum([np.sum(own**2, axis=1) for own in channels], axis=0)
        return left, np.sum([np.count_nonzero(own, axis=1) for own in channels], axis=0)

    def by_own_remainder(self, study: Study, fitted: Fit) -> float:
        """The criterion of a set with what is left beside its force as noise that follows itself in its own way.

        For sets that leave different kinds of remainder: of two that leave the same kind, ``criterion`` is as sharp and calmer.
        """
        value = self.criterion(study, fitted)
        if not np.isfinite(value):
            return value
        found, force = self.beside(study, fitted), self.force
        left, counts = self._left(found)
        loud = self.loudness(found)
        shared = np.sum(counts / force.together * np.log(loud / force.together) + left / loud)
        stretches = [r.reshape(force.channels, -1) for r in found.residuals]
        return value - float(shared) + surprise_of_innovations(stretches)

    def price(self, study: Study, member: Candidate) -> float:
        """What a further member has to gain."""
        return study.numbers(member) * float(np.log(study.samples)) + _odds(study, member)

    def criterion(self, study: Study, fitted: Fit) -> float:
        """−2 log of how likely the recordings are under a set, the price of its numbers, and how plausible they and its members
        are; infinite of a fit that has lost the recordings.

        Every joint rubs or is damped as a rule; of other plain laws about one is expected to be missing, and one of all the rest.
        """
        if fitted.score >= LOST:
            return np.inf
        found = self.beside(study, fitted)
        prior = study.paid(fitted) + study.surprise(replace(fitted, x=found.x))
        return found.surprise + prior + sum(_odds(study, m) for m in fitted.hypothesis.members)


def evidence_over_the_state(study: Study, rough: Likelihood, along: Fit, reference: Fit) -> Evidence | None:
    """The measure for sets of a study; None where channels do not answer linearly to forces.

    along: the fit that is nearest to the recordings; forces act along its motion with what it leaves out made up for.
    reference: the plainest explanation; a test is calibrated by what it holds to be true.
    """
    if reference.score >= LOST:
        return None
    held, torque = study.whole(along.hypothesis), pull(study.problem.system)
    force = along_the_recordings(study.objective_under(rough, along), along, held, torque, study.swing)
    if force is None:
        return None

    def err_together(residuals: Sequence[Array]) -> Array:
        return np.maximum(hanging_together([r.reshape(force.channels, -1) for r in residuals]), 1.0)

    # Beside white noise the force would be as rough as it takes to leave nothing else.
    force.together = err_together(along.linear.residuals)
    usual = beside(force, study.objective_under(rough, reference), reference, study.whole(reference.hypothesis))
    force.together = err_together(usual.residuals)
    force.shape = usual.shape
    return Evidence(force, rough)


def placed(member: Candidate) -> bool:
    """Whether an effect is a wave chosen among many: numbers of periods, frequencies, phases.

    A stop, too, is looked for at many angles, but no force holds some of it: it is stiff, and acts beyond its angle alone.
    """
    return "phase" in member.effect.parameter_names


def waves_seen(study: Study, fitted: Fit, k: int) -> float:
    """How many whole waves of a member were seen, if it is a wave over an angle; 0 of what is none."""
    member = fitted.hypothesis.members[k]
    values = member.effect.named(study.predictor.effect_values(fitted.hypothesis, k, fitted.x))
    return visited(study, member) * values.get("periods", 0.0) / (2.0 * np.pi)


def visited(study: Study, member: Candidate) -> float:
    """Over how wide an angle a wave was seen [rad]: of its joint, or of what its sensor reads; 0 where that was not recorded."""
    problem = study.problem
    site = member.site if "." in member.site else f"{member.site}.position"
    names = [channel.name for channel in problem.channels]
    if site not in names:
        return 0.0
    read = [run.values[names.index(site)] for run in problem.runs]
    seen = np.concatenate([values[np.isfinite(values)] for values in read])
    return float(np.ptp(seen)) if len(seen) else 0.0


def piece_of_a_force(study: Study, fitted: Fit) -> bool:
    """Whether a set has a law that was chosen among many places and of which too little was seen to be more than that."""
    return any(_is_a_piece(study, fitted, k) for k in range(len(fitted.hypothesis.members)))


def _is_a_piece(study: Study, fitted: Fit, k: int) -> bool:
    return placed(fitted.hypothesis.members[k]) and waves_seen(study, fitted, k) < FEWEST_WAVES


def without_placed(study: Study, fitted: Fit) -> Fit:
    """The fit without what was chosen among many places: beside a force over the state such a law is a piece of that force.

    One of the places always fits some of what any force does, and recordings of one rig repeat that. Less than a whole wave is a
    piece of any smooth curve; waves that were seen whole stay.
    """
    kept = [k for k in range(len(fitted.hypothesis.members)) if not _is_a_piece(study, fitted, k)]
    if len(kept) == len(fitted.hypothesis.members):
        return fitted
    hypothesis = Hypothesis(tuple(fitted.hypothesis.members[k] for k in kept))
    count = len(study.predictor.nominal)
    spans = [fitted.hypothesis.span(k) for k in kept]
    x = np.concatenate([fitted.x[:count], *(fitted.x[count + span.start : count + span.stop] for span in spans)])
    return study.known(hypothesis) or study.fit(hypothesis, [x], fitted)


def plainest(weighed: Iterable[tuple[float, Fit]]) -> Fit:
    """Of fits that are not parted from the best one by their criteria, the one that predicts best with the fewest curious laws.

    Laws that are no plain ones can be bent to what nobody has named. Of plain laws and an unknown force that do about as well, the
    laws say more: those that make free runs better (Akaike's criterion) stand.
    """
    rows = list(weighed)
    alike = _within(rows, UNPARTED_EVIDENCE)
    fewest = min(curious(fitted) for _, fitted in alike)
    plain = _within([row for row in alike if curious(row[1]) == fewest], STRONG_EVIDENCE)
    return min((fitted for _, fitted in plain), key=lambda fitted: fitted.score + 2.0 * fitted.hypothesis.size)


def _within(rows: Sequence[tuple[float, Fit]], spare: float) -> list[tuple[float, Fit]]:
    """Those whose criterion is no more than so far from the lowest."""
    lowest = min(value for value, _ in rows)
    return [row for row in rows if row[0] <= lowest + spare]


def _odds(study: Study, member: Candidate) -> float:
    """Twice the logarithm of the odds against a member, before anything is recorded."""
    if member.effect.name in EVERYWHERE:
        return 2.0 * float(np.log(2.0))
    alike = sum(candidate.effect.plain == member.effect.plain for candidate in study.candidates)
    return 2.0 * (float(np.log(max(alike, 2))) + member.effect.rarity)


def curious(fitted: Fit) -> int:
    """How many members are no plain laws."""
    return sum(not member.effect.plain for member in fitted.hypothesis.members)
