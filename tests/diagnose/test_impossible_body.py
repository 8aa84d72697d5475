"""No fit goes beyond all bodies: what follows from such numbers would be lost in rounding, and stop the diagnosis."""

from __future__ import annotations

import numpy as np
from simulated_recordings import MASS, Rig, nominal, releases

from harness.diagnose.prediction.constants import FARTHEST_NOMINAL
from harness.diagnose.prediction.coordinates import from_internal, internal_bounds, to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose


def test_a_nominal_quantity_is_bent_only_so_far() -> None:
    system, runs = nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0)
    predictor = Predictor(pose(system, runs))
    far = np.full((1, len(predictor.nominal)), 1e6)
    (altered,) = predictor.made(Hypothesis(), far)[1]
    assert np.isclose(altered.links[0].mass / system.links[0].mass, np.exp(FARTHEST_NOMINAL))
    # Sums of squares of numbers that differ so much still keep half of their digits.
    assert np.exp(FARTHEST_NOMINAL) ** 2 < np.sqrt(1.0 / np.finfo(np.float64).eps)


def test_a_link_still_bends_under_the_largest_load_a_fit_may_try() -> None:
    system, runs = nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0)
    known = {c.key: c for c in candidates(system, runs)}
    load, bends = known["payload_mass@rod"], known["link_flexibility@rod"]
    most = internal_bounds(load)[1]
    assert MASS * 1e2 < from_internal(load, most)[0] < np.inf
    predictor = Predictor(pose(system, runs))
    x = np.concatenate([np.zeros(len(predictor.nominal)), most, to_internal(bends, np.array([20.0, 0.05]))])
    assert np.isfinite(predictor.row(Hypothesis((load, bends)), x)).all()
