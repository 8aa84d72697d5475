"""Nominal quantities bent far out of their tolerance, which imitate an effect so well that its score test sees nothing.

A weight on a rod that rubs: a free swing shows how its inertia goes with its gravity, and friction beside it, and bending mass,
length and inertia of the model does the same. Only the stated tolerance speaks against that.
"""

from __future__ import annotations

from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness import diagnose

ALIKE = {"payload_mass", "com_offset", "added_inertia", "clock_skew"}


def laden(weight: float, dry: float) -> Rig:
    """The rod with a weight at twice its centre of mass."""
    mass = MASS + weight
    com = (MASS + 2.0 * weight) * COM / mass
    return Rig(mass=mass, com=com, inertia=INERTIA + MASS * (com - COM) ** 2 + weight * (2.0 * COM - com) ** 2, dry=dry)


def test_a_weight_is_found_beside_friction_that_explains_far_more() -> None:
    found = diagnose(releases(laden(0.03, 0.006), (1.4, -1.0), 1e-3, 5, duration=8.0), model=nominal(0.02))
    assert found.verdict == "explained"
    effects = {f["effect"]: f for f in found.findings}
    assert "coulomb_friction" in effects
    (other,) = set(effects) - {"coulomb_friction"}
    told = {other, *(name.split("@")[0] for name in effects[other]["indistinguishable_from"])}
    assert told >= ALIKE
    torque = effects["coulomb_friction"]["parameters"]["torque"]
    assert torque["ci95"][0] <= 0.006 <= torque["ci95"][1]


def test_a_swing_that_goes_on_for_its_weight_is_no_creep() -> None:
    # Without the weight the rod would rest sooner. That it moves then is no sign of friction that gives way.
    found = diagnose(releases(laden(0.02, 0.03), (1.4, -1.0), 2e-3, 5), model=nominal(0.01))
    assert found.verdict == "explained"
    assert found.remainder["doubted"] == []
    (friction,) = (f for f in found.findings if f["effect"] == "coulomb_friction")
    low, high = friction["parameters"]["torque"]["ci95"]
    assert low <= 0.03 <= high
    assert len(found.findings) == 2
