"""Shapes in which two motions part, on motions that part by construction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.cases import double_pendulum, four_bar, large_swings
from harness.cases.case import NATIVE, Case
from harness.cases.checks import TrajectoryAgreement
from harness.cases.checks.chaotic import ChaoticAgreement
from harness.cases.checks.loop_motion import LoopMotion
from harness.cases.gate.defects import Defect, SpoiledEngine
from harness.cases.pendulums import GRAVITY
from harness.cases.run import run_case
from harness.compare.divergence_shape import course_of, growth, shape_of
from harness.denoc import Denoc
from harness.engines import registry
from harness.system import System
from harness.system.description import constant

TIME = np.linspace(0.0, 10.0, 501)
SWING = np.sin(3.0 * TIME)


@pytest.mark.parametrize(
    ("other", "shape"),
    [
        (SWING + 1e-3, "offset"),
        (SWING + 1e-3 * TIME, "secular"),
        (SWING + 1e-4 * TIME**2, "secular"),
        (np.sin(3.0 * (TIME + 1e-3)), "phase"),
        (np.sin(3.0003 * TIME), "phase"),
        (SWING + 1e-9 * np.exp(1.5 * TIME), "exponential"),
        (SWING + 1e-9 * np.exp(1.5 * TIME) * np.sin(9.0 * TIME), "exponential"),
        (SWING + 1.0 / (1.0 + np.exp(-4.0 * (TIME - 6.0))), "exponential"),
        # A spring that is off lets the swing run ahead; a damping that is off lets it die away sooner.
        (SWING * np.exp(-1e-4 * TIME), "secular"),
        (SWING + 1e-6 * TIME**4, "secular"),
        (SWING + 1e-3 * (TIME > 9.0), ""),
        (SWING, ""),
        (SWING + 1e-3 * np.random.default_rng(1).standard_normal(501), ""),
        (np.where(TIME < 9.0, SWING, np.nan), ""),
    ],
)
def test_the_shape_is_named(other, shape):
    assert shape_of(TIME, SWING, other) == shape


# Beside its upright rest a pendulum of 1 m falls as cosh(√g t): what is a little off grows e-fold in 1/√g.
RATE = np.sqrt(GRAVITY)


def _heavier(system: System, factor: float) -> System:
    return replace(system, gravity=constant(factor * np.asarray(system.gravity)))


@pytest.mark.parametrize(("span", "start"), [(2.0, 1e-3), (3.0, 1e-4), (4.0, 1e-5), (6.0, 1e-7), (8.0, 1e-8)])
def test_beside_an_upright_rest_motions_part_exponentially_at_the_rate_of_the_fall(span, start):
    time = np.linspace(0.0, span, round(100.0 * span) + 1)
    model = Denoc(large_swings.system())
    first, nudged = (model.simulate([np.pi + x], [0.0], time).position[:, 0] for x in (start, 1.001 * start))
    pushed = model.simulate([np.pi + start], [0.0], time, tau=np.full((time.size, 1), 0.01 * start)).position[:, 0]
    lighter = Denoc(_heavier(large_swings.system(), 0.9999)).simulate([np.pi + start], [0.0], time).position[:, 0]
    assert {shape_of(time, first, other) for other in (nudged, pushed, lighter)} == {"exponential"}
    assert growth(time, nudged - first) == pytest.approx(RATE, rel=0.05)


@pytest.mark.parametrize("span", [8.0, 10.0, 20.0])
def test_neighbouring_chaotic_swings_part_exponentially_even_where_they_end_unlike(span):
    time = np.linspace(0.0, span, round(100.0 * span) + 1)
    system = double_pendulum.system()
    first = Denoc(system).simulate([2.5, 2.0], [0.0, 0.0], time).position
    nudged = Denoc(system).simulate([2.5 + 1e-10, 2.0], [0.0, 0.0], time).position
    heavier = Denoc(_heavier(system, 1.0 + 1e-9)).simulate([2.5, 2.0], [0.0, 0.0], time).position
    for other in (nudged, heavier):
        assert [shape_of(time, first[:, k], other[:, k]) for k in range(2)] == ["exponential"] * 2


@pytest.mark.parametrize("span", [3.0, 10.0, 30.0])
def test_regular_swings_do_not_part_exponentially(span):
    time = np.linspace(0.0, span, round(100.0 * span) + 1)
    system = double_pendulum.system()
    first = Denoc(system).simulate([0.3, 0.2], [0.0, 0.0], time).position
    damped = replace(system, joints=tuple(replace(joint, damping=1e-6) for joint in system.joints))
    geared = replace(system, joints=tuple(replace(joint, armature=1e-8) for joint in system.joints))
    for other in (damped, geared, _heavier(system, 1.0 + 1e-6)):
        run = Denoc(other).simulate([0.3, 0.2], [0.0, 0.0], time).position
        assert {shape_of(time, first[:, k], run[:, k]) for k in range(2)} <= {"secular", "phase"}


def test_a_row_says_that_motions_parted_exponentially_and_how_fast():
    check = TrajectoryAgreement(1e-8, "", position=(("pivot", np.pi + 1e-5),), duration=4.0)
    case = Case("upright", "upright", "closed form", large_swings.system, (check,))
    spoiled: Any = SpoiledEngine(
        registry.engine(NATIVE), Defect("gravity", "", "", spoil=lambda system: _heavier(system, 1.0001))
    )
    (row,) = run_case(case, {NATIVE: spoiled, "analytic": registry.engine("analytic")}).rows
    assert row.verdict == "fail"
    where = dict(row.first_divergence or {})
    assert where["shape"] == "exponential"
    # A rate that is off makes t·exp: faster than the fall at first, by 1/t.
    assert RATE < where["growth"] < 1.5 * RATE


@pytest.mark.parametrize(
    ("later", "shape"),
    [(lambda t: 1e-3 + 0.0 * t, "offset"), (lambda t: 1e-3 * t, "secular"), (lambda t: 1e-3 * t**2, "secular")],
)
def test_the_shape_is_read_from_where_the_difference_begins(later, shape):
    """A long time as one motion, then a jump, looks exponential over the whole run."""
    apart = np.where(TIME >= 5.0, later(TIME - 5.0), 0.0)
    begins = int(np.argmax(apart > 0.0))
    assert course_of(TIME, SWING, SWING + apart, begins) == {"shape": shape}


def test_of_closed_mechanisms_it_is_told_when_and_how_they_part():
    check = LoopMotion(position=(("crank", 0.3),), velocity=(("crank", 5.0),), mujoco=None, exudyn=None)
    case = Case("closed", "closed", "another weight", four_bar.crank_rocker, (check,))
    spoiled: Any = SpoiledEngine(
        registry.engine("pinocchio"), Defect("gravity", "", "", spoil=lambda system: _heavier(system, 1.01))
    )
    (row,) = run_case(case, {NATIVE: registry.engine(NATIVE), "pinocchio": spoiled}).rows
    assert row.verdict == "fail"
    where = dict(row.first_divergence or {})
    assert 0.0 < where["time"] < 0.1
    assert where["coordinate"] in four_bar.crank_rocker().position_names
    assert where["term"] == "gravity"


def test_within_the_horizon_of_chaos_too():
    """A hundredth of a percent more weight is the model, for it is seen long before chaos is."""
    check = ChaoticAgreement(position=(("shoulder", 2.0), ("elbow", 1.0)), duration=8.0)
    case = Case("chaos", "chaos", "another weight", double_pendulum.system, (check,))
    spoiled: Any = SpoiledEngine(
        registry.engine("pinocchio"), Defect("gravity", "", "", spoil=lambda system: _heavier(system, 1.0001))
    )
    rows = run_case(case, {NATIVE: registry.engine(NATIVE), "pinocchio": spoiled}).rows
    (row,) = rows
    where = dict(row.first_divergence or {})
    assert row.verdict == "fail"
    assert where["cause"] == "model"
    assert where["begins"] <= where["time"]
    assert "it is the model, not the integration" in row.note
