"""Efforts held from each sample to the next and smooth ones are told apart: recordings of an arm that is driven in MuJoCo."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from driven_arm import STEP, URDF, arm

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording
from harness.recording.recording import Channel

EVERY = 20  # steps between samples
FRICTION = 0.15  # N·m, that the model does not have


def driven(seed: int, held: bool) -> Recording:
    """Sixteen seconds at 100 Hz under five sines; held: the arm feels what was recorded last, else the sines themselves."""
    model = arm(friction=FRICTION)
    data = mujoco.MjData(model)
    random = np.random.default_rng(seed)
    frequency, phase = np.geomspace(0.15, 1.6, 5), random.uniform(0.0, 2.0 * np.pi, 5)

    def torque(t: float) -> float:
        return float(np.sum(0.55 * np.sin(2.0 * np.pi * frequency * t + phase)))

    rows = []
    for k in range(round(16.0 / STEP)):
        if k % EVERY == 0:
            rows.append((data.time, float(data.qpos[0]), torque(data.time)))
        # MuJoCo holds it over its own step, so a smooth one is taken from the middle.
        data.qfrc_applied[0] = rows[-1][2] if held else torque(data.time + 0.5 * STEP)
        mujoco.mj_step(model, data)
    time, position, effort = np.array(rows).T
    position = position + 2e-4 * random.normal(size=len(time))
    effort = effort + 0.01 * random.normal(size=len(time))
    read = (Channel("pivot.position", "pivot", "position", "rad", position),)
    return Recording(
        f"run{seed}", f"run{seed}", time, read, (Channel("pivot.effort", "pivot", "effort", "N*m", effort),)
    )


@pytest.mark.parametrize("held", [True, False])
def test_an_effort_that_is_held_is_told_and_is_no_delay(held: bool, tmp_path: Path) -> None:
    model = tmp_path / "arm.urdf"
    model.write_text(URDF, encoding="utf-8")
    found = diagnose([driven(seed, held) for seed in (1, 2)], model, fit_effort=True)
    assert [f["effect"] for f in found.findings] == ["coulomb_friction"]
    low, high = found.findings[0]["parameters"]["torque"]["ci95"]
    assert low < FRICTION < high
    assert any(note["kind"] == "held_effort" for note in found.quality) == held
