"""Recordings and windows on which models are held against one another, the same for all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.arbitration.constants import STATE_FIT_STEPS
from harness.diagnose.arbitration.freed import NOTHING, Freed, FreedObjective, lower_bounds
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.objective import States
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.problem.constants import SHORT_WINDOW_SWINGS
from harness.diagnose.problem.problem import Problem, Run
from harness.diagnose.problem.windows import Window, cut
from harness.effects.scale import swings
from harness.system import System

Array = NDArray[np.float64]


def of_model(problem: Problem, system: System) -> Problem:
    """The same recordings put to another model of the same joints."""
    order = [problem.system.joint_names.index(name) for name in system.joint_names]

    def put(runs: Sequence[Run]) -> tuple[Run, ...]:
        return tuple(r if r.effort is None else replace(r, effort=r.effort[:, order]) for r in runs)

    return replace(problem, system=system, train=put(problem.train), heldout=put(problem.heldout))


def period(problem: Problem) -> float:
    """Of the slowest swing [s]."""
    return 2.0 * np.pi / min(swings(problem.system))


def short_windows(problem: Problem, which: Sequence[int]) -> tuple[Window, ...]:
    """Windows of a swing and a half."""
    return cut(problem.runs, which, SHORT_WINDOW_SWINGS * period(problem))


@dataclass(frozen=True, eq=False)
class FreeRuns:
    """Free runs of a model over windows, their initial states fitted: what each differs by from the recording, (C, T) a
    window."""

    fitted: Fit
    left: tuple[Array, ...]
    predicted: tuple[Array, ...]


def free_runs(
    freed: Freed, likelihood: Likelihood, windows: Sequence[Window], x: Array, states: States | None = None
) -> FreeRuns:
    """Free runs with numbers ``x``, nothing but initial states fitted; states: to begin with, else as recordings
    read."""
    windows = tuple(windows)
    read = {w: measured_state(freed.problem, freed, w) for w in windows}
    objective = FreedObjective(freed, likelihood, NOTHING, windows, lower_bounds(freed))
    frozen = np.ones(len(x), dtype=bool)
    others = [read] if states is not None else []
    begun = {**read, **{w: s for w, s in (states or {}).items() if w in read and s.shape == read[w].shape}}
    found = fit(objective, x, begun, fixed=frozen, most_steps=STATE_FIT_STEPS, others=others)
    predicted = freed.predict(NOTHING, x[None], [(0, w, found.states[w]) for w in windows])
    left = tuple(p - freed.runs[w.run].values[:, w.first : w.last] for p, w in zip(predicted, windows, strict=True))
    return FreeRuns(found, left, tuple(predicted))
