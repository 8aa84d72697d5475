"""Stamps that are late in a pattern are put right; noise, lateness at random and coarse encoders are no pattern."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import read_recording
from harness.recording.stamp_pattern import healed, stamp_pattern

RATE = 50.0
LATE = 1e-3 * np.array([-2.0, 0.5, 2.0, 0.3, -0.8])  # mean nothing


def swing(time: np.ndarray) -> np.ndarray:
    return 1.2 * np.exp(-time / 12.0) * np.cos(2.0 * np.pi * 0.8 * time)


def stamped(seed: int, noise: float = 1e-4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps, how late each sample is (a pattern of five that grows by half in 20 s), and readings."""
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    late = LATE[np.arange(len(time)) % 5] * (1.0 + 0.5 * time / time[-1])
    return time, late, swing(time + late) + noise * np.random.default_rng(seed).normal(size=len(time))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_pattern_that_drifts_is_found(seed: int) -> None:
    time, late, values = stamped(seed)
    found = stamp_pattern(time, [(values, 0.0)])
    assert found is not None
    assert found.period == 5
    # The noise alone leaves a tenth of the lateness at the amplitude's end.
    assert np.std(found.late - late) < 0.1 * np.std(late)


def test_samples_are_counted_over_those_that_are_missing() -> None:
    time, late, values = stamped(4)
    kept = np.delete(np.arange(len(time)), [100, 351, 352])
    found = stamp_pattern(time[kept], [(values[kept], 0.0)])
    assert found is not None
    assert found.period == 5
    assert np.std(found.late - late[kept]) < 0.1 * np.std(late)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("rate", [50.0, 250.0])
def test_neither_noise_nor_lateness_at_random_nor_steps_are_a_pattern(seed: int, rate: float) -> None:
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 20.0, 1.0 / rate)
    noisy = swing(time) + 3e-4 * rng.normal(size=len(time))
    assert stamp_pattern(time, [(noisy, 0.0)]) is None
    at_random = swing(time + 1e-3 * rng.normal(size=len(time))) + 1e-4 * rng.normal(size=len(time))
    assert stamp_pattern(time, [(at_random, 0.0)]) is None
    step = 2.0 * np.pi / 4096
    assert stamp_pattern(time, [(np.round(swing(time + 0.1 * seed) / step) * step, step)]) is None


def test_a_long_recording_is_put_right_to_its_end() -> None:
    time = np.arange(0.0, 500.0, 1.0 / RATE)
    late = LATE[np.arange(len(time)) % 5]
    values = 1.2 * np.cos(2.0 * np.pi * 0.8 * (time + late)) + 1e-4 * np.random.default_rng(6).normal(size=len(time))
    found = stamp_pattern(time, [(values, 0.0)])
    assert found is not None
    assert np.std((found.late - late)[-500:]) < 0.1 * np.std(late)


def test_a_steady_line_that_the_motion_does_not_modulate_is_none() -> None:
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    hum = swing(time) + 3e-3 * np.sin(2.0 * np.pi * RATE / 5.0 * time)
    assert stamp_pattern(time, [(hum, 0.0)]) is None


def test_a_file_is_read_with_stamps_put_right(tmp_path: Path) -> None:
    time, late, values = stamped(5)
    path = tmp_path / "run.csv"
    rows = "".join(f"{t:.6f},{x:.9f}\n" for t, x in zip(time, values, strict=True))
    path.write_text("time [s],pivot.position [rad]\n" + rows, encoding="utf-8")
    found = read_recording(path)
    kinds = {note.kind: note for note in found.quality}
    assert "repeats after 5" in kinds["stamp_pattern"].what
    assert "timing_jitter" not in kinds
    right = time + late - late[0]
    assert np.std(found.time - right) < 0.1 * np.std(late)


def test_stamps_without_a_pattern_are_left_as_they_are() -> None:
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    same, note = healed(time, [(swing(time), 0.0)])
    assert note is None
    assert same is time
