"""A channel that is read less often than another: its column is empty in most rows."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import nominal, recording

from harness.diagnose.problem.problem import pose
from harness.recording import Recording
from harness.recording.differences import white_noise

TIME = np.arange(0.0, 12.0, 0.001)
FAST, SLOW = 1e-4, 3e-4  # rad, rad/s: noise


def read_apart(seed: int, every: int = 20, first: int = 7) -> Recording:
    """A swing whose angle is read at 1 kHz and whose velocity at 50 Hz, in rows of their own."""
    rng = np.random.default_rng(seed)
    angle = 0.5 * np.cos(5.0 * TIME) + FAST * rng.standard_normal(len(TIME))
    velocity = np.full(len(TIME), np.nan)
    velocity[first::every] = -2.5 * np.sin(5.0 * TIME[first::every]) + SLOW * rng.standard_normal(
        len(TIME[first::every])
    )
    return recording(f"run{seed}", TIME, {"pivot.position": angle, "pivot.velocity": velocity})


def test_no_reading_of_a_slow_channel_is_lost_where_samples_are_thinned() -> None:
    posed = pose(nominal(), [read_apart(1), read_apart(2)])
    for run in posed.runs:
        angle, velocity = np.isfinite(run.values).sum(axis=1)
        assert velocity == len(TIME[7::20])
        assert 2000 < angle < 6000  # thinned all the same


def test_its_noise_is_that_from_reading_to_reading() -> None:
    values = np.full(len(TIME), np.nan)
    values[3::10] = np.random.default_rng(4).normal(0.0, SLOW, len(TIME[3::10]))
    assert white_noise(TIME, values) == pytest.approx(SLOW, rel=0.1)
