"""An encoder's fast error is a line over the angle and not noise; noise has no such line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose
from harness.diagnose.estimation.angle_waves import without_waves

TIME = np.arange(0.0, 12.0, 0.005)
ANGLES = [a * np.exp(-0.05 * TIME) * np.cos(5.0 * TIME) for a in (1.1, -0.7)]
NOISE = 2e-4
AMPLITUDE = 2e-3


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_lines_are_taken_out_and_noise_is_left(memory: float) -> None:
    rng = np.random.default_rng(17)
    noises = [lfilter([1.0], [1.0, -memory], rng.standard_normal(len(TIME))) for _ in ANGLES]
    waves = [4.0 * np.sin(300.0 * q + 0.4) + 1.0 * np.cos(600.0 * q) for q in ANGLES]
    left, lines = without_waves([n + w for n, w in zip(noises, waves, strict=True)], ANGLES)
    # A line's place is known to a part of a period within the range of 2.1 rad.
    assert np.abs(lines[0] - 300.0) < 1.0
    assert any(np.abs(line - 600.0) < 1.0 for line in lines)
    before, after = np.concatenate(noises), np.concatenate(left)
    assert np.std(after) == pytest.approx(np.std(before), rel=0.03)


def test_noise_alone_has_no_line() -> None:
    rng = np.random.default_rng(18)
    for memory in (0.0, 0.5, 0.9, 0.99):
        for _ in range(10):
            noises = [lfilter([1.0], [1.0, -memory], rng.standard_normal(len(TIME))) for _ in ANGLES]
            left, _ = without_waves(noises, ANGLES)
            # Red noise may seem to have a line at its slow end; what that takes away changes no estimate.
            assert np.std(np.concatenate(left)) > 0.97 * np.std(np.concatenate(noises))


def test_rounding_stays_noise() -> None:
    step = 0.02
    errors = [np.round(q / step) * step - q for q in ANGLES]
    left, _ = without_waves(errors, ANGLES, step)
    assert np.std(np.concatenate(left)) > 0.97 * np.std(np.concatenate(errors))


@pytest.mark.parametrize("periods", [40, 720])
def test_a_fast_error_of_an_encoder_is_named(periods: int) -> None:
    rng = np.random.default_rng(periods)
    runs = []
    for k, release in enumerate((0.9, -0.6, 1.2)):
        angle = swing(Rig(), release, TIME)
        read = angle + AMPLITUDE * np.sin(periods * angle + 0.7) + NOISE * rng.standard_normal(len(TIME))
        runs.append(recording(f"run{k}", TIME, {"pivot.position": read}))
    found = diagnose(runs, model=nominal())
    assert found.verdict == "explained"
    (finding,) = found.findings
    assert finding["effect"] == "encoder_interpolation"
    assert finding["parameters"]["periods"]["value"] == periods
    low, high = finding["parameters"]["amplitude"]["ci95"]
    assert low < AMPLITUDE < high and high - low < 0.2 * AMPLITUDE
    (noise,) = found.noise
    assert noise["std"] == pytest.approx(NOISE, rel=0.15)
