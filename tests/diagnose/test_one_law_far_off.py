"""One law far above the noise is named, however well ordinary dissipation beside a force of any shape would do.

The truth is the pendulum of ``simulated_recordings``, integrated by SciPy apart from the engine.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose

NOISE, RATE, SECONDS = 3e-4, 100.0, 6.0
RIG = Rig()
AMPLITUDE, PERIODS, PHASE = 0.013 * RIG.moment, 14.0, 2.18  # of the cogging torque [N·m], a turn, [rad]
SLOW = 0.85  # of true time, as a slow clock stamps it


def _diagnosed(rig: Rig, clock: float = 1.0) -> object:
    """The diagnosis of two swings of a rig, as a clock of this rate stamps them."""
    stamps = np.arange(round(SECONDS * RATE)) / RATE
    random = np.random.default_rng(11)
    truths = {name: swing(rig, angle, stamps / clock) for name, angle in (("run1", 1.9), ("run2", 1.2))}
    runs = [
        recording(name, stamps, {"pivot.position": q + NOISE * random.standard_normal(len(q))})
        for name, q in truths.items()
    ]
    return diagnose(runs, nominal())


def test_cogging_is_named_and_leaves_only_noise() -> None:
    found = _diagnosed(Rig(torque=lambda t, q, v: AMPLITUDE * np.sin(PERIODS * q + PHASE)))
    assert found.verdict == "explained"
    (one,) = found.findings
    assert (one["effect"], one["site"]) == ("cogging_torque", "pivot")
    assert one["parameters"]["periods"]["value"] == pytest.approx(PERIODS, abs=0.05)
    low, high = one["parameters"]["amplitude"]["ci95"]
    assert low < AMPLITUDE < high


def test_a_slow_clock_is_not_doubted_for_a_stronger_pull_that_nobody_has_named() -> None:
    """Of a free swing a clock at 0.85 looks like 1/0.85² of its gravity, and so does a shorter arm, which is usual."""
    found = _diagnosed(RIG, SLOW)
    assert found.verdict == "explained"
    (one,) = found.findings
    named = [one["effect"], *(key.split("@")[0] for key in one["indistinguishable_from"])]
    assert "clock_skew" in named
