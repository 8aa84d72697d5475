"""A slow sensor on a motion that is under way when the recording begins: its filter stands somewhere, and nothing says where."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, passed_slowly, recording, swing

import harness
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

CUTOFF, NOISE, RATE, LEAD = 5.0, 5e-4, 125.0, 3.3
FINE = 2e-4  # s, at which the filter of straight lines is that of the swing to 1e-7 rad


def slow_reading(angle: float, time: np.ndarray) -> np.ndarray:
    """What the sensor reads of a swing released ``LEAD`` before the recording, dozens of its time constants."""
    fine = np.arange(0.0, LEAD + time[-1] + 2 * FINE, FINE)
    truth = swing(Rig(), angle, fine)
    return np.interp(LEAD + time, fine, passed_slowly(truth, FINE, CUTOFF))


def test_a_slow_sensor_is_named_though_the_swing_is_under_way() -> None:
    rng = np.random.default_rng(23)
    time = np.arange(0.0, 9.0, 1.0 / RATE)
    runs = [
        recording(f"run{k}", time, {"pivot.position": slow_reading(a, time) + NOISE * rng.standard_normal(len(time))})
        for k, a in enumerate((1.3, -0.9))
    ]
    found = harness.diagnose(
        runs, nominal(tolerance=0.01),
        only=["sensor_lowpass", "sensor_delay", "encoder_interpolation", "viscous_damping", "cubic_stiffness"],
    ).to_json()  # fmt: skip
    assert found["verdict"] == "explained"
    (finding,) = found["findings"]
    assert finding["effect"] == "sensor_lowpass"
    assert finding["parameters"]["cutoff"]["value"] == pytest.approx(CUTOFF, rel=0.1)


@pytest.mark.parametrize("settled", [0.0, 1.0])
def test_a_filter_may_begin_with_the_recording_on_its_first_sample(settled: float) -> None:
    # A balanced wheel turns evenly, φ = ω t; a first-order filter reads ω (t − τ (1 − e^(−t/τ))) if it begins on the first sample,
    # ω (t − τ) if it has followed the wheel for long. The latter cannot be told from where the wheel began.
    axle = Joint("axle", JointType.REVOLUTE, "base", "wheel", axis=constant([0.0, 0.0, 1.0]))
    wheel = System("wheel", (axle,), (Link("wheel", 1.0, constant(np.zeros(3)), constant(0.01 * np.eye(3))),))
    rng, tau, time = np.random.default_rng(4), 1.0 / (2.0 * np.pi * CUTOFF), np.arange(0.0, 6.0, 1.0 / RATE)
    runs = [
        recording(
            f"run{k}",
            time,
            {
                "axle.position": speed * (time - tau * (1.0 - (1.0 - settled) * np.exp(-time / tau)))
                + NOISE * rng.standard_normal(len(time))
            },
        )
        for k, speed in enumerate((14.0, 9.0))
    ]
    found = harness.diagnose(runs, model=wheel).to_json()
    if settled:
        assert found["verdict"] == "consistent"
        return
    assert found["verdict"] == "explained"
    (finding,) = found["findings"]
    assert finding["effect"] == "sensor_lowpass"
    assert finding["parameters"]["cutoff"]["value"] == pytest.approx(CUTOFF, rel=0.02)
