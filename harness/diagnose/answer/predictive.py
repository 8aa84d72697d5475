"""The model that predicts best, beside the one that is claimed: doubt costs a claim, and need not cost a prediction.

What may be claimed has to stand against everything that could imitate it; what predicts has only to predict. Sets that the search
came near, and the ordinary dissipation of every joint all at once, are held against one another by cross-validation within the
training recordings (Stone, J. R. Statist. Soc. B 36 (1974) 111), fitted by least squares of what the sensors read. The data held
out have no say in the choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.augmented import augmented
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.prediction.coordinates import start_vector
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.dissipation_starts import plain_set
from harness.diagnose.selection.investigation import Outcome
from harness.system import System

ZERO = "sensor_offset"  # of the ordinary set
NEAREST = 3  # sets of the search beside the one claimed
MOST_FOLDS = 3
MOST_JOINTS = 3  # of which the ordinary set has the dissipation of all
FEWEST_IN_PART = 25  # samples of a stretch that is left out
STEPS = 15


@dataclass(frozen=True, eq=False)
class Predictive:
    """The best predicting set: fitted to the training recordings, judged on the data held out, and the model with it."""

    fitted: Fit
    held: Fit
    system: System


def predictive(outcome: Outcome, conclusion: Conclusion) -> Predictive | None:
    """The set that predicts best; None where noise is all that is left, or there is nothing to cross-validate by."""
    folds = _folds(outcome)
    if outcome.force is None or len(folds) < 2:
        return None
    near = [f for f in outcome.ordered if f.hypothesis.keys != conclusion.own.hypothesis.keys][:NEAREST]
    starts = [(f.hypothesis, f.x) for f in (conclusion.own, *near)]
    ordinary = _ordinary(outcome)
    if ordinary is not None:
        starts.append(ordinary)
    ranked = [(_left(outcome, hypothesis, x, folds), k) for k, (hypothesis, x) in enumerate(starts)]
    hypothesis, x = starts[min(ranked)[1]]
    objective = _objective(outcome, hypothesis)
    own = fit(
        objective.on(outcome.training.windows),
        x,
        _states(outcome, hypothesis, outcome.training.windows),
        most_steps=2 * STEPS,
    )
    held = _free_run(outcome, own, outcome.held_windows)
    members = [(m, estimates(outcome.predictor, own, k)) for k, m in enumerate(hypothesis.members)]
    return Predictive(own, held, augmented(outcome.problem.system, outcome.predictor.nominal, own.x, members))


def _folds(outcome: Outcome) -> list[tuple[Window, ...]]:
    """Training windows in groups to be left out one after the other: by recording, or by stretch where there is only one.

    A single stretch is cut, and each part predicted from where it begins.
    """
    windows = outcome.training.windows
    if len(windows) == 1 and windows[0].size >= MOST_FOLDS * FEWEST_IN_PART:
        windows = tuple(equal_parts(windows[0], MOST_FOLDS))
    runs = list(dict.fromkeys(w.run for w in windows))
    groups = [[w for w in windows if w.run == run] for run in runs] if len(runs) > 1 else [[w] for w in windows]
    count = min(len(groups), MOST_FOLDS)
    return [tuple(w for group in groups[k::count] for w in group) for k in range(count)]


def _ordinary(outcome: Outcome) -> tuple[Hypothesis, NDArray[np.float64]] | None:
    """The ordinary dissipation of every joint, an inertia and a zero: what a plain least-squares fit has."""
    if len(outcome.problem.system.movable_joints) > MOST_JOINTS:
        return None
    hypothesis = plain_set(outcome.study.candidates, ZERO)
    if not hypothesis.members:
        return None
    nominal = np.zeros(len(outcome.predictor.nominal))
    return hypothesis, np.concatenate([nominal, *map(start_vector, hypothesis.members)])


def _objective(outcome: Outcome, hypothesis: Hypothesis) -> Objective:
    return replace(outcome.study.objective(hypothesis), likelihood=outcome.study.likelihood.of_sensors)


def _states(outcome: Outcome, hypothesis: Hypothesis, windows: Sequence[Window]) -> dict[Window, NDArray[np.float64]]:
    every = outcome.study.states_for(hypothesis)
    return {w: every[w] if w in every else outcome.study.read_off(hypothesis, w) for w in windows}


def _free_run(outcome: Outcome, own: Fit, windows: Sequence[Window]) -> Fit:
    """Nothing but the initial states fitted."""
    objective = _objective(outcome, own.hypothesis).on(windows)
    frozen = np.ones(len(own.x), dtype=bool)
    return fit(objective, own.x, _states(outcome, own.hypothesis, windows), fixed=frozen, most_steps=STEPS)


def _left(
    outcome: Outcome, hypothesis: Hypothesis, x: NDArray[np.float64], folds: Sequence[tuple[Window, ...]]
) -> float:
    """What a set leaves of the training windows when each group is predicted from the others."""
    objective, total = _objective(outcome, hypothesis), 0.0
    for k, fold in enumerate(folds):
        rest = tuple(w for other in (*folds[:k], *folds[k + 1 :]) for w in other)
        own = fit(objective.on(rest), x, _states(outcome, hypothesis, rest), most_steps=STEPS)
        total += _free_run(outcome, own, fold).cost
    return total
