"""Recordings of one rig with known weights: a model for each, and laws that they share.

Truth: the textbook equation of a pendulum (Goldstein, Classical Mechanics, ch. 3), integrated by SciPy; a point mass m at r adds
m, m r and m r² to mass, first and second moment.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, recording, swing

from harness.diagnose.diagnose import diagnose
from harness.diagnose.problem.payloads import carrying, payload
from harness.errors import InputError
from harness.recording import Recording
from harness.system import System
from harness.system.description import constant
from harness.system.inertia import point_inertia

TIP = 0.5  # m, where weights hang
WEIGHTS = (0.0, 0.1, 0.25)  # kg
DRY, NOISE = 0.004, 1e-3  # N·m, rad
LAWS = ("viscous_damping", "coulomb_friction", "quadratic_drag", "payload_mass", "constant_torque", "added_inertia")


def weighted(weight: float) -> System:
    """The nominal model with a point mass at its tip."""
    system = nominal()
    link = system.links[0]
    mass = MASS + weight
    com = np.array([0.0, 0.0, -(MASS * COM + weight * TIP) / mass])
    arms = np.array([[0.0, 0.0, -COM] - com, [0.0, 0.0, -TIP] - com])
    own = np.asarray(link.inertia) + point_inertia(MASS, arms[0]) + point_inertia(weight, arms[1])
    return replace(system, links=(replace(link, mass=mass, com=constant(com), inertia=constant(own)),))


def released(weight: float, angle: float, seed: int) -> Recording:
    mass = MASS + weight
    com = (MASS * COM + weight * TIP) / mass
    about = INERTIA + MASS * COM**2 + weight * TIP**2
    rig = Rig(mass=mass, com=com, inertia=about - mass * com**2, dry=DRY)
    time = np.arange(0.0, 12.0, 0.01)
    noisy = swing(rig, angle, time) + NOISE * np.random.default_rng(seed).standard_normal(len(time))
    return recording(f"{weight:g} kg", time, {"pivot.position": noisy})


def test_friction_that_payloads_share_is_found_beside_a_model_for_each() -> None:
    runs = [released(weight, 0.9, seed) for seed, weight in enumerate(WEIGHTS)]
    told = diagnose(runs, model=[weighted(weight) for weight in WEIGHTS], only=LAWS)
    assert told.verdict == "explained"
    (found,) = told.findings
    assert found["effect"] == "coulomb_friction"
    low, high = found["parameters"]["torque"]["ci95"]
    assert low <= DRY <= high
    # What is missing at the joint has no slope over the angle, as weights that are known would give it.
    assert told.curves is not None
    (missing,) = told.curves.forces
    assert abs(np.polyfit(missing.position, missing.force, 1)[0]) < 0.02  # N·m/rad
    # The recording held out is the heaviest, and its model is run again in other engines.
    assert all(row["difference"] is None or row["note"] == "" for row in told.replayed().replay)


@pytest.mark.slow
def test_one_model_for_all_cannot_explain_them() -> None:
    runs = [released(weight, 0.9, seed) for seed, weight in enumerate(WEIGHTS)]
    told = diagnose(runs, model=weighted(0.0), only=LAWS)
    assert told.verdict in ("unexplained", "partly_explained")


def test_what_a_link_carries_is_the_difference_of_two_models() -> None:
    change = payload(weighted(0.1), weighted(0.25))
    assert change["rod"][[0, 3]] == pytest.approx([0.15, -0.15 * TIP], abs=1e-15)
    assert change["rod"][4:6] == pytest.approx([0.15 * TIP**2] * 2, abs=1e-15)
    loaded = carrying(weighted(0.1), change).links[0]
    assert loaded.mass == pytest.approx(MASS + 0.25)
    assert np.asarray(loaded.inertia) == pytest.approx(np.asarray(weighted(0.25).links[0].inertia), abs=1e-12)
    assert payload(weighted(0.1), weighted(0.1)) == {}


def test_models_of_other_mechanisms_are_refused() -> None:
    system = nominal()
    damped = system.replace_joint(replace(system.joints[0], damping=0.3))
    with pytest.raises(InputError, match=r"more than what its links carry \(damping = 0.3\)"):
        payload(system, damped)
    runs = [released(0.0, 0.9, 1)] * 3
    with pytest.raises(InputError, match="2 models for 3 recordings"):
        diagnose(runs, model=[system, system])
    with pytest.raises(InputError, match="efforts are fitted to one model"):
        diagnose(runs, model=[system, system, system], fit_effort=True)
