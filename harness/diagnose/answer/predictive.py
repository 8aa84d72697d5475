"""The model that predicts best, beside the one that is claimed: doubt costs a claim, and need not cost a prediction.

What may be claimed has to stand against everything that could imitate it; what predicts has only to predict. Sets that the search
came near, the ordinary dissipation of every joint all at once, and a few of these with the force over the state that they leave
out are held against one another by cross-validation within the training recordings. Sets are fitted by least squares of what the
sensors read. The data held out have no say in the choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.augmented import attached, augmented
from harness.diagnose.answer.constants import NEAREST_SETS
from harness.diagnose.answer.cross_validation import Leaves, chosen, groups, leaves
from harness.diagnose.answer.explain import NO_FINDING
from harness.diagnose.answer.ways_to_predict import Alone, Learned, Way, WithForce, can_have_force, free_run
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import start_vector
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.dissipation_starts import PLAIN, plain_sets
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.wald_test import carried
from harness.effects.force_table import NAME, ForceTable
from harness.system import Attachment, System

Array = NDArray[np.float64]

GAIN = "actuator_gain"  # of inertia, weight and torque two show where a torque is known
FURTHER = ("further models that may predict best", NO_FINDING)  # left if the time is up


@dataclass(frozen=True, eq=False)
class Predictive:
    """The best predicting set: fitted to the training recordings, judged on the data held out, and the model with it.

    table: the force over the state that acts in it, if one does.
    """

    fitted: Fit
    held: Fit
    system: System
    table: ForceTable | None = None


def predictive(outcome: Outcome, conclusion: Conclusion) -> Predictive | None:
    """The way that predicts best; None where noise is all that is left, or there is nothing to cross-validate by."""
    folds = groups(outcome.training.windows)
    if outcome.force is None or len(folds) < 2:
        return None
    fits = _fitted(outcome, _sets(outcome, conclusion, plain_sets(outcome.study, [(*PLAIN, GAIN)])))
    ways: list[Way] = [Alone(outcome, own.hypothesis, own.x, own.states) for own in fits]
    rows = [_tried(outcome, way, folds, own.hypothesis.size) for way, own in zip(ways, fits, strict=True)]
    plainly = chosen(rows)
    if plainly is None:
        return None
    if outcome.evidence is not None:
        asked = {frozenset[str](), conclusion.own.hypothesis.identity, fits[plainly].hypothesis.identity}
        nodes = len(outcome.evidence.force.joint)
        for own in fits:
            if own.hypothesis.identity in asked and can_have_force(outcome, own.hypothesis):
                way = WithForce(outcome, outcome.evidence, own)
                ways.append(way)
                rows.append(_tried(outcome, way, folds, own.hypothesis.size + nodes))
    best = chosen(rows)
    assert best is not None  # as some way leads somewhere
    with outcome.predictor.deadline.spared():
        found = ways[best].learned(outcome.training.windows) or ways[plainly].learned(outcome.training.windows)
        if found is None:
            return None
        own = found.fitted
        held = free_run(outcome, own.hypothesis, own.x, outcome.held_windows)
        return Predictive(own, held, _system(outcome, found), found.table)


def _tried(outcome: Outcome, way: Way, folds: Sequence[tuple[Window, ...]], numbers: int) -> Leaves:
    """What a way leaves of stretches that it was not fitted to; everything where there is no time to see that."""
    everything = np.full(len(folds), np.inf)
    return outcome.predictor.deadline.attempt(
        *FURTHER, partial(leaves, outcome, way, folds, numbers), lambda: Leaves(everything, everything, everything, 0)
    )


def _sets(outcome: Outcome, conclusion: Conclusion, ordinary: Sequence[Hypothesis]) -> list[tuple[Hypothesis, Array]]:
    """Sets that may predict best, each with numbers to begin at; those with fewer members first."""
    near = [f for f in outcome.ordered if f.hypothesis.keys != conclusion.own.hypothesis.keys][:NEAREST_SETS]
    found = {f.hypothesis.identity: (f.hypothesis, f.x) for f in (conclusion.own, *near)}
    for hypothesis in (Hypothesis(), *ordinary):
        found.setdefault(hypothesis.identity, (hypothesis, _usual(outcome, hypothesis)))
    return sorted(found.values(), key=lambda pair: len(pair[0].members))


def _usual(outcome: Outcome, hypothesis: Hypothesis) -> Array:
    """Numbers of a set as stated, and of its effects as they usually are."""
    nominal = np.zeros(len(outcome.predictor.nominal))
    return np.concatenate([nominal, *map(start_vector, hypothesis.members)])


def _fitted(outcome: Outcome, sets: Sequence[tuple[Hypothesis, Array]]) -> list[Fit]:
    """Sets fitted to the training windows.

    A set leaves no more than any part of it: each is begun from its parts as well, with what these have not absent.
    """
    windows, found = outcome.training.windows, list[Fit]()
    for hypothesis, x in sets:
        own = Alone(outcome, hypothesis, x).learned(windows).fitted
        for part in [f for f in found if f.hypothesis.identity < hypothesis.identity]:
            _, start = carried(part.hypothesis, part.x, hypothesis, _usual(outcome, hypothesis))
            if part.score < own.score and np.isfinite(start).all():
                again = Alone(outcome, hypothesis, start, part.states).learned(windows).fitted
                own = min(own, again, key=lambda f: f.score)
        found.append(own)
    return found


def _system(outcome: Outcome, found: Learned) -> System:
    """The model with what predicts best attached."""
    own = found.fitted
    named = [
        (m, estimates(outcome.predictor, own, k)) for k, m in enumerate(own.hypothesis.members) if m.effect.name != NAME
    ]
    system = augmented(outcome.problem.system, outcome.predictor.nominal, own.x, named)
    if found.table is None:
        return system
    further = [Attachment(NAME, joint, {"table": float(k)}) for k, joint in enumerate(found.table.joints)]
    return attached(system, further)
