"""A drive that gives no more than so much of the effort that is recorded. Truth: a pendulum's textbook equation, by SciPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording

DAMPING = 0.004  # N·m·s/rad, which the model states
ASKED = (
    "actuator_saturation",
    "actuator_gain",
    "actuator_deadzone",
    "coulomb_friction",
    "payload_mass",
    "cogging_torque",
)


def driven(seed: int, limit: float) -> Recording:
    """Ten seconds under four waves of torque, of which what is over the limit is asked for in vain."""
    random, rig = np.random.default_rng(seed), Rig()
    rate, phase = random.uniform(1.0, 9.0, 4), random.uniform(-3.0, 3.0, 4)
    size = 0.125 * random.uniform(0.3, 1.0, 4)

    def asked(time: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(size @ np.sin(rate[:, None] * time + phase[:, None]))

    def slope(time: float, y: NDArray[np.float64]) -> list[float]:
        given = float(np.clip(asked(np.array([time])), -limit, limit)[0])
        return [y[1], (given - DAMPING * y[1] - rig.moment * np.sin(y[0])) / rig.about_joint]

    time = np.arange(0.0, 10.0, 0.005)
    start = [0.3 * random.normal(), 0.0]
    angle = solve_ivp(slope, (0.0, 10.0), start, t_eval=time, rtol=1e-10, atol=1e-12, max_step=0.01).y[0]
    noisy = angle + 5e-4 * random.standard_normal(len(time))
    return recording(f"run{seed}", time, {"pivot.position": noisy, "pivot.effort": asked(time)})


@pytest.mark.parametrize("limit", [0.15, 0.25, np.inf])
def test_a_drive_that_clips_is_told_with_its_limit_and_one_that_does_not_is_not(limit: float) -> None:
    """The largest torque that is asked for is 0.314 N·m."""
    system = nominal()
    system = replace(system, joints=(replace(system.joints[0], damping=DAMPING),))
    found = diagnose([driven(seed, limit) for seed in range(3)], system, only=ASKED)
    if not np.isfinite(limit):
        assert found.verdict == "consistent" and not found.findings
        return
    assert found.verdict == "explained"
    (told,) = found.findings
    low, high = told["parameters"]["limit"]["ci95"]
    assert told["effect"] == "actuator_saturation"
    assert low - 1e-5 <= limit <= high + 1e-5
