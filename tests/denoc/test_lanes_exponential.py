"""The exponential method for flexible copies, against adaptive integration of the same equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.compare.bench.flexible import pendulum, start
from harness.denoc.lanes.model import LaneModel
from harness.denoc.model import Denoc
from harness.errors import InputError, UnsupportedError
from harness.system import System
from harness.system.description import constant


def error(
    model: LaneModel, rows: np.ndarray, q0: np.ndarray, time: np.ndarray, step: float, wanted: np.ndarray
) -> float:
    position, _, _ = model.simulate(rows, q0, 0.0 * q0, time, method="exponential", step=step)
    return float(np.abs(position - wanted).max())


def test_fourth_order_at_steps_far_beyond_what_the_vibration_allows() -> None:
    # Three modes, the third at 186 Hz: a step of 1 ms is a fifth of its period.
    system = pendulum(3)
    model = LaneModel(system)
    q0, qd0 = start(model.n)
    time = np.linspace(0.0, 0.5, 126)
    wanted = np.asarray(Denoc(system).simulate(q0, qd0, time).position)
    errors = [error(model, model.row(), q0, time, step, wanted) for step in (1e-3, 5e-4, 2.5e-4)]
    peak = np.abs(wanted[:, 1:]).max()
    assert errors[0] < 0.01 * peak
    # Sixteen times less at half the step, in the limit.
    assert errors[0] > 8.0 * errors[1] > 64.0 * errors[2]


def test_velocity_and_acceleration_belong_to_the_motion() -> None:
    system = pendulum(2)
    model, textbook = LaneModel(system), Denoc(system)
    q0, qd0 = start(model.n)
    time = np.linspace(0.0, 0.4, 101)
    position, velocity, acceleration = model.simulate(model.row(), q0, qd0, time, method="exponential", step=1e-4)
    wanted = textbook.simulate(q0, qd0, time)
    assert np.abs(velocity[0] - wanted.velocity).max() < 1e-6 * np.abs(wanted.velocity).max()
    for k in (0, 50, 100):
        exact = textbook.forward_dynamics(position[0, k], velocity[0, k])
        assert acceleration[0, k] == pytest.approx(exact, rel=1e-9, abs=1e-9 * np.abs(exact).max())


def test_copies_have_their_own_parameters_and_do_not_feel_each_other() -> None:
    model = LaneModel(pendulum(2))
    rows = np.repeat(model.row()[None], 11, axis=0)
    rows[:, model.slot("rod", "payload")] = np.linspace(0.0, 0.02, 11)
    rows[:, model.slot("rod", "material_damping")] = np.linspace(0.0, 1e-4, 11)
    rows[:, model.slot("base", "excitation_amplitude")] = np.linspace(0.0, 3.0, 11)
    rows[:, model.slot("base", "excitation_frequency")] = 4.0
    q0, qd0 = start(model.n)
    time = np.linspace(0.0, 0.3, 61)
    found = model.simulate(rows, q0, qd0, time, method="exponential", step=2.5e-4)[0]
    wanted = model.simulate(rows, q0, qd0, time)[0]
    assert np.abs(found - wanted).max() < 1e-5
    alone = model.simulate(rows[4], q0, qd0, time, method="exponential", step=2.5e-4)[0]
    assert alone[0] == pytest.approx(found[4], rel=1e-12, abs=1e-14)


def test_a_flexible_link_may_carry_another() -> None:
    # The modes' frequencies change with the angle between the links, which the linearization at the start does not know.
    first = pendulum(2)
    upper, lower = first.joints[0], first.links[0]
    second = replace(upper, name="elbow", parent="rod", child="second", xyz=constant([0.0, 0.0, -0.3]))
    system = replace(first, joints=(upper, second), links=(lower, replace(lower, name="second")))
    model = LaneModel(system)
    q0 = np.zeros(model.n)
    q0[0], q0[3] = 0.6, -1.0
    time = np.linspace(0.0, 0.4, 81)
    wanted = np.asarray(Denoc(system).simulate(q0, 0.0 * q0, time).position)
    errors = [error(model, model.row(), q0, time, step, wanted) for step in (5e-4, 2.5e-4)]
    assert errors[0] < 1e-3 * np.abs(wanted).max()
    assert errors[0] > 8.0 * errors[1]


def test_rigid_pendulum_swings_as_elliptic_functions_say(rigid: System) -> None:
    # Period of a pendulum of length l at amplitude a: 4 √(l/g) K(sin(a/2)).
    from scipy.special import ellipk

    model = LaneModel(rigid)
    amplitude = 2.0
    period = 4.0 * np.sqrt(0.5 / 9.81) * ellipk(np.sin(amplitude / 2.0) ** 2)
    time = np.linspace(0.0, 2.0 * period, 401)
    position, _, _ = model.simulate(
        model.row(), np.array([amplitude]), np.zeros(1), time, method="exponential", step=1e-3
    )
    assert position[0, 200, 0] == pytest.approx(amplitude, abs=1e-8)
    assert position[0, 400, 0] == pytest.approx(amplitude, abs=1e-8)
    assert position[0, 100, 0] == pytest.approx(-amplitude, abs=1e-8)


@pytest.fixture
def rigid() -> System:
    """A point mass on a massless rod of 0.5 m."""
    from harness.system import Joint, JointType, Link

    joint = Joint("pivot", JointType.REVOLUTE, "base", "bob", axis=constant([0.0, 1.0, 0.0]))
    return System("bob", (joint,), (Link("bob", 0.3, constant([0.0, 0.0, -0.5])),))


def test_what_is_too_fast_for_the_step_is_not_a_number() -> None:
    model = LaneModel(pendulum(2))
    q0, _ = start(model.n)
    fast = np.array([200.0, 0.0, 0.0])
    position, _, _ = model.simulate(model.row(), q0, fast, np.linspace(0.0, 1.0, 51), method="exponential", step=2e-2)
    assert np.isnan(position[0, -1]).all()


def test_refusals_name_place_and_mend() -> None:
    model = LaneModel(pendulum(1))
    q0, qd0 = start(model.n)
    rows = model.row()
    time = np.linspace(0.0, 0.1, 11)
    with pytest.raises(InputError, match="evenly spaced"):
        model.simulate(rows, q0, qd0, time**2, method="exponential")
    with pytest.raises(InputError, match="method='euler'"):
        model.simulate(rows, q0, qd0, time, method="euler")
    with pytest.raises(UnsupportedError, match="free motion"):
        model.simulate(rows, q0, qd0, time, tau=np.zeros((11, 2)), method="exponential")
    rows[model.slot("pivot", "coulomb_torque")] = 0.1
    with pytest.raises(UnsupportedError, match="pivot: coulomb_torque"):
        model.simulate(rows, q0, qd0, time, method="exponential")
