"""A weak friction whose contact gives over a wide way is within reach of a fit, and tried where dry friction was found."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.rewrites.general_law import generalized
from harness.diagnose.selection.study import Study

NOISE, TIME = 1e-4, np.arange(0.0, 10.0, 0.01)
WAY = 0.35  # rad


def with_dahl_friction(angle: float, torque: float) -> np.ndarray:
    """Positions (T,) of the pendulum under a friction that gives (Dahl 1968, exponent one), its contact slack at first."""
    rig = Rig()

    def rate(t: float, y: np.ndarray) -> list[float]:
        q, v, force = y
        return [
            v,
            (-rig.moment * np.sin(q) - force) / rig.about_joint,
            torque / WAY * v * (1.0 - np.sign(v) * force / torque),
        ]

    found = solve_ivp(
        rate,
        (0.0, TIME[-1] + 1e-9),
        [angle, 0.0, 0.0],
        method="DOP853",
        t_eval=TIME,
        rtol=1e-10,
        atol=1e-13,
        max_step=0.02,
    )
    return np.asarray(found.y[0])


@pytest.mark.parametrize("torque", [3e-5, 2e-3])
def test_where_dry_friction_was_found_a_contact_that_gives_is_tried(torque: float) -> None:
    rng = np.random.default_rng(29)
    runs = [
        recording(
            f"run{k}", TIME, {"pivot.position": with_dahl_friction(a, torque) + NOISE * rng.standard_normal(len(TIME))}
        )
        for k, a in enumerate((1.3, -0.9))
    ]
    system = nominal(tolerance=0.005)
    posed = pose(system, runs)
    known = candidates(system, runs, only=["coulomb_friction", "dahl_friction"])
    by_name = {c.effect.name: c for c in known}
    likelihood = Likelihood(posed, (Colour(white=NOISE, interval=float(TIME[1])),))
    study = Study(posed, Predictor(posed), likelihood, tuple(known), whole(posed.runs, range(2)))
    dry = by_name["coulomb_friction"]
    start = np.concatenate([np.zeros(len(study.predictor.nominal)), to_internal(dry, np.array([torque]))])
    base = study.fit(Hypothesis((dry,)), [start], None, most_steps=30)
    (found,) = generalized(study, base)
    level, stiffness = study.predictor.effect_values(found.hypothesis, 0, found.x)
    # As many samples as degrees of freedom, give or take five standard deviations of such a sum.
    assert found.score < study.samples + 5.0 * np.sqrt(2.0 * study.samples)
    assert level == pytest.approx(torque, rel=0.2)
    assert level / stiffness == pytest.approx(WAY, rel=0.5)
