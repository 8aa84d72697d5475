"""What shows in the data held out alone: a stop that no other recording reaches, a friction that matters in small swings only.

Fitted to them, it would have been confirmed by nothing. So the recordings held out are cut into short stretches, and every second
one, with the training data, has to speak for the effect and to predict the stretches between, and these the others in turn.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linear_response import begun, motions
from harness.diagnose.estimation.objective import States
from harness.diagnose.problem.constants import SHORT_WINDOW_SWINGS
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.outcome import Outcome


def held_names(outcome: Outcome) -> list[str]:
    """The recordings held out."""
    return [outcome.problem.runs[run].name for run in _held_runs(outcome)]


def _held_runs(outcome: Outcome) -> list[int]:
    return sorted({window.run for window in outcome.held_windows})


def held_out_repeats(outcome: Outcome, smaller: Fit, larger: Fit, price: float) -> bool:
    """Whether either half of the stretches held out gains more than ``price`` by the larger set, and so does the other half as the
    fit to the first one, and to the training data, predicts it from initial states of its own."""
    # Within the windows, whose motion is known: where a motion is wild, they are short themselves.
    pieces = [piece for window in outcome.held_windows for piece in _pieces(outcome, window)]
    halves = pieces[::2], pieces[1::2]
    # A single stretch has nothing to predict.
    return len(pieces) > 1 and all(
        _gains(outcome, smaller, larger, fitted, predicted) > price for fitted, predicted in (halves, halves[::-1])
    )


def _pieces(outcome: Outcome, window: Window) -> tuple[Window, ...]:
    """A window cut into stretches of a swing and a half, or as it is if it is no longer than that."""
    duration = window.size * outcome.problem.runs[window.run].interval
    return equal_parts(window, max(1, round(duration / (SHORT_WINDOW_SWINGS * outcome.period))))


def _gains(outcome: Outcome, smaller: Fit, larger: Fit, fitted: Sequence[Window], predicted: Sequence[Window]) -> float:
    """What the larger set gains where it is fitted or where it is predicted, whichever is less."""
    here, there = zip(*(_costs(outcome, each, fitted, predicted) for each in (smaller, larger)), strict=True)
    return min(here[0] - here[1], there[0] - there[1])


def _costs(outcome: Outcome, near: Fit, fitted: Sequence[Window], predicted: Sequence[Window]) -> tuple[float, float]:
    """Score of a set fitted to the training data and some stretches, and what it leaves of others."""
    objective, whole = outcome.study.objective(near.hypothesis), outcome.training.windows
    along = motions(outcome.predictor, near, outcome.held_windows)

    def states(pieces: Sequence[Window]) -> States:
        return {piece: begun(along, outcome.problem.runs[piece.run], piece) for piece in pieces}

    own = fit(objective.on([*whole, *fitted]), near.x, {**{w: near.states[w] for w in whole}, **states(fitted)})
    held = np.ones(len(own.x), dtype=bool)
    return own.score, fit(objective.on(predicted), own.x, states(predicted), fixed=held).cost


def with_all(outcome: Outcome, best: Fit) -> tuple[Fit, Fit]:
    """The fit to all recordings as it stands on the training data, and on those held out."""
    held = np.ones(len(best.x), dtype=bool)
    objective = outcome.study.objective(best.hypothesis)
    parts = (outcome.training.windows, outcome.held_windows)
    own, out = (fit(objective.on(part), best.x, {w: best.states[w] for w in part}, fixed=held) for part in parts)
    return own, out
