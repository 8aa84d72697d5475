"""A general law that has lost what makes it general on the way is begun again from other shapes."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.score_tests import Score
from harness.diagnose.selection.study import Study

NOISE, TIME = 1e-3, np.arange(0.0, 6.0, 0.02)
COULOMB, STATIC, VELOCITY = 0.004, 0.014, 3.0


def more_than_coulomb(t: float, q: float, v: float) -> float:
    """What a Stribeck friction adds to dry friction while it slides (Olsson et al. 1998, eq. 4, exponent two)."""
    return -float(np.sign(v)) * (STATIC - COULOMB) * float(np.exp(-((v / VELOCITY) ** 2)))


def test_a_stribeck_friction_begun_without_its_static_part_finds_it() -> None:
    rng = np.random.default_rng(17)
    rig = Rig(dry=COULOMB, torque=more_than_coulomb)
    runs = [
        recording(f"run{k}", TIME, {"pivot.position": swing(rig, a, TIME) + NOISE * rng.standard_normal(len(TIME))})
        for k, a in enumerate((1.2, -0.8))
    ]
    system = nominal(tolerance=0.005)
    posed = pose(system, runs)
    (law,) = candidates(system, runs, only=["stribeck_friction"])
    likelihood = Likelihood(posed, (Colour(white=NOISE, interval=float(TIME[1])),))
    study = Study(posed, Predictor(posed), likelihood, (law,), whole(posed.runs, range(2)))
    empty = study.empty()
    shapeless = Score(law, empty.score, np.array([1.5 * COULOMB, 0.0, 4.0]), 1.0)
    best = study.extend(empty, shapeless)
    coulomb, static, velocity = study.predictor.effect_values(best.hypothesis, 0, best.x)
    assert best.score < 1.2 * study.samples
    assert coulomb == pytest.approx(COULOMB, rel=0.1)
    assert static == pytest.approx(STATIC, rel=0.1)
    assert velocity == pytest.approx(VELOCITY, rel=0.1)
