"""What a model leaves of data held out is told from where it fits them best, not from wherever its initial states had been led."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.outcome import judged
from harness.diagnose.selection.study import Study

TIME, NOISE = np.arange(0.0, 6.0, 0.01), 1e-3


@pytest.mark.parametrize("astray", [(0.6, 0.0), (0.6, 18.0), (3.0, -2.0)], ids=["near", "turning round", "upside down"])
def test_a_free_run_held_out_is_judged_from_the_state_that_is_read(astray: tuple[float, float]) -> None:
    random = np.random.default_rng(7)
    runs = [
        recording(
            f"run{k}", TIME, {"pivot.position": swing(Rig(), angle, TIME) + NOISE * random.standard_normal(len(TIME))}
        )
        for k, angle in enumerate((0.9, 0.6))
    ]
    problem = pose(nominal(tolerance=1e-4), runs)
    likelihood = Likelihood(problem, (Colour(NOISE, interval=0.01),))
    study = Study(problem, Predictor(problem), likelihood, (), whole(problem.runs, [0, 1]))
    own = study.empty()
    (held,) = (w for w in study.windows if w.run == 1)
    led: Any = SimpleNamespace(hypothesis=own.hypothesis, states={held: np.array(astray)})
    outcome: Any = SimpleNamespace(judged={}, study=study, held_windows=(held,))
    found = judged(outcome, led, own)
    assert found.cost / held.size == pytest.approx(1.0, abs=0.2)
