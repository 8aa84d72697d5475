"""Efforts that jump are a controller's commands, and are held until the next one; what is measured passes through a filter."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.problem.commands import are_commands
from harness.diagnose.problem.problem import pose

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


def test_what_is_held_out_has_no_say() -> None:
    system = nominal()
    swung = swing(Rig(), 0.5, TIME)
    smooth, stepped = (
        recording(name, TIME, {"pivot.position": swung, "pivot.effort": 0.01 * effort})
        for name, effort in (("smooth", WAVES), ("stepped", STEPS))
    )
    assert not pose(system, [smooth, stepped]).held
    assert not pose(system, [smooth], heldout=stepped).held
    assert pose(system, [stepped, smooth]).held
    assert pose(system, [stepped]).held
