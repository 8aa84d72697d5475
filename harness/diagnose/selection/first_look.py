"""The nominal model on short windows, and the sensors' noise behind it: without these there is no answer at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.diagnose.estimation.horizon import Horizon
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.estimation.vibration_windows import stages
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.constants import SHORT_WINDOW_SWINGS
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window, cut
from harness.diagnose.selection.constants.starts import MOTION_HARMONICS
from harness.diagnose.selection.effort_hold import either_way
from harness.diagnose.selection.noise_behind import colours_from
from harness.diagnose.selection.study import Study


def first_look(
    predictor: Predictor, candidates: tuple[Candidate, ...], period: float, horizon: Horizon
) -> tuple[Study, Fit]:
    """The study of short windows and the nominal model in it, however little time there is.

    period: of the slowest swing [s].
    """
    problem, deadline = predictor.problem, predictor.deadline
    likelihood = Likelihood(problem, crude_colours(problem), lead=0.0)
    with deadline.spared():
        short = horizon.calm(cut(problem.runs, range(len(problem.runs)), SHORT_WINDOW_SWINGS * period))
        first = _led_in(problem, predictor, likelihood, short, period)
        for _ in range(2):
            colours = colours_from(problem, likelihood, first, predictor, MOTION_HARMONICS / period)
            likelihood = replace(likelihood, colours=colours)
            study = Study(problem, predictor, likelihood, candidates, short, first_states=first.states, swing=period)
            study.fit(Hypothesis(), [first.x], first)
            study, first = (study, study.empty()) if deadline.over else either_way(study, study.empty())
            problem, predictor, likelihood = study.problem, study.predictor, study.likelihood
            if deadline.over:
                break
    return study, first


def _led_in(
    problem: Problem, predictor: Predictor, likelihood: Likelihood, windows: Sequence[Window], period: float
) -> Fit:
    """The nominal model fitted on short windows, by way of shorter ones where its vibrations could slip by a cycle."""
    near: Fit | None = None
    x = np.zeros(len(predictor.nominal))
    ways = [*stages(problem, windows), tuple(windows)]
    for k, cuts in enumerate(ways):
        if near is not None and predictor.deadline.over and k < len(ways) - 1:
            continue
        study = Study(problem, predictor, likelihood, (), cuts, swing=period)
        near = study.fit(Hypothesis(), [x], None if near is None else near.beginning(cuts))
        x = near.x
    assert near is not None
    return near
