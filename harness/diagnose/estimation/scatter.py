"""Noise of the sensors as the recordings alone show it: how rough readings are from sample to sample."""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.constants import EXACT_SCATTER
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.constants import RUN_TOLERANCE
from harness.diagnose.problem.problem import Problem


def crude_colours(problem: Problem) -> tuple[Colour, ...]:
    """White noise from third differences, robustly: a first guess that needs no model."""
    out = []
    for c in range(len(problem.channels)):
        sizes = [run.roughness[c] for run in problem.train]
        out.append(Colour(max(float(np.median(sizes)), quietest(problem, c)), interval=problem.train[0].interval))
    return tuple(out)


def quietest(problem: Problem, channel: int) -> float:
    """The least noise a channel can have: its resolution, or what the computed motion itself is certain to."""
    extent = float(np.nanmax([np.nanmax(np.abs(run.values[channel])) for run in problem.train]))
    # What stays at rest has no extent, and is still computed no better than to the error of every step, added up as by chance.
    computed = RUN_TOLERANCE * np.sqrt(max(len(run.time) for run in problem.train))
    return max(problem.steps[channel] / np.sqrt(12.0), EXACT_SCATTER * extent, float(computed))
