"""Whether one event in every recording does as well as a wave that goes on all the time.

A link that is bumped once, or pushed for a while, swings on with another amplitude and phase. Near the frequency of its swing so
does one whose base shakes a little all along, and a handful of recordings may fit a wave to what was one blow. What happened before
the event and after it is then explained by free motion alone, from an initial state of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import EVENT_EXCHANGES, EVENT_PERIODS, EVENT_ROUNDS, EVENT_STRIDE_PERIODS
from harness.diagnose.criticism.members import shakes
from harness.diagnose.criticism.reason import Reason, Suspect
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linear_response import Response, begun, motions
from harness.diagnose.estimation.linearisation import linearise
from harness.diagnose.estimation.objective import States
from harness.diagnose.problem.windows import Window, contains
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.score_tests import carry_state

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cut:
    """One way to cut a recording: what its pieces leave is |vector + matrix δ|² where parameters move by δ.

    kept: what the wave leaves of the same samples.
    """

    pieces: tuple[Window, ...]
    matrix: Array
    vector: Array
    kept: float

    def lag(self, by: Array) -> float:
        """How much worse than the wave it does where parameters have moved."""
        return float(np.sum((self.vector + self.matrix @ by) ** 2)) - self.kept


def _event_as_well(suspect: Suspect) -> bool:
    """Whether what shakes stands in for one event in every recording.

    So it does if the set without it, each recording cut at one moment, explains the rest no worse than the set with it explains
    the same. The numbers that the cuts add are not counted: blows are common, and what could be one is no wave. A wave that is
    there goes on before the cut and after it.
    """
    outcome, best, smaller = suspect.outcome, suspect.best, suspect.smaller
    if not shakes(best.hypothesis.members[suspect.places[0]]):
        return False
    along = motions(outcome.predictor, best, best.windows)
    objective = outcome.study.objective(smaller.hypothesis)
    x, lag = smaller.x, np.inf
    for _ in range(EVENT_ROUNDS):
        chosen = _best(_cuts(outcome, best, smaller, x, along), x[: objective.nominal])
        pieces = [piece for cut in chosen for piece in cut.pieces]
        states = _states(outcome, best, smaller, along, pieces)
        without = fit(objective.on(pieces), x, states)
        x = without.x
        lag = min(lag, without.score - best.prior - sum(cut.kept for cut in chosen))
    return lag <= 0.0


def _cuts(outcome: Outcome, best: Fit, smaller: Fit, x: Array, along: Sequence[Response]) -> list[list[Cut]]:
    """The ways to cut every recording, with initial states that suit the parameters ``x``; not at all is one."""
    objective = outcome.study.objective(smaller.hypothesis)
    ways = []
    for run in sorted({w.run for w in best.windows}):
        own = [w for w in best.windows if w.run == run]
        halves = [(window, pair) for window in own for pair in _halves(outcome, window)]
        ways.append(
            [tuple(own)]
            + [tuple(p for w in own for p in (pair if w == window else (w,))) for window, pair in halves]
        )  # fmt: skip
    pieces = sorted({p for run in ways for way in run for p in way}, key=lambda p: (p.run, p.first, p.last))
    states = _states(outcome, best, smaller, along, pieces)
    held = fit(objective.on(pieces), x, states, fixed=np.ones(len(x), dtype=bool))
    view = linearise(objective.on(pieces), x, held.states, upper=objective.bounds()[1])
    # As many rows are left of a piece as there are parameters, and one; of a shorter piece all of them.
    counts = [min(len(r), len(x) + 1) for r in view.residuals]
    rows = np.split(np.arange(len(view.vector)), np.cumsum(counts)[:-1])
    place = {piece: rows[k] for k, piece in enumerate(pieces)}

    def cut(way: tuple[Window, ...]) -> Cut:
        index = np.concatenate([place[piece] for piece in way])
        return Cut(way, view.matrix[index], view.vector[index], sum(_left(best, piece) for piece in way))

    return [[cut(way) for way in run] for run in ways]


def _best(cuts: Sequence[Sequence[Cut]], nominal: Array) -> list[Cut]:
    """One cut of every recording, together closest to the wave when the parameters follow them.

    nominal: where the nominal quantities stand, in deviations of their prior. From every single cut on, for what is right beside
    parameters that the event has bent may be wrong beside the others.
    """
    chosen: list[Cut] = []
    lowest = np.inf
    for seed in (cut for run in cuts for cut in run):
        own = [seed]
        by = _followed(own, nominal)
        for _ in range(EVENT_EXCHANGES):
            found = [min(run, key=lambda c: c.lag(by)) for run in cuts]
            if found == own:
                break
            own = found
            by = _followed(own, nominal)
        lag = sum(c.lag(by) for c in own) + float(np.sum((nominal + by[: len(nominal)]) ** 2))
        if lag < lowest:
            chosen, lowest = own, lag
    return chosen


def _followed(cuts: Sequence[Cut], nominal: Array) -> Array:
    """How far the parameters move to fit some cuts best, (P,)."""
    size = cuts[0].matrix.shape[1]
    prior = np.eye(size)[: len(nominal)]
    matrix = np.vstack([*(cut.matrix for cut in cuts), prior])
    vector = np.concatenate([*(cut.vector for cut in cuts), nominal])
    return np.asarray(np.linalg.lstsq(matrix, -vector, rcond=1e-9)[0])


def _states(outcome: Outcome, best: Fit, smaller: Fit, along: Sequence[Response], pieces: Sequence[Window]) -> States:
    """Where pieces of the recordings begin on the motion of ``best``, in the coordinates of ``smaller``."""
    before, after = best.hypothesis, smaller.hypothesis
    there = {piece: begun(along, outcome.problem.runs[piece.run], piece) for piece in pieces}
    return {piece: carry_state(outcome.predictor, before, after, state) for piece, state in there.items()}


def _left(best: Fit, piece: Window) -> float:
    """What a fit leaves of a part of one of its windows."""
    number = next(k for k, window in enumerate(best.windows) if contains(window, piece))
    window = best.windows[number]
    residual = best.linear.residuals[number].reshape(-1, window.size)
    return float(np.sum(residual[:, piece.first - window.first : piece.last - window.first] ** 2))


def _halves(outcome: Outcome, window: Window) -> list[tuple[Window, Window]]:
    """A window cut at evenly spaced moments, what lies around each of them left out."""
    period = outcome.period
    time = outcome.problem.runs[window.run].time[window.first : window.last]
    moments = np.arange(time[0] + period, time[-1] - period, EVENT_STRIDE_PERIODS * period)
    ends = window.first + np.searchsorted(time, moments - 0.5 * EVENT_PERIODS * period)
    begins = window.first + np.searchsorted(time, moments + 0.5 * EVENT_PERIODS * period)
    return [
        (Window(window.run, window.first, int(a)), Window(window.run, int(b), window.last))
        for a, b in zip(ends, begins, strict=True)
        if a > window.first and b < window.last
    ]


REASON = Reason("one event in every recording does as well", _event_as_well)
