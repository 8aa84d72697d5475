"""Slopes of weak parameters where runs are uneven: friction that gives way switches a little earlier or later from run to run.

An adaptive integrator's error jumps by 1e-3 of the noise there (norm of the whitened prediction, measured below). A difference
quotient over too short a step is that jump, thousands of times the slope of a parameter which hardly matters.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linearisation import linearise, sharply
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study

DRY, NOISE, RATE = 0.004, 5e-4, 200.0
TIME, INERTIA = 0.006, 0.02  # s; kg·m²


def test_a_weak_slope_is_not_the_unevenness_of_the_runs() -> None:
    system = nominal()
    system = system.replace_joint(replace(system.joint("pivot"), friction=DRY))
    runs = releases(Rig(torque=lambda t, q, v: -DRY * np.sign(v)), (0.6, -0.4), NOISE, seed=2, duration=15.0, rate=RATE)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=["friction_softness"]))
    likelihood = Likelihood(posed, (Colour(white=NOISE, interval=1.0 / RATE),))
    study = Study(posed, Predictor(posed), likelihood, known, whole(posed.runs, range(2)))
    hypothesis = Hypothesis(known)
    objective, states = study.objective(hypothesis), study.states_for(hypothesis)
    x = np.concatenate([np.zeros(len(study.predictor.nominal)), to_internal(known[0], np.array([TIME, INERTIA]))])

    # By steps so long that they change the prediction by far more than the unevenness.
    def slope(k: int, step: float) -> np.ndarray:
        moved = np.eye(len(x))[k] * step
        (_, there), (_, back) = objective.residuals([(x + moved, states), (x - moved, states)])
        return np.concatenate([(a - b).ravel() for a, b in zip(there, back, strict=True)]) / (2.0 * step)

    view = linearise(objective, x, states)
    for _ in range(3):
        view = linearise(objective, x, states, nearby=view)
    sharp = sharply(objective, x, states, view)
    # A nominal quantity, and e-folds of the time and of the inertia; the last one hardly matters, and no more may be said of it.
    for k, step in ((0, 1e-3), (len(x) - 2, 0.02), (len(x) - 1, 0.1)):
        true = slope(k, step)
        for found, least in ((view, 5.0), (sharp, 1.0)):
            told = np.concatenate([columns[:, k] for columns in found.shared])
            assert np.linalg.norm(told - true) < max(least, 0.05 * np.linalg.norm(true)), (k, np.linalg.norm(true))
