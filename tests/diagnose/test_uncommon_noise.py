"""Noise as real sensors have it: outliers, heavy tails, louder while fast, hum. None of it is physics that a model left out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from simulated_recordings import Rig, nominal, swing

from harness import diagnose
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.criticism.residual_correlation import follows_itself

SIZE = 2e-3
RELEASES = (1.2, -0.7, 0.9)

Noise = Callable[[np.random.Generator, np.ndarray, np.ndarray], np.ndarray]


def _heavy_tails(rng: np.random.Generator, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    return SIZE * rng.standard_t(3, len(time)) / np.sqrt(3.0)


def _outliers(rng: np.random.Generator, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    noise = SIZE * rng.standard_normal(len(time))
    which = rng.choice(len(time), len(time) // 100, replace=False)
    noise[which] += 30.0 * SIZE * rng.standard_normal(len(which))
    return noise


def _louder_while_fast(rng: np.random.Generator, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    speed = np.abs(np.gradient(angle, time))
    return SIZE * (0.3 + 2.0 * speed / speed.max()) * rng.standard_normal(len(time))


def _louder_for_a_while(rng: np.random.Generator, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    return SIZE * np.where((time > 3.0) & (time < 4.0), 6.0, 1.0) * rng.standard_normal(len(time))


def told(folder: Path, rig: Rig, noise: Noise, seed: int, rate: float = 200.0) -> Diagnosis:
    rng = np.random.default_rng(seed)
    files = []
    for k, release in enumerate(RELEASES):
        time = np.arange(0.0, 9.0, 1.0 / rate)
        angle = swing(rig, release, time)
        frame = pd.DataFrame({"time": time, "pivot.position": angle + noise(rng, time, angle)})
        files.append(folder / f"run{k}.csv")
        frame.to_csv(files[-1], index=False)
    return diagnose([str(f) for f in files], model=nominal())


@pytest.mark.parametrize("noise", [_heavy_tails, _outliers, _louder_while_fast, _louder_for_a_while])
def test_a_model_that_is_right_stays_right(tmp_path: Path, noise: Noise) -> None:
    assert told(tmp_path, Rig(), noise, 5).verdict == "consistent"


@pytest.mark.parametrize("noise", [_heavy_tails, _louder_while_fast])
def test_what_is_missing_is_all_that_is_told(tmp_path: Path, noise: Noise) -> None:
    found = told(tmp_path, Rig(drag=0.004), noise, 6)
    assert found.verdict == "explained"
    assert [f["effect"] for f in found.findings] == ["quadratic_drag"]


def _hum(frequency: float, size: float) -> Noise:
    def noise(rng: np.random.Generator, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
        wave = np.sin(2.0 * np.pi * frequency * time + rng.uniform(-np.pi, np.pi))
        return size * wave + SIZE * rng.standard_normal(len(time))

    return noise


def test_hum_is_told_with_its_frequency(tmp_path: Path) -> None:
    found = told(tmp_path, Rig(viscous=0.004), _hum(49.97, 3e-3), 7)
    assert found.verdict == "explained"
    findings = {f["effect"]: f for f in found.findings}
    assert set(findings) == {"viscous_damping", "sensor_hum"}
    hum = findings["sensor_hum"]
    low, high = hum["parameters"]["frequency"]["ci95"]
    assert low < 49.97 < high
    assert hum["parameters"]["amplitude"]["value"] == pytest.approx(3e-3, rel=0.05)
    # No base shakes a pendulum of 0.9 Hz so fast that this would show.
    assert hum["indistinguishable_from"] == []


def test_slow_hum_may_be_a_base_that_shakes(tmp_path: Path) -> None:
    # Mains at a rate of 56 Hz look like 6 Hz, which the pendulum would follow.
    found = told(tmp_path, Rig(), _hum(50.0, 5e-3), 8, rate=56.0)
    assert found.verdict == "explained"
    (hum,) = found.findings
    assert hum["effect"] == "sensor_hum"
    assert hum["parameters"]["frequency"]["value"] == pytest.approx(6.0, abs=0.01)
    assert "base_excitation@base" in hum["indistinguishable_from"]


def test_samples_that_follow_one_another_are_told_from_loud_ones() -> None:
    rng = np.random.default_rng(9)
    chances = [follows_itself([rng.standard_t(3, 200) * np.linspace(0.1, 5.0, 200)]) for _ in range(2000)]
    # The test's size at a chance of a twentieth, within three binomial deviations of 2000 draws, and far below it.
    assert np.mean(np.array(chances) < 0.05) == pytest.approx(0.05, abs=0.02)
    assert np.mean(np.array(chances) < 1e-5) == 0.0
    slow = np.sin(np.arange(200) / 15.0)
    assert follows_itself([slow + rng.standard_normal(200)]) < 1e-5
