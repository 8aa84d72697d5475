"""How exactly a late release is known: by the samples that stood still, not by a slope that speed at letting go makes up for.

Let go δ later with the speed gained by then, a·δ, the motion is the same; only what it was held at lies a·δ²/2 away. That is known
as the mean of the held samples is, to noise/√(held), so that at 95 % δ = √(2 · 1.96 · noise/√held / a).
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.profile_likelihood import profiled
from harness.diagnose.selection.study import Study

NOISE, RATE, ANGLE = 1e-3, 200.0, 1.2


@pytest.mark.parametrize(("seed", "late"), [(0, 0.25), (1, 0.08), (6, 0.25)])
def test_the_interval_is_that_of_the_samples_that_stood_still(seed: int, late: float) -> None:
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    seen = swing(Rig(), ANGLE, np.maximum(time - late, 0.0)) + NOISE * rng.standard_normal(len(time))
    system, runs = nominal(tolerance=0.01), [recording("run", time, {"pivot.position": seen})]
    posed = pose(system, runs)
    likelihood = Likelihood(posed, crude_colours(posed))
    every = tuple(candidates(system, runs))
    study = Study(posed, Predictor(posed), likelihood, every, whole(posed.runs, range(1)))
    (release,) = (c for c in every if c.effect.name == "late_release")
    x = np.concatenate([np.zeros(len(study.predictor.nominal)), to_internal(release, np.array([late]))])
    best = study.fit(Hypothesis((release,)), [x], None, most_steps=40)
    curvature = estimates(study.predictor, best, 0)
    found = profiled(study, best, 0, curvature)["delay"]

    rig = Rig()
    acceleration = rig.moment * np.sin(ANGLE) / rig.about_joint
    expected = np.sqrt(2.0 * 1.96 * NOISE / np.sqrt(late * RATE) / acceleration)
    assert found.low < late < found.high
    assert 0.6 * expected < 0.5 * (found.high - found.low) < 1.7 * expected
    # What the slope alone would have said: next to nothing.
    assert curvature["delay"].high - curvature["delay"].low > 8.0 * expected
