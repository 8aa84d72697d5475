"""A law that is not quite the one of nature is one effect, not two."""

from simulated_recordings import Rig, nominal, releases

from harness.diagnose.diagnose import diagnose

VISCOUS = 2e-3


def found(share: float, noise: float) -> list[str]:
    """Effects named where the coefficient of damping grows by ``share`` from rest to 3 rad/s."""
    rig = Rig(viscous=VISCOUS, torque=lambda t, q, v: -VISCOUS * share * (v / 3.0) ** 2 * v)
    said = diagnose(releases(rig, (1.0, 0.7), noise, 3, duration=6.0), model=nominal())
    return [f["effect"] for f in said.findings]


def test_damping_that_grows_by_a_thousandth_is_viscous() -> None:
    assert found(1e-3, 5e-6) == ["viscous_damping"]


def test_damping_that_grows_by_a_tenth_is_not_only_viscous() -> None:
    assert found(0.1, 5e-6) != ["viscous_damping"]
