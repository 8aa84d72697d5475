"""Something that gives, begun where it vibrates or gives as something else does: closed forms of two bodies and a spring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.selection.resonant_starts import in_tune

ARMATURE, CARRIED = 0.004, INERTIA + MASS * COM**2  # kg·m² of the drive side, and of the link about the joint
STIFFNESS, DAMPING = 60.0, 0.02  # of the coupling between them
# Two bodies that turn against one another on a spring (Den Hartog, Mechanical Vibrations (1956), ch. 2).
REDUCED = 1.0 / (1.0 / ARMATURE + 1.0 / CARRIED)
FREQUENCY, RATIO = np.sqrt(STIFFNESS / REDUCED), DAMPING / (2.0 * np.sqrt(STIFFNESS * REDUCED))


def begun(name: str) -> list[dict[str, float]]:
    """Where ``name`` is begun in the place of a flexible joint of the given stiffness and damping."""
    rigid = nominal()
    system = replace(rigid, joints=(replace(rigid.joints[0], armature=ARMATURE),))
    runs = releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0)
    predictor = Predictor(pose(system, runs))
    by_key = {c.key: c for c in candidates(system, runs)}
    gives, other = by_key["joint_flexibility@pivot"], by_key[name]
    others: NDArray[np.float64] = np.zeros(len(predictor.nominal))
    x = np.concatenate([others, to_internal(gives, np.array([STIFFNESS, DAMPING]))])
    hypothesis = Hypothesis((other,))
    found = in_tune(predictor, Hypothesis((gives,)), x, 0, others, other)
    return [other.effect.named(predictor.effect_values(hypothesis, 0, start)) for start in found]


def test_a_link_begins_at_the_frequency_and_damping_of_the_joint_that_gives() -> None:
    first = begun("link_flexibility@rod")[0]
    assert first["frequency"] == pytest.approx(FREQUENCY / (2.0 * np.pi), rel=1e-6)
    assert first["damping_ratio"] == pytest.approx(RATIO, rel=1e-6)


def test_a_base_begins_with_the_frequency_and_with_the_give_of_the_joint() -> None:
    ringing, giving = begun("base_compliance@base")
    carriage = ringing["mass"]
    # The base and the rod's centre of mass shift against one another, and the joint is free to turn. Armature turns the rod alone.
    about = CARRIED + ARMATURE
    moved = carriage + MASS - (MASS * COM) ** 2 / about
    assert ringing["stiffness"] == pytest.approx(FREQUENCY**2 * moved, rel=1e-6)
    assert ringing["damping"] == pytest.approx(2.0 * RATIO * FREQUENCY * moved, rel=1e-6)
    # Under one metre per second squared sideways the coupling stores (m c)²/2k, the base (m + m_base)²/2K.
    assert giving["stiffness"] == pytest.approx(STIFFNESS * ((carriage + MASS) / (MASS * COM)) ** 2, rel=1e-6)
