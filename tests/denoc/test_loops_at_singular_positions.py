"""Loops beside a follower at positions where a condition vanishes: what is rounding there must hold nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("pinocchio")

from harness.cases.bricard import CASE
from harness.cases.case import Bench
from harness.cases.checks.states import random_states
from harness.denoc.loops.closed import Closed
from harness.engines.registry import engine
from harness.system import Joint, JointType, Link, Loop, Mimic


def test_accelerations_column_by_column_are_pinocchios_where_a_row_of_the_conditions_vanishes():
    system = CASE.system()
    models = {name: engine(name).build(system) for name in ("denoc", "pinocchio")}
    states = random_states(Bench(CASE, system, models), 24, 1.0, 1.0, 0.0)
    first = system.joints[0]
    pointer = Joint("pointer", JointType.REVOLUTE, first.child, "pointer", axis=first.axis, mimic=Mimic(first.name))
    # Closed from the other end: of the first there the vanishing rows are zero, and not nearly so.
    loops = tuple(
        replace(loop, first=loop.second, second=loop.first) for loop in system.loops if isinstance(loop, Loop)
    )
    model = Closed(
        replace(system, joints=(*system.joints, pointer), links=(*system.links, Link("pointer")), loops=loops)
    )
    singular = [np.linalg.svd(model.loop_jacobian(q), compute_uv=False)[3] < 1e-12 for q in states.q]
    assert 5 < sum(singular) < 20
    for q, v, tau in zip(states.q, states.qd, states.tau, strict=True):
        true = models["pinocchio"].forward_dynamics(q, v, tau)
        assert model.forward_dynamics(q, v, tau) == pytest.approx(true, abs=1e-10 * max(1.0, np.abs(true).max()))
