"""Laws of joints added to a torque that is kept give the efforts that a whole inverse dynamics of the changed model gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import nominal, recording

from harness.diagnose.inverse import effort_model
from harness.diagnose.inverse.effort_fit import EffortData
from harness.diagnose.inverse.effort_model import LAWS, EffortModel
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.effort_noise import effort_noise, grid_of
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis

# Damping and dry friction that the model states, so that a law may also take away from them.
JOINT = nominal().joints[0]
SYSTEM = replace(nominal(), joints=(replace(JOINT, damping=0.01, friction=0.02),))
TIME = np.arange(0.0, 8.0, 0.004)
ANGLE = 0.7 * np.sin(2.1 * TIME) + 0.3 * np.sin(5.0 * TIME + 1.0)
EFFORT = 0.5 * np.sin(2.1 * TIME + 0.4)
RECORDED = recording("run", TIME, {"pivot.position": ANGLE, "pivot.effort": EFFORT})
RUN = effort_run(SYSTEM, RECORDED, 3.0)
KNOWN = {c.effect.name: c for c in candidates(SYSTEM, [RECORDED], only=effort_model.KNOWN)}


def point(hypothesis: Hypothesis, sign: float) -> np.ndarray:
    """Nominal quantities off their values, and every parameter at a half of its typical size."""
    count = len(EffortModel(SYSTEM, [RUN]).nominal)
    own = [np.clip(0.5 * sign * m.scales + 0.01, m.effect.lower, m.effect.upper) for m in hypothesis.members]
    return np.concatenate([np.linspace(-2.0, 1.5, count), *own])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("beside", [(), ("payload_mass", "actuator_gain")])
def test_a_law_is_what_the_changed_model_needs(name, sign, beside, monkeypatch):
    hypothesis = Hypothesis()
    for one in (name, *beside):
        hypothesis = hypothesis.with_(KNOWN[one])
    x = point(hypothesis, sign)
    quick = EffortModel(SYSTEM, [RUN]).residuals(hypothesis, x)[0]
    without = EffortModel(SYSTEM, [RUN]).residuals(Hypothesis(), x[: len(x) - hypothesis.size])[0]
    monkeypatch.setattr(effort_model, "LAWS", ())
    whole = EffortModel(SYSTEM, [RUN]).residuals(hypothesis, x)[0]
    # Rounding of torques of about one newton metre, through the filter and back.
    assert np.abs(quick - whole).max() < 1e-11
    if not beside and sign > 0.0:
        assert np.abs(quick - without).max() > 1e-6


@pytest.mark.parametrize("beside", [(), ("actuator_gain",)])
def test_slopes_of_nominal_quantities_are_shared_by_laws(beside):
    """The slopes kept for one law serve another beside the same effects, and are difference quotients of the rows."""
    grid = grid_of(RUN)
    model = EffortModel(SYSTEM, [RUN])
    data = EffortData(model, (grid,), (effort_noise([EFFORT]),))
    first, second = Hypothesis(), Hypothesis()
    for one in ("viscous_damping", *beside):
        first = first.with_(KNOWN[one])
    for one in (*beside, "cubic_stiffness"):
        second = second.with_(KNOWN[one])
    kept = data.nominal_slopes(first, point(first, 1.0))
    x = point(second, 1.0)
    assert data.nominal_slopes(second, x) is kept
    for k in range(len(model.nominal)):
        ahead, behind = x.copy(), x.copy()
        ahead[k], behind[k] = x[k] + 1e-2, x[k] - 1e-2
        slope = (data.rows(second, ahead) - data.rows(second, behind)) / 2e-2
        # One-sided over a thousandth of a quantity that enters as a square at most: 1e-3 σ of 1 %.
        assert np.abs(slope - kept[:, k]).max() < 1e-4 * max(np.abs(slope).max(), 1e-6)
