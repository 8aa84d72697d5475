"""Beside a remainder, what a sensor would do is told only if a force that nobody has named could not do it."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from simulated_recordings import COM, GRAVITY, INERTIA, MASS, Rig, nominal, recording, swing

from harness import diagnose
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.effects.catalogue import catalogue
from harness.effects.effect import Family
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

ABOUT_JOINT = INERTIA + MASS * COM**2
SWING = float(np.sqrt(MASS * GRAVITY * COM / ABOUT_JOINT))  # rad/s
NOISE = 1e-3
LATE = 0.02  # s
CART, OWN = 0.9, 7.0  # kg, rad/s
# Without what vibrates by itself, which takes ten times as long and is no rival of a delay or a magnet.
RIGID = tuple(
    effect.name
    for effect in catalogue().values()
    if not effect.adds_coordinates and effect.family is not Family.ELASTICITY
)


def _magnet(t: float, q: float, v: float) -> float:
    """A pull towards one angle, from near it alone."""
    return -0.15 * ABOUT_JOINT * SWING**2 * (q - 0.2) * float(np.exp(-(((q - 0.2) / 0.12) ** 2)))


def _driven(t: float) -> float:
    return 0.15 * ABOUT_JOINT * SWING**2 * float(np.sin(5.1 * t) + 0.5 * np.sin(2.3 * t + 1.0))


def _late(rig: Rig, seed: int) -> Diagnosis:
    """Of three driven swings that the sensor shows late."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 8.0, 0.01)
    shown = np.maximum(time - LATE, 0.0)
    runs = []
    for k, release in enumerate((0.9, -0.6, 1.2)):
        angle = swing(rig, release, shown, _driven) + NOISE * rng.standard_normal(len(time))
        efforts = np.array([_driven(t) for t in time])
        runs.append(recording(f"run{k}", time, {"pivot.position": angle, "pivot.effort": efforts}))
    return diagnose(runs, model=nominal(), only=RIGID)


def _sensors(found: Diagnosis) -> list[str]:
    return [f["effect"] for f in found.findings if f["effect"].startswith(("sensor", "encoder", "clock"))]


def _slide() -> System:
    """A cart on a spring, nearly undamped."""
    joint = Joint(
        "slide", JointType.PRISMATIC, "base", "cart", axis=constant([1.0, 0.0, 0.0]), stiffness=CART * OWN**2,
        damping=0.02 * CART * OWN,
    )  # fmt: skip
    cart = Link("cart", CART, constant([0.0, 0.0, 0.0]), constant(np.diag([0.01, 0.01, 0.01])))
    return System("slide", (joint,), (cart,), tolerance=0.01)


def test_drag_in_one_direction_is_no_error_of_the_sensor() -> None:
    def rate(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -(OWN**2) * y[0] - 0.02 * OWN * y[1] - 0.25 * max(y[1], 0.0)]

    rng = np.random.default_rng(21)
    time = np.arange(0.0, 8.0, 0.005)
    runs = []
    for k, release in enumerate((0.11, -0.15, 0.06)):
        course = solve_ivp(rate, (0.0, 8.0), [release, 0.0], t_eval=time, rtol=1e-9, atol=1e-12, max_step=0.01).y[0]
        runs.append(recording(f"run{k}", time, {"slide.position": course + 8e-5 * rng.standard_normal(len(time))}))
    found = diagnose(runs, model=_slide())
    assert found.verdict in ("unexplained", "partly_explained")
    assert _sensors(found) == []
    assert "max(v, 0)" in found.remainder["residual_torque"]


def test_a_late_sensor_is_told_beside_a_magnet() -> None:
    found = _late(Rig(torque=_magnet), 22)
    assert found.verdict == "partly_explained"
    # A drive as late moves the rig as late, so that it may be told for the class.
    (late,) = (f for f in found.findings if f["effect"] in ("sensor_delay", "actuator_delay"))
    assert "sensor_delay" in {late["effect"], *(name.split("@")[0] for name in late["indistinguishable_from"])}
    assert set(_sensors(found)) <= {"sensor_delay"}
    low, high = late["parameters"]["delay"]["ci95"]
    assert low - 1e-3 < LATE < high + 1e-3
