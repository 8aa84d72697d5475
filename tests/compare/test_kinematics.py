"""Positions that do not go where velocities say, and terms of mechanisms whose positions are quaternions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.cases.double_pendulum import system as double_pendulum
from harness.compare.attribution import attribute
from harness.compare.kinematics import astray, broken
from harness.denoc import Denoc
from harness.engines import registry
from harness.errors import UnsupportedError
from harness.system import Trajectory
from harness.system.description import constant
from harness.system.random_joints import in_space, random_position
from harness.testing import assert_dynamics_agree

TIME = np.linspace(0.0, 0.04, 21)


@pytest.mark.parametrize("build", [double_pendulum, in_space])
def test_a_motion_follows_its_velocities(build):
    system = build()
    rng = np.random.default_rng(3)
    q, v = random_position(system, rng), rng.standard_normal(system.nv)
    assert astray(system, Denoc(system).simulate(q, v, TIME)) is None


@pytest.mark.parametrize(("build", "k"), [(double_pendulum, 1), (in_space, 4)])
def test_a_coordinate_that_goes_half_as_fast_is_named_with_its_share(build, k):
    system = build()
    rng = np.random.default_rng(3)
    run = Denoc(system).simulate(random_position(system, rng), rng.standard_normal(system.nv), TIME)
    twice = run.velocity.copy()
    twice[:, k] *= 2.0
    found = astray(system, replace(run, velocity=twice))
    assert found is not None
    assert found[0] == run.names[k]
    assert found[1] == pytest.approx(0.5, rel=1e-3)


def test_a_joint_that_dry_friction_stops_at_once_is_not_called_astray():
    system = double_pendulum()
    held = replace(system, joints=tuple(replace(joint, friction=50.0) for joint in system.joints))
    run = Denoc(held).simulate([0.1, -0.1], [0.3, 0.2], TIME)
    assert np.abs(run.velocity[1]).max() < 1e-3
    assert astray(held, run) is None


def test_terms_are_told_apart_where_positions_are_more_than_velocities():
    system = in_space()
    rng = np.random.default_rng(5)
    q = np.array([random_position(system, rng) for _ in range(6)])
    qd, tau = rng.standard_normal((2, 6, system.nv))
    heavier = replace(system, gravity=constant(1.01 * np.asarray(system.gravity)))
    native = registry.engine("denoc")
    found = attribute(native.build(system), native.build(heavier), q, qd, tau)
    assert found.culprit is not None
    assert (found.culprit.term, found.culprit.words) == ("gravity", "gravity is 1.01 times the reference's")


def stepped(model, method, length, duration, q, v):
    """A motion step by step; method: of q, v and the step, from the definitions of both methods."""
    rows = [(np.array(q), np.array(v))]
    for _ in range(round(duration / length)):
        rows.append(method(model, *rows[-1], length))
    position, velocity = (np.array(column) for column in zip(*rows, strict=True))
    return Trajectory(np.linspace(0.0, duration, len(rows)), model.names, position, velocity)


def forward(model, q, v):
    return model.forward_dynamics(q, v, np.zeros(len(v)))


def runge_kutta(position=1.0, velocity=1.0):
    """The classical method, the second stage's weight in the positions or in the velocities times a factor."""

    def method(model, q, v, h):
        k = [(v, forward(model, q, v))]
        for share in (0.5, 0.5, 1.0):
            dq, dv = k[-1]
            k.append((v + share * h * dv, forward(model, q + share * h * dq, v + share * h * dv)))
        weights = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
        at, by = weights.copy(), weights.copy()
        at[1] *= position
        by[1] *= velocity
        return (
            q + h * sum(w * one for w, (one, _) in zip(at, k, strict=True)),
            v + h * sum(w * one for w, (_, one) in zip(by, k, strict=True)),
        )

    return method


def symplectic_euler(model, q, v, h):
    v = v + h * forward(model, q, v)
    return q + h * v, v


def found_broken(method, order):
    system = double_pendulum()
    model = Denoc(system)
    start = [1.0, -0.5], [0.3, 0.8]
    return broken(
        system, lambda h: stepped(model, method, h, 0.5, *start), lambda q, v: forward(model, q, v), 5e-3,
        order=order, allowed=1e-9,
    )  # fmt: skip


@pytest.mark.parametrize("order", [1.0, 4.0])
@pytest.mark.parametrize(
    ("method", "term"),
    [(runge_kutta(position=0.999), "position_rates"), (runge_kutta(velocity=0.999), "velocity_rates")],
)
def test_the_integral_that_has_a_wrong_weight_is_named(method, term, order):
    found = found_broken(method, order)
    assert found is not None
    assert found.term == term
    assert found.order == pytest.approx(0.0, abs=0.3)


def test_methods_of_their_due_order_are_left_alone():
    assert found_broken(runge_kutta(), 4.0) is None
    assert found_broken(symplectic_euler, 1.0) is None


class Stepping:
    """An engine with the right accelerations, and steps of its own."""

    name = "stepping"
    method = staticmethod(runge_kutta(position=0.99))

    def build(self, system):
        outer = self

        class Model:
            names = Denoc(system).names

            def __init__(self):
                self.model = Denoc(system)

            def forward_dynamics(self, q, qd, tau):
                return self.model.forward_dynamics(q, qd, tau)

            def inverse_dynamics(self, q, qd, qdd):
                return self.model.inverse_dynamics(q, qd, qdd)

            def simulate(self, q0, qd0, time, step=None):
                if step is None:
                    raise UnsupportedError("a step is needed")
                inner = max(1, round((time[1] - time[0]) / step))
                run = stepped(self.model, outer.method, (time[1] - time[0]) / inner, time[-1], q0, qd0)
                return run.position[::inner], run.velocity[::inner]

        return Model()


def test_an_engine_whose_steps_are_wrong_in_the_positions_alone_is_told_so():
    with pytest.raises(AssertionError, match="in stepping the positions of elbow do not go where its velocities say"):
        assert_dynamics_agree(Stepping, double_pendulum(), quantities=("acceleration", "trajectory"))


def test_steps_of_order_one_are_not_called_wrong():
    class Euler(Stepping):
        method = staticmethod(symplectic_euler)

    with pytest.raises(AssertionError) as told:
        assert_dynamics_agree(Euler, double_pendulum(), quantities=("acceleration", "trajectory"))
    assert "do not go where" not in str(told.value)
    assert "cause solver" in str(told.value)
