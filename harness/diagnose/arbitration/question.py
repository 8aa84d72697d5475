"""The recordings as models are held against them: read once, taken alike by all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.provenance import provenance
from harness.diagnose.arbitration.constants import FAR_FROM_NOISE_RATIO
from harness.diagnose.arbitration.estimate import Estimate, estimated, off_the_bounds
from harness.diagnose.arbitration.freed import Freed
from harness.diagnose.arbitration.numbers import Number
from harness.diagnose.arbitration.runs import FreeRuns, free_runs, of_model, period, short_windows
from harness.diagnose.conditioning.conventions import conventional
from harness.diagnose.conditioning.free_motion import free_parts
from harness.diagnose.conditioning.held_start import released
from harness.diagnose.estimation.horizon import Horizon
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.problem import Problem, pose
from harness.diagnose.problem.windows import Window
from harness.errors import InputError
from harness.recording import Recording, read_recordings
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Question:
    """Recordings posed to a first model. made_from: as ``provenance`` tells it; quality: what was found in the recordings, and
    what was done about it."""

    problem: Problem
    deadline: Deadline
    made_from: dict[str, Any]
    quality: tuple[str, ...] = ()

    @property
    def likelihood(self) -> Likelihood:
        """Of the sensors' noise as readings scatter."""
        return Likelihood(self.problem, crude_colours(self.problem))

    def freed(self, system: System, every: Sequence[Number] = (), held: bool = False) -> Freed:
        """A model put to the same recordings. held: whether efforts stay from sample to sample."""
        return Freed(replace(of_model(self.problem, system), held=held), every, deadline=self.deadline)

    def estimate(self, systems: Sequence[System], every: Sequence[Number]) -> Estimate:
        """What the recordings say of the numbers, begun from each of the models; the best end, efforts held where that
        is better."""
        ways = [False, True] if self.problem.driven else [False]
        best: Estimate | None = None
        found: list[Estimate]
        for held in ways:
            if best is None:
                found = [estimated(self.freed(system, every, held)) for system in systems]
                if min(max(one.louder) for one in found) > FAR_FROM_NOISE_RATIO:
                    # Friction that a model has none of begins at a kink, where steps may come to nothing.
                    found += [estimated(one.freed, begin=off_the_bounds(one.freed)) for one in found]
            else:
                found = [best, estimated(self.freed(best.freed.system, every, held), best.fitted.windows, begin=best.x)]
            best = min(found, key=lambda one: one.fitted.score / sum(w.size for w in one.fitted.windows))
        assert best is not None
        return best

    def spans(self, estimate: Estimate) -> tuple[tuple[Window, ...], tuple[Window, ...]]:
        """Windows that models run freely over, of training recordings and of those held out: as long as motion can be
        foretold."""
        freed = estimate.freed
        first = len(self.problem.train)
        short = short_windows(self.problem, range(first, len(self.problem.runs)))
        horizon = Horizon(freed.problem, freed, 2.0 * np.pi / period(self.problem))
        calm = horizon.calm(short)
        return estimate.fitted.windows, horizon.joined(free_runs(freed, self.likelihood, calm, estimate.x).fitted)

    def run(self, freed: Freed, windows: Sequence[Window], x: Array | None = None) -> FreeRuns:
        """Free runs of a model as it is, or with numbers ``x``."""
        return free_runs(freed, self.likelihood, windows, np.zeros(len(freed.numbers)) if x is None else x)


def question(
    recordings: Sequence[str | Path | Recording],
    system: System,
    *,
    holdout: str | Path | Recording | None = None,
    mapping: Sequence[str] = (),
    deadline: Deadline | None = None,
) -> Question:
    """Read recordings and pose them to a model, as a diagnosis does.

    Raises InputError for recordings that cannot be used, and where there is no joint angle among what they measure.
    """
    items = [*recordings, *([holdout] if holdout is not None else [])]
    if not items:
        raise InputError("no recording given", mend="name at least one recording file")
    paths = [item for item in items if not isinstance(item, Recording)]
    from_files = iter(read_recordings(paths, mapping=mapping, system=system)) if paths else iter(())
    every = [item if isinstance(item, Recording) else next(from_files) for item in items]
    read = free_parts(system, released(conventional(system, every)))
    held = read.pop() if holdout is not None else None
    problem = pose(system, read, heldout=held)
    if not any(c.quantity == "position" for c in problem.channels):
        raise InputError(
            "the recordings measure no joint's position",
            mend="map a column to <joint>.position; models are judged on it",
        )
    told = provenance(system, [system], read, held)
    found = tuple(
        f"{r.name}: {note.words()}" for r in (*read, *([held] if held is not None else [])) for note in r.quality
    )
    return Question(problem, deadline or Deadline(), told, found)


def labels(models: Sequence[str | Path | System]) -> list[str]:
    """Names by which models are told: their files', whole paths where these are alike."""
    short = [m.name if isinstance(m, System) else Path(m).name for m in models]
    if len(set(short)) == len(short):
        return short
    whole = [m.name if isinstance(m, System) else str(m) for m in models]
    return whole if len(set(whole)) == len(whole) else [f"{name} ({k})" for k, name in enumerate(whole, 1)]
