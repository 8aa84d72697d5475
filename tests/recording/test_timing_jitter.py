"""Noise that grows with speed is told as readings that are late; noise that does not is not."""

from __future__ import annotations

import numpy as np
import pytest

from harness.recording.differences import SQUARE, third_differences
from harness.recording.jitter import jitter_note, timing_jitter

RATE = 250.0


def swing(time: np.ndarray) -> np.ndarray:
    return 1.2 * np.exp(-time / 12.0) * np.cos(5.0 * time)


@pytest.mark.parametrize("lateness", [2e-4, 1e-3])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lateness_is_recovered(lateness: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    angle = swing(time + lateness * rng.normal(size=len(time))) + 1e-4 * rng.normal(size=len(time))
    found = timing_jitter(time, angle)
    assert found is not None
    assert found.lateness == pytest.approx(lateness, rel=0.15)
    note = jitter_note("pivot.position", "rad", time, angle, 0.0)
    assert note is not None
    assert note.kind == "timing_jitter"


def test_every_other_reading_late_is_lateness_too() -> None:
    # Two readings a bus cycle: late by 0 and by 2 τ in turn has standard deviation τ, and third differences correlate by −1:
    # their variance is 64/20 of that of independent errors.
    tau = 4e-4
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    angle = swing(time + tau * (-1.0) ** np.arange(len(time)))
    found = timing_jitter(time, angle + 1e-5 * np.random.default_rng(4).normal(size=len(time)))
    assert found is not None
    assert found.lateness == pytest.approx(tau * np.sqrt(64.0 / 20.0), rel=0.15)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("noise", [1e-4, 3e-3])
def test_noise_that_does_not_depend_on_speed_is_none(seed: int, noise: float) -> None:
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    angle = swing(time) + noise * np.random.default_rng(seed).normal(size=len(time))
    assert timing_jitter(time, angle) is None


@pytest.mark.parametrize("step", [2.0 * np.pi / 4096.0, 2.0 * np.pi / 1024.0])
def test_rounding_and_rest_are_none(step: float) -> None:
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    angle = np.where(time < 6.0, swing(time), swing(np.array([6.0]))[0])
    assert timing_jitter(time, np.round(angle / step) * step, step) is None


def test_true_motion_without_noise_is_none() -> None:
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    assert timing_jitter(time, swing(time)) is None


@pytest.mark.parametrize("seed", [5, 6, 7])
def test_uneven_readings_with_true_stamps_are_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = np.sort(np.arange(0.0, 12.0, 1.0 / RATE) + 8e-4 * rng.normal(size=int(12 * RATE)))
    assert timing_jitter(time, swing(time) + 3e-4 * rng.normal(size=len(time))) is None


def test_third_differences_of_uneven_samples() -> None:
    rng = np.random.default_rng(8)
    time = np.cumsum(rng.uniform(0.002, 0.006, 4000))
    assert np.abs(third_differences(time, 2.0 - 3.0 * time + 0.4 * time**2)).max() < 1e-10
    noise = third_differences(time, rng.normal(size=(2, len(time))))
    assert noise.shape == (2, 3997)
    # Overlapping: a third of 8000 are independent, whose variance is known to √(2/2700) = 3 %.
    assert np.var(noise) == pytest.approx(SQUARE, rel=0.12)
    even = np.arange(50) * 0.01
    wave = np.sin(7.0 * even)
    assert np.allclose(np.abs(third_differences(even, wave)), np.abs(np.diff(wave, 3)), rtol=0, atol=1e-12)
