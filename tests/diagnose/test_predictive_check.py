"""Data held out that short training recordings foretell only as far as they fix the numbers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from harness.diagnose.criticism.constants import COMPLETE_RESIDUAL_RATIO
from harness.diagnose.diagnose import diagnose
from harness.recording import Channel, Recording

from simulated_recordings import Rig, nominal  # isort: skip

RIG = Rig(com=0.2515)  # a little longer than drawn, within the tolerance
NOISE = 1e-3
VISCOUS = 0.0015  # N·m·s/rad


def _swing(seconds: float, drag: float, seed: int) -> Recording:
    def slope(t: float, y: NDArray[np.float64]) -> list[float]:
        resistance = VISCOUS * y[1] + drag * y[1] * abs(y[1])
        return [y[1], -(RIG.moment * np.sin(y[0]) + resistance) / RIG.about_joint]

    time = np.arange(0.0, seconds, 0.01)
    angle = solve_ivp(slope, (0.0, seconds), [1.2, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    values = angle + NOISE * np.random.default_rng(seed).normal(size=len(time))
    return Recording(f"swing{seed}", "", time, (Channel("pivot.position", "pivot", "position", "rad", values),))


def test_what_training_leaves_open_is_not_held_against_the_right_law() -> None:
    # One swing and a half foretells twenty by more than twice the noise: errors of the frequency add up.
    found = diagnose([_swing(1.5, 0.0, 1), _swing(30.0, 0.0, 2)], nominal(0.01))
    errors = found.fit[0]
    assert errors["augmented"]["heldout_rmse"] > COMPLETE_RESIDUAL_RATIO * errors["noise_floor"]
    assert found.verdict == "explained"
    (told,) = found.findings
    low, high = told["parameters"]["coefficient"]["ci95"]
    assert told["effect"] == "viscous_damping" and low <= VISCOUS <= high
    assert "as far as the training recordings fix the numbers" in found.summary


@pytest.mark.parametrize("drag", [2e-4, 2e-3])
def test_another_law_in_the_data_held_out_is(drag: float) -> None:
    # N·m·s²/rad²: at 5 rad/s two thirds and seven times of what the viscous friction makes there.
    found = diagnose([_swing(1.5, 0.0, 1), _swing(30.0, drag, 2)], nominal(0.01))
    assert found.verdict == "partly_explained"
