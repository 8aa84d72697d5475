"""What may as well be absent by all of its own numbers is not claimed, whatever a fit gains by it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.candidates import candidates
from harness.diagnose.coordinates import to_internal
from harness.diagnose.doubt import absent_as_well
from harness.diagnose.hypothesis import Hypothesis
from harness.diagnose.investigate import crude_colours
from harness.diagnose.likelihood import Likelihood
from harness.diagnose.predict import Predictor
from harness.diagnose.problem import pose
from harness.diagnose.study import Study
from harness.diagnose.windows import whole


def _absent(rig: Rig, name: str, start: list[float]) -> bool:
    """Whether it is so of one effect fitted to swings of a rig."""
    system, runs = nominal(), releases(rig, (1.3, 0.9), 1e-3, seed=9)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=[name]))
    study = Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))
    nothing = np.zeros(len(study.predictor.nominal))
    own = np.concatenate([nothing, to_internal(known[0], np.array(start))])
    outcome: Any = SimpleNamespace(predictor=study.predictor)
    return absent_as_well(outcome, study.fit(Hypothesis(known[:1]), [own], None), 0)


@pytest.mark.parametrize(
    ("name", "start"),
    [("viscous_damping", [1e-4]), ("sensor_nonlinearity", [1e-3, 1e-3]), ("coulomb_friction", [1e-4])],
)
def test_what_is_not_there_is_absent(name: str, start: list[float]) -> None:
    assert _absent(Rig(), name, start)


@pytest.mark.parametrize(
    ("name", "start", "rig"),
    [
        ("viscous_damping", [1e-4], Rig(viscous=1e-3)),
        ("cubic_stiffness", [1e-3], Rig(torque=lambda t, q, v: -0.02 * q**3)),
        # A spring in the drive is absent where it is infinitely stiff: that it is not damped says nothing.
        ("joint_flexibility", [50.0, 0.0], Rig()),
    ],
)
def test_what_is_there_or_has_no_size_is_not(name: str, start: list[float], rig: Rig) -> None:
    assert not _absent(rig, name, start)
