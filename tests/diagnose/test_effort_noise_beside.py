"""What a late drive makes of an effort is not its noise, once the lateness has been named."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording

NOISE = 2e-3  # N·m


def driven(seed: int, late: float) -> Recording:
    """A pendulum under four sines that arrive late, 12 s at 200 Hz: SciPy integrates under the late sines themselves."""
    rng = np.random.default_rng(seed)
    rig = Rig(viscous=0.01)
    frequency, phase = np.array([0.4, 1.3, 2.1, 3.0]), rng.uniform(0.0, 2.0 * np.pi, 4)
    size = np.array([0.35, 0.2, 0.2, 0.2])

    def torque(t: np.ndarray | float) -> np.ndarray:
        return np.sin(2.0 * np.pi * np.multiply.outer(t, frequency) + phase) @ size

    time = np.arange(0.0, 12.0, 0.005)

    def rate(t: float, y: np.ndarray) -> list[float]:
        return [y[1], (torque(t - late) - rig.viscous * y[1] - rig.moment * np.sin(y[0])) / rig.about_joint]

    angle = solve_ivp(rate, (0.0, time[-1]), [0.0, 0.0], method="DOP853", rtol=1e-9, atol=1e-11, t_eval=time).y[0]
    columns = {
        "pivot.position": angle + 2e-4 * rng.standard_normal(len(time)),
        "pivot.effort": torque(time) + NOISE * rng.standard_normal(len(time)),
    }
    return recording(f"run{seed}", time, columns)


@pytest.mark.parametrize("late", [0.0, 0.025])
def test_the_noise_told_is_the_efforts_own(late: float) -> None:
    found = diagnose([driven(seed, late) for seed in (1, 2, 3)], nominal(), fit_effort=True)
    named = {f["effect"]: f["parameters"] for f in found.findings}
    assert set(named) == {"viscous_damping", *(["actuator_delay"] if late else [])}
    if late:
        assert named["actuator_delay"]["delay"]["value"] == pytest.approx(late, abs=1e-3)
    (row,) = found.fit
    # White noise of the effort through a low-pass below a tenth of half the sampling rate, and what the angle's noise adds to it.
    assert row["noise_floor"] < 2.0 * NOISE
    assert row["augmented"]["heldout_rmse"] < 1.5 * row["noise_floor"]
