"""Positions that do not go where velocities say, and terms of mechanisms whose positions are quaternions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.cases.double_pendulum import system as double_pendulum
from harness.compare.attribution import attribute
from harness.compare.kinematics import astray
from harness.denoc import Denoc
from harness.engines import registry
from harness.system.description import constant
from harness.system.random_joints import in_space, random_position

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
