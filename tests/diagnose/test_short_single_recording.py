"""A single recording of a few swings, the last third held out: too short for a reading that wanders, and diagnosed all the same."""

from __future__ import annotations

import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.diagnose import diagnose


@pytest.mark.parametrize("duration", [2.0, 3.0, 4.5])
@pytest.mark.parametrize("viscous", [0.0, 0.004])
def test_a_few_swings_have_an_answer(duration: float, viscous: float) -> None:
    (run,) = releases(Rig(viscous=viscous), (0.4,), 1e-4, seed=5, duration=duration, rate=50.0)
    found = diagnose([run], nominal(), only=("viscous_damping", "sensor_offset"))
    assert {f["effect"] for f in found.findings if f["grade"] != "possible"} <= {"viscous_damping"}
    assert found.verdict in (("consistent",) if viscous == 0.0 else ("explained", "partly_explained", "unexplained"))
