"""Incremental encoders count from where they were switched on, so that every recording has a zero of its own.

Such recordings of a right model once took minutes and ended in play, stops and friction, or unexplained.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose
from harness.diagnose.answer.diagnosis import numbers_of
from harness.recording import Recording

ZEROS = (0.03, -0.02, 0.05)
NOISE = 1e-3


def recordings(rig: Rig, zeros: tuple[float, ...]) -> list[Recording]:
    rng = np.random.default_rng(21)
    time = np.arange(0.0, 8.0, 0.01)
    return [
        recording(f"run{k}", time, {"pivot.position": swing(rig, a, time) + z + NOISE * rng.standard_normal(len(time))})
        for k, (a, z) in enumerate(zip((1.2, -0.7, 0.9), zeros, strict=True))
    ]


def test_zeros_are_told_beside_what_is_missing() -> None:
    found = diagnose(recordings(Rig(viscous=0.004), ZEROS), model=nominal())
    assert found.verdict == "explained"
    findings = {f["effect"]: f for f in found.findings}
    assert set(findings) == {"viscous_damping", "sensor_zero"}
    assert findings["viscous_damping"]["parameters"]["coefficient"]["value"] == pytest.approx(0.004, rel=0.03)
    zeros = findings["sensor_zero"]["zeros"]
    assert [z["recording"] for z in zeros] == ["run0", "run1", "run2"]
    # The mean of 800 readings is good to a thirtieth of the noise; within five of these.
    assert [z["zero"] for z in zeros] == pytest.approx(ZEROS, abs=5.0 * NOISE / np.sqrt(800.0))
    assert "run1 -0.0" in found.summary
    assert numbers_of(findings["sensor_zero"])["zero of run1"]["unit"] == "rad"


@pytest.mark.parametrize("count", [2, 3])
def test_a_zero_that_all_recordings_share_is_an_offset(count: int) -> None:
    found = diagnose(recordings(Rig(), (0.03, 0.03, 0.03))[:count], model=nominal())
    assert found.verdict == "explained"
    (finding,) = found.findings
    assert finding["effect"] in ("sensor_offset", "base_tilt")
    told = {name.split("@")[0] for name in finding["indistinguishable_from"]}
    # One number more in two recordings is odds of a hundred, of which a rival is still told; two more in three are not.
    assert count == 2 or "sensor_zero" not in told
