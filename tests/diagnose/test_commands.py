"""Efforts that jump are a controller's commands, and are held until the next one; what is measured passes through a filter."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.problem.commands import are_commands

TIME = np.arange(0.0, 10.0, 0.005)


def _filtered(values: np.ndarray, lag: float) -> np.ndarray:
    """Through a first-order filter with this time constant [s]."""
    out, share = np.zeros_like(values), 1.0 - np.exp(-0.005 / lag)
    for k in range(1, len(values)):
        out[k] = out[k - 1] + share * (values[k] - out[k - 1])
    return out


STEPS = np.where(np.sin(0.8 * TIME) > 0.0, 0.9, 0.0)
QUICK = np.sign(np.sin(2.0 * np.pi * 7.3 * TIME))
WAVES = np.sin(3.0 * TIME) + 0.4 * np.sin(17.0 * TIME + 1.0)
NOISE = 0.02 * np.random.default_rng(3).standard_normal(len(TIME))


@pytest.mark.parametrize("values", [STEPS, QUICK, WAVES + STEPS], ids=["steps", "square", "steps among waves"])
def test_what_jumps_is_a_command(values: np.ndarray) -> None:
    assert are_commands([np.zeros(500), values])


@pytest.mark.parametrize(
    "values",
    [
        WAVES,
        WAVES + NOISE,
        NOISE,
        _filtered(STEPS, 0.02),
        _filtered(STEPS, 0.02) + NOISE,
        np.sin(np.pi * np.clip((TIME - 3.0) / 0.05, 0.0, 1.0)),
        np.zeros(500),
        np.array([0.0, 1.0, 0.0]),
        np.full(500, np.nan),
    ],
    ids=[
        "waves",
        "waves and noise",
        "noise",
        "filtered",
        "filtered, noise",
        "a push of 50 ms",
        "free",
        "three",
        "none",
    ],
)
def test_what_passes_through_several_samples_is_measured(values: np.ndarray) -> None:
    assert not are_commands([values])
