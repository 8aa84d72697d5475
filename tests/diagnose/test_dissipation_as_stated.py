"""One law that leaves the model as it is comes before several that take back what the model states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.diagnose import diagnose

DAMPING = 1.2e-3  # stated, and true [N·m·s/rad]
SLIDING, AT_REST, SPEED = 2e-3, 4e-3, 5.0  # N·m, N·m, rad/s; the fastest swing reaches eight
NOISE = 3e-3
FEW = ("viscous_damping", "coulomb_friction", "load_dependent_friction", "stribeck_friction", "quadratic_drag")


def falling(t: float, q: float, v: float) -> float:
    """What Stribeck's friction has beyond its value at high speed [N·m]; between reversals."""
    return -(AT_REST - SLIDING) * float(np.exp(-((v / SPEED) ** 2))) * float(np.sign(v))


def test_friction_that_falls_is_not_told_as_friction_and_less_damping_than_stated() -> None:
    system = nominal()
    system = replace(system, joints=(replace(system.joints[0], damping=DAMPING),))
    rig = Rig(viscous=DAMPING, dry=SLIDING, torque=falling)
    told = diagnose(releases(rig, (1.6, 1.1, 1.35), NOISE, seed=77, duration=8.0), model=system, only=FEW)
    assert told.verdict == "explained"
    (friction,) = told.findings
    assert friction["effect"] == "stribeck_friction"
    # What does as well says so.
    assert {"viscous_damping", "coulomb_friction"} <= set(friction["indistinguishable_from"])
    other = next(r for r in told.ranking if r["effects"] == ["viscous_damping@pivot", "coulomb_friction@pivot"])
    assert "takes away what the model states" in other["lost"]
    low, high = friction["parameters"]["static_torque"]["ci95"]
    assert low < AT_REST < high
