"""Friction that gives way slowly instead of holding, as most simulators have it, and as no law of the catalogue does.

A regularized Coulomb friction (tanh(v / v₀), see Marques et al., Nonlinear Dynamics 86 (2016) 1407) keeps nothing at rest. It was
once told as dry friction on a shaken base, which frees what dry friction holds.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose

DRY, SLOW, NOISE = 0.02, 0.02, 1e-3
# Both recordings come to rest; or only the one held out does.
RELEASES = {"in all": (0.3, -0.22), "held out alone": (1.4, 0.25)}


@pytest.mark.parametrize("where", RELEASES)
def test_nothing_that_frees_a_joint_is_told_beside_dry_friction(where: str) -> None:
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 6.0, 0.02)
    rig = Rig(torque=lambda t, q, v: -DRY * np.tanh(v / SLOW))
    runs = [
        recording(f"run{k}", time, {"pivot.position": swing(rig, a, time) + NOISE * rng.standard_normal(len(time))})
        for k, a in enumerate(RELEASES[where])
    ]
    found = diagnose(runs, model=nominal())
    assert found.verdict == "partly_explained"
    (friction,) = found.findings
    assert friction["effect"] in ("coulomb_friction", "stribeck_friction", "dahl_friction")
    first = next(iter(friction["parameters"].values()))
    # As friction that holds it is a little more: it has to stop what truly creeps on.
    assert first["value"] == pytest.approx(DRY, rel=0.1)
    assert "where dry friction holds the model" in found.summary
