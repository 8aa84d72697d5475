"""Friction that gives way slowly instead of holding, as many simulators have it.

A regularized Coulomb friction (tanh(v / v₀), see Marques et al., Nonlinear Dynamics 86 (2016) 1407) keeps nothing at rest. It was
once told as dry friction on a shaken base, which frees what dry friction holds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose
from harness.recording import Recording

DRY, NOISE = 0.02, 1e-3
BOTH_REST, HELD_OUT_RESTS = (0.3, -0.22), (1.4, 0.25)


def recordings(slow: float, releases: tuple[float, ...]) -> list[Recording]:
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 6.0, 0.02)
    rig = Rig(torque=lambda t, q, v: -DRY * np.tanh(v / slow))
    return [
        recording(f"run{k}", time, {"pivot.position": swing(rig, a, time) + NOISE * rng.standard_normal(len(time))})
        for k, a in enumerate(releases)
    ]


# Far below the speed of a swing, where it creeps for long; and hardly below it, where nothing ever seems to rest.
@pytest.mark.parametrize("slow", [5e-3, 0.2])
def test_friction_that_creeps_is_told_with_its_speed(slow: float) -> None:
    found = diagnose(recordings(slow, BOTH_REST), model=nominal())
    assert found.verdict == "explained"
    (friction,) = found.findings
    assert friction["effect"] == "coulomb_friction"
    assert friction["parameters"]["torque"]["value"] == pytest.approx(DRY, rel=0.03)
    (creep,) = friction["modified_by"]
    assert creep["effect"] == "friction_creep"
    assert creep["parameters"]["velocity"]["value"] == pytest.approx(slow, rel=0.1)
    assert "creep of dry friction" in found.summary
    assert found.augmented is not None
    assert [a.effect for a in found.augmented.attachments] == ["coulomb_friction", "friction_creep"]


# Also where the joint hardly ever turns faster, and friction is little else than damping.
@pytest.mark.parametrize("slow", [0.01, 2.0])
def test_creep_of_the_friction_that_a_model_states_is_a_finding_of_its_own(slow: float) -> None:
    stated = nominal()
    stated = stated.replace_joint(replace(stated.joint("pivot"), friction=DRY))
    found = diagnose(recordings(slow, BOTH_REST), model=stated)
    assert found.verdict == "explained"
    (creep,) = found.findings
    assert creep["effect"] == "friction_creep"
    assert creep["parameters"]["velocity"]["value"] == pytest.approx(slow, rel=0.1)


def test_creep_that_only_data_held_out_show_is_told_as_such() -> None:
    found = diagnose(recordings(0.02, HELD_OUT_RESTS), model=nominal())
    assert found.verdict == "explained"
    (friction,) = found.findings
    assert friction["effect"] == "coulomb_friction"
    assert "shows_only_in" not in friction
    assert friction["parameters"]["torque"]["value"] == pytest.approx(DRY, rel=0.03)
    (creep,) = friction["modified_by"]
    assert (creep["effect"], creep["shows_only_in"]) == ("friction_creep", ["run1"])
    assert creep["parameters"]["velocity"]["value"] == pytest.approx(0.02, rel=0.1)
