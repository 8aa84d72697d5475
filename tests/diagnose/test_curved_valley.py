"""A fit along a narrow and curved valley: a load that the nominal quantities, bent far, had stood for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness.diagnose.estimation.least_squares import fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.effects.scale import tip_of

LOAD = 0.27 * MASS
ARMATURE, DAMPING = 4e-3, 3e-4


def test_the_fit_reaches_the_bottom_from_where_the_bent_model_stands() -> None:
    plain = nominal(tolerance=0.005)
    (joint,) = plain.joints
    system = plain.replace_joint(replace(joint, armature=ARMATURE, damping=DAMPING))
    reach = float(np.linalg.norm(tip_of(system.links[0], system)))
    # A point mass at the end: moments about the joint add.
    mass = MASS + LOAD
    com = (MASS * COM + LOAD * reach) / mass
    about = INERTIA + MASS * COM**2 + LOAD * reach**2 + ARMATURE
    rig = Rig(mass=mass, com=com, inertia=about - mass * com**2, viscous=DAMPING)
    runs = releases(rig, (0.7, 1.3), 1e-4, seed=3, duration=15.0, rate=250.0)
    posed = pose(system, runs)
    predictor, likelihood = Predictor(posed), Likelihood(posed, crude_colours(posed))
    windows = whole(posed.runs, range(2))
    states = {w: measured_state(posed, predictor, w) for w in windows}

    def posing(hypothesis: Hypothesis) -> Objective:
        return Objective(predictor, likelihood, hypothesis, windows)

    bent = fit(posing(Hypothesis()), np.zeros(len(predictor.nominal)), states, most_steps=40)
    assert bent.prior > 100.0  # the tolerances are left far behind, or there is no valley to come back along
    (load,) = (c for c in candidates(system, runs) if c.key == "payload_mass@rod")
    hypothesis = Hypothesis((load,))

    def fitted(nominals: np.ndarray, size: float, steps: int) -> float:
        x = np.concatenate([nominals, to_internal(load, np.array([size]))])
        return fit(posing(hypothesis), x, bent.states, most_steps=steps, enough=0.2).score

    bottom = fitted(np.zeros(len(bent.x)), LOAD, 60)
    assert bottom < 1.1 * likelihood.samples(windows)
    # Begun with less than the load the nominal quantities stay bent; with a quarter more, only steps along the curve get there.
    assert fitted(bent.x, 1.25 * LOAD, 25) < bottom + 1.0
