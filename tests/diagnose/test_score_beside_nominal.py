"""Score tests of what nearly acts like a nominal quantity: a weak spring gets a swing out of step as a lighter link does.

Only what is left when both are taken together parts them, a ten thousandth of what either does. The change that the test is made of
has to be linear to better than that, or nothing of the spring is seen.
"""

from __future__ import annotations

import numpy as np
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study

SPRING, NOISE, RATE = 0.006, 5e-4, 200.0  # N·m/rad; rad; Hz


def test_a_weak_spring_promises_what_it_keeps() -> None:
    system = nominal()
    runs = releases(Rig(torque=lambda t, q, v: -SPRING * q), (0.9, -0.5), NOISE, seed=5, duration=16.0, rate=RATE)
    posed = pose(system, runs)
    (spring,) = candidates(system, runs, only=["joint_stiffness"])
    likelihood = Likelihood(posed, (Colour(white=NOISE, interval=1.0 / RATE),))
    study = Study(posed, Predictor(posed), likelihood, (spring,), whole(posed.runs, range(2)))
    empty = study.empty()
    (scored,) = study.ranked(empty)
    # The fit is the truth: begun at the spring that was simulated.
    start = np.concatenate([empty.x, to_internal(spring, np.array([SPRING, 0.0]))])
    fitted = study.fit(Hypothesis((spring,)), [start], empty)
    kept = empty.score - fitted.score
    assert kept > 30.0
    assert 0.7 * kept < scored.gain < 1.3 * kept
