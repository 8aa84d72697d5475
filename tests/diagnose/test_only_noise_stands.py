"""A set that leaves only noise gives way to plain laws beside an unknown force only where these explain the recordings too."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from simulated_recordings import Rig, nominal, recording, swing

import harness
from harness.diagnose.estimation.autoregression import surprise_of_innovations

TIME = np.arange(0.0, 6.0, 0.005)


def stopped(t: float, q: float, v: float) -> float:
    """A soft stop at 0.85 rad: a spring and a damper beyond it."""
    return -(0.05 * (q - 0.85) + 2.5e-4 * v) if q > 0.85 else 0.0


def test_a_stop_beside_a_reading_that_ends_is_told() -> None:
    rng = np.random.default_rng(11)
    runs = [
        recording(
            f"run{k}", TIME,
            {"pivot.position": np.clip(swing(Rig(torque=stopped), a, TIME), -1.2, 1.2) + 1e-3 * rng.standard_normal(len(TIME))},
        )
        for k, a in enumerate((1.3, -1.1))
    ]  # fmt: skip
    found = harness.diagnose(runs, nominal())
    assert {f["effect"] for f in found.findings} == {"end_stop", "sensor_saturation"}
    assert found.verdict == "explained"


def test_white_noise_costs_the_logarithm_of_its_variance() -> None:
    noise = 0.8 * np.random.default_rng(3).standard_normal((2, 4000))
    # −2 log L of independent Gaussian readings, less n (1 + log 2π).
    exact = 4000.0 * float(np.sum(np.log(np.var(noise, axis=1))))
    assert surprise_of_innovations([noise]) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("phi", [0.9, 0.99])
def test_what_follows_itself_costs_its_innovations(phi: float) -> None:
    """−2 log L of an autoregression of first order by its innovations, whose variance is known (Kolmogorov 1941)."""
    rng, size, drive = np.random.default_rng(5), 20000, 0.7
    follows = lfilter([1.0], [1.0, -phi], drive * rng.standard_normal(size))
    read = follows + rng.standard_normal(size)
    # The innovation of the sum solves the Riccati equation of its Kalman filter.
    gain = 1.0
    for _ in range(10000):
        gain = phi**2 * gain / (gain + 1.0) + drive**2
    assert surprise_of_innovations([read[None]]) == pytest.approx(size * np.log(gain + 1.0), rel=0.03)
