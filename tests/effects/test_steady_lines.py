"""Lines of hum are found where they are, and only where there are any."""

from __future__ import annotations

import numpy as np
import pytest

from harness.effects.lines import steady_lines

TIME = np.arange(0.0, 12.0, 0.004)
SWING = 1.1 * np.exp(-0.03 * TIME) * np.cos(2.0 * np.pi * 0.9 * TIME + 0.4 * np.sin(2.0 * np.pi * 0.9 * TIME) ** 2)


@pytest.mark.parametrize("frequency", [17.013, 49.98, 103.4])
def test_a_line_is_found_to_a_small_part_of_the_resolution(frequency: float) -> None:
    rng = np.random.default_rng(3)
    values = SWING + 1e-3 * np.sin(2.0 * np.pi * frequency * TIME + 1.0) + 1e-3 * rng.standard_normal(len(TIME))
    values[[40, 900, 901]] = np.nan
    assert min(abs(line - frequency) for line in steady_lines(TIME, values, 0.9)) < 0.1 / TIME[-1]


@pytest.mark.parametrize("frequency", [50.0, 50.01, 49.95])
def test_mains_show_at_twice_their_frequency(frequency: float) -> None:
    rng = np.random.default_rng(6)
    time = np.arange(0.0, 8.0, 0.01)
    hum = 2e-3 * np.sin(2.0 * np.pi * frequency * time + 1.0)
    values = np.cos(5.0 * time) * np.exp(-0.05 * time) + hum + 1e-3 * rng.standard_normal(len(time))
    (line,) = steady_lines(time, values, 0.8)
    assert abs(line - frequency) < 2.0 / time[-1]


def test_noise_has_no_line() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        assert not [f for f in steady_lines(TIME, SWING + 1e-3 * rng.standard_normal(len(TIME)), 0.9) if f > 20.0]


def test_a_vibration_that_dies_out_is_no_line() -> None:
    rng = np.random.default_rng(5)
    ring = 0.05 * np.exp(-0.5 * TIME) * np.sin(2.0 * np.pi * 31.0 * TIME)
    assert not [f for f in steady_lines(TIME, SWING + ring + 1e-3 * rng.standard_normal(len(TIME)), 0.9) if f > 20.0]
