"""Closed forms held against published figures and against engines that integrate."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.engines import registry
from harness.engines.oscillator import oscillate
from harness.engines.pendulum import period, swing
from harness.errors import UnsupportedError
from harness.system import Joint, JointType, Link, System
from harness.system.random_systems import random_chain

# T/T0 = 2 K(sin²(A/2)) / π (DLMF §22.19(i)), tabulated and cut off after ten digits.
RATIOS = {
    30.0: 1.0174087975,
    60.0: 1.0731820071,
    90.0: 1.1803405990,
    120.0: 1.3728805006,
    150.0: 1.7622037295,
    170.0: 2.4393627196,
}


@pytest.mark.parametrize(("degrees", "ratio"), RATIOS.items())
def test_period_of_large_swings(degrees: float, ratio: float) -> None:
    amplitude = np.radians(degrees)
    length = period(amplitude, 2.0 * np.pi)
    assert length == pytest.approx(ratio, abs=1e-10)
    # A quarter period after release the pendulum hangs straight down, after half a period it is at the other side.
    angle, rate = swing(amplitude, 0.0, 2.0 * np.pi, np.array([0.0, 0.25, 0.5, 1.0]) * length)
    assert angle == pytest.approx([amplitude, 0.0, -amplitude, amplitude], abs=1e-10)
    assert rate[1] == pytest.approx(-4.0 * np.pi * np.sin(amplitude / 2.0), rel=1e-12)


def test_separatrix_is_the_gudermannian() -> None:
    # From the bottom with just the energy to stand on its head: φ = 2 arctan(sinh ωt).
    time = np.linspace(0.0, 3.0, 31)
    angle, _ = swing(0.0, 2.0 * 1.5, 1.5, time)
    assert angle == pytest.approx(2.0 * np.arctan(np.sinh(1.5 * time)), abs=1e-9)


@pytest.mark.parametrize(
    ("angle", "rate"), [(2.5, 0.0), (-2.0, 3.0), (0.4, 12.0), (0.4, -12.0), (40.0, 1.0), (-7.0, -9.0), (0.0, 0.0)]
)
def test_swing_against_mujoco(angle: float, rate: float) -> None:
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "bob", axis=np.array([0.0, 1.0, 0.0]))
    system = System("p", (pivot,), (Link("bob", 1.0, np.array([0.0, 0.0, -0.7]), np.diag([0.1, 0.2, 0.15])),))
    time = np.linspace(0.0, 5.0, 51)
    exact, stepped = (
        registry.engine(name).build(system).simulate(np.array([angle]), np.array([rate]), time, step=2.5e-4)
        for name in ("analytic", "mujoco")
    )
    # RK4 at 0.25 ms, errors accumulating over up to ten turns.
    assert exact.position == pytest.approx(stepped.position, abs=2e-10)
    assert exact.velocity == pytest.approx(stepped.velocity, abs=2e-9)
    assert np.ptp(np.asarray(exact.energy)) < 1e-12 * 100.0


def test_general_axis_and_tilted_gravity_against_pinocchio() -> None:
    for seed in range(4):
        system = replace(random_chain(1, seed, prismatic=0.0, armature=True), gravity=np.array([3.0, -4.0, -5.0]))
        q0, qd0 = np.random.default_rng(seed).normal(size=(2, 1))
        time = np.linspace(0.0, 3.0, 31)
        exact, other = (
            registry.engine(name).build(system).simulate(q0, qd0, time) for name in ("analytic", "pinocchio")
        )
        assert exact.position == pytest.approx(other.position, abs=1e-10)
        assert exact.energy == pytest.approx(other.energy, rel=1e-11, abs=1e-11)


def test_balanced_rotor_and_upright_axis_have_no_gravity() -> None:
    tilt = Rotation.from_euler("xyz", [0.3, -0.4, 0.5]).as_matrix()
    upright = Joint("j", JointType.REVOLUTE, "base", "l", rotation=tilt, axis=tilt.T @ np.array([0.0, 0.0, 1.0]))
    system = System("s", (upright,), (Link("l", 2.0, np.array([0.3, 0.4, 0.5]), 0.1 * np.eye(3)),))
    model = registry.engine("analytic").build(system)
    assert model.gravity(np.array([1.0]))[0] == 0.0
    run = model.simulate(np.zeros(1), np.ones(1), np.array([0.0, 100.0]))
    assert run.position[-1, 0] == pytest.approx(100.0, rel=1e-12)


def test_slider_falls_under_gravity_spring_damper_and_held_force() -> None:
    system = random_chain(1, 5, prismatic=1.0, armature=True)
    (joint,) = system.joints
    system = system.replace_joint(replace(joint, damping=0.7, stiffness=12.0, rest_position=0.3))
    rng = np.random.default_rng(1)
    time = np.sort(rng.uniform(0.0, 3.0, 50))
    tau = rng.normal(size=(50, 1))
    exact, other = (
        registry.engine(name).build(system).simulate(np.array([0.2]), np.array([-1.0]), time, tau=tau)
        for name in ("analytic", "pinocchio")
    )
    assert exact.position == pytest.approx(other.position, abs=1e-11)


def test_dry_friction_takes_four_thirds_less_each_swing() -> None:
    # Spring and dry friction alone: every half period 2 F_c/k is lost, until the spring cannot overcome F_c
    # (e.g. Den Hartog, Mechanical Vibrations, §2.6): from 1.0 with F_c/k = 0.15: 1, -0.7, 0.4, -0.1, and there it stays.
    stiffness, mass = 4.0, 1.0
    half = np.pi / np.sqrt(stiffness / mass)
    time = half * np.array([0.0, 1.0, 2.0, 3.0, 3.5, 10.0])
    x, v = oscillate((1.0, 0.0), mass, 0.0, stiffness, np.zeros(6), 0.6, time)
    assert x == pytest.approx([1.0, -0.7, 0.4, -0.1, -0.1, -0.1], abs=1e-12)
    assert v[-1] == 0.0


def test_dry_friction_holds_until_the_force_exceeds_it() -> None:
    time = np.array([0.0, 1.0, 2.0, 3.0])
    x, v = oscillate((0.0, 0.0), 2.0, 0.0, 0.0, np.array([0.4, 0.6, 0.0, 0.0]), 0.5, time)
    # Held; then a = 0.05 for a second; then -0.25, which stops it after 0.2 s.
    assert x == pytest.approx([0.0, 0.0, 0.025, 0.025 + 0.05 * 0.2 / 2.0], abs=1e-14)
    assert v == pytest.approx([0.0, 0.0, 0.05, 0.0], abs=1e-15)


def test_overdamped_return_with_dry_friction_stops_short() -> None:
    # m x'' + d x' + k x = -F sign(x'): creeps back and rests where k x ≤ F_c; the stop is located, not stepped over.
    x, v = oscillate((1.0, 0.0), 1.0, 10.0, 1.0, np.zeros(3), 0.5, np.array([0.0, 5.0, 500.0]))
    assert 0.5 < x[1] < 1.0
    assert x[2] == pytest.approx(0.5, abs=1e-12)
    assert v[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_native_dry_friction_sticks_as_the_closed_form_does(damping: float) -> None:
    system = random_chain(1, 5, prismatic=1.0)
    (joint,) = system.joints
    system = system.replace_joint(replace(joint, damping=damping, friction=2.5, stiffness=12.0, rest_position=0.1))
    q0, qd0, time = np.array([1.5]), np.zeros(1), np.linspace(0.0, 10.0, 501)
    # A force that rises in steps, so that the slider sticks and tears loose again.
    tau = np.floor(time / 2.0)[:, None]
    exact, native = (
        registry.engine(name).build(system).simulate(q0, qd0, time, tau=tau) for name in ("analytic", "denoc")
    )
    assert exact.position == pytest.approx(native.position, abs=1e-10)
    assert np.sum(exact.velocity[:, 0] == 0.0) > 50
    stuck = exact.velocity[:, 0] == 0.0
    assert np.max(np.abs(native.velocity[stuck][1:])) < 1e-10


def test_what_has_no_closed_form_is_refused() -> None:
    pivot = Joint("pivot", JointType.REVOLUTE, "base", "bob", axis=np.array([0.0, 1.0, 0.0]))
    system = System("p", (pivot,), (Link("bob", 1.0, np.array([0.0, 0.0, -0.7])),))
    time = np.array([0.0, 1.0])
    for change in ({"damping": 0.1}, {"stiffness": 0.1}, {"friction": 0.1}):
        with pytest.raises(UnsupportedError, match="no closed form"):
            registry.engine("analytic").build(system.replace_joint(replace(pivot, **change))).simulate(
                np.ones(1), np.zeros(1), time
            )
    with pytest.raises(UnsupportedError, match="torque"):
        registry.engine("analytic").build(system).simulate(np.ones(1), np.zeros(1), time, tau=np.ones((2, 1)))
    assert "one coordinate" in str(registry.engine("analytic").refuses(random_chain(2, 0)))
