"""Ways to predict find the numbers of a set from afar: a free run over many swings has many valleys, pieces of it have few."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.answer.ways_to_predict import Alone
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study

TIME, NOISE = np.arange(0.0, 25.0, 0.02), 1e-3


def test_a_start_that_loses_count_of_the_swings_is_led_in() -> None:
    truth = Rig()
    noise = NOISE * np.random.default_rng(7).standard_normal(len(TIME))
    run = recording("run", TIME, {"pivot.position": swing(truth, 0.6, TIME) + noise})
    system = nominal(tolerance=1e-4)
    problem = pose(system, [run])
    member = next(c for c in candidates(system, [run]) if c.effect.name == "added_inertia")
    study = Study(
        problem,
        Predictor(problem),
        Likelihood(problem, (Colour(NOISE, interval=0.02),)),
        (member,),
        whole(problem.runs, [0]),
    )
    outcome: Any = SimpleNamespace(
        problem=problem, predictor=study.predictor, study=study, training=study,
        period=2.0 * np.pi * np.sqrt(truth.about_joint / truth.moment),
    )  # fmt: skip
    # 70 % more inertia makes the period 30 % longer: six swings too few over the recording.
    x = np.concatenate(
        [np.zeros(len(study.predictor.nominal)), to_internal(member, np.array([0.7 * truth.about_joint]))]
    )
    found = Alone(outcome, Hypothesis((member,)), x).learned(study.windows).fitted
    assert found.score / study.samples == pytest.approx(1.0, abs=0.15)
