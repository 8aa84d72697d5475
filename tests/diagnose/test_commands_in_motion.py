"""Commands that jump, by the motions that they make: an arm driven in MuJoCo, by what was recorded last or along lines between."""

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


def stepped(seed: int, held: bool, magnet: float) -> Recording:
    """Eight seconds at 100 Hz under steps of torque; magnet: size of a force over the angle that no law describes [N·m]."""
    model = arm(friction=FRICTION)
    data, random = mujoco.MjData(model), np.random.default_rng(seed)
    time = np.arange(800) * STEP * EVERY
    command = np.repeat(random.uniform(-1.5, 1.5, 20), 40)
    unnamed = np.random.default_rng(5)
    waves, phases = unnamed.normal(0.0, 5.0, 8), unnamed.uniform(0.0, 2.0 * np.pi, 8)
    position = np.empty(len(time))
    for k in range(len(time)):
        position[k] = data.qpos[0]
        after = command[min(k + 1, len(time) - 1)]
        for part in range(EVERY):
            share = 0.0 if held else (part + 0.5) / EVERY
            left_out = magnet * float(np.mean(np.cos(waves * data.qpos[0] + phases)))
            data.qfrc_applied[0] = command[k] + share * (after - command[k]) + left_out
            mujoco.mj_step(model, data)
    read = (Channel("pivot.position", "pivot", "position", "rad", position + 2e-4 * random.normal(size=len(time))),)
    return Recording(
        f"run{seed}", f"run{seed}", time, read, (Channel("pivot.effort", "pivot", "effort", "N*m", command),)
    )


@pytest.mark.slow
@pytest.mark.parametrize(("held", "magnet", "told"), [(True, 0.0, True), (False, 0.0, False), (True, 0.4, True)])
def test_commands_are_held_unless_the_motions_of_a_good_model_say_otherwise(
    held: bool, magnet: float, told: bool, tmp_path: Path
) -> None:
    model = tmp_path / "arm.urdf"
    model.write_text(URDF, encoding="utf-8")
    found = diagnose([stepped(seed, held, magnet) for seed in (1, 2, 3)], model)
    assert any(note["kind"] == "held_effort" for note in found.quality) == told
    late = {"actuator_delay", "sensor_delay"}
    assert not late.intersection(f["effect"] for f in found.findings if f["grade"] != "possible")
    if not magnet:
        (friction,) = (f for f in found.findings if f["effect"] == "coulomb_friction")
        low, high = friction["parameters"]["torque"]["ci95"]
        assert 0.9 * FRICTION < low < high < 1.1 * FRICTION
