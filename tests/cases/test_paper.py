"""What is computed of the paper's experiments, against hand formulas and against truths of the tests' own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from harness.cases.beams import closed_form, strip
from harness.cases.paper import readings
from harness.cases.paper.links import Motion, arm, compared, configurations
from harness.cases.paper.rig import release_rigid, rigid
from harness.cases.pendulums import GRAVITY, LENGTH, paper_inertia, paper_restoring
from harness.compare.decay.estimate import departure
from harness.compare.decay.swings import half_swings
from harness.engines import registry
from harness.proof.paper_damping import KINDS, Trial, conceal, record


def test_the_accelerometer_reads_the_share_that_theory_gives_of_a_small_swing():
    run = release_rigid(rigid(damping=0.0), math.radians(3.0), duration=12.0)
    square = paper_restoring() / paper_inertia()
    # What gravity leaves, and the high-pass three times over (filter and two integrations), and the low-pass.
    at = 1.0 / (1.0 - 2.0j * 2.0 * math.pi / math.sqrt(square))
    share = (1.0 - GRAVITY / (square * LENGTH)) * abs(at**3 / (1.0 + 1j * math.sqrt(square) / (2.0 * math.pi * 30.0)))
    late = run.time > 6.0
    assert np.ptp(run.read["accelerometer"][late]) / np.ptp(run.angle[late]) == pytest.approx(share, rel=0.02)


def test_arms_are_as_long_as_their_letters():
    system = arm("RFR", modes=2)
    assert system.joint_names == ("joint1", "joint2", "joint3")
    assert [link.flexible for link in system.links] == [False, True, False]
    assert len(system.coordinate_names) == 5


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_concealed_takes_its_share_and_no_more(kind):
    """The first swings from 90° lose what ξ = 1.9e-3 N·m·s would make them lose, within what an estimate by hand can be."""
    truth = conceal(kind, np.random.default_rng(3))
    recording = record(Trial(truth, 90.0, 6.0, 1))
    found = half_swings(recording.time, recording.channels[0].values, sine=True)
    plain = release_rigid(rigid(), -math.pi / 2.0, duration=6.0)
    expected = half_swings(plain.time, plain.angle, sine=True)
    ratio = found.amplitude[4] / found.amplitude[0] / (expected.amplitude[4] / expected.amplitude[0])
    assert ratio == pytest.approx(1.0, abs=0.12)


def test_a_linear_swing_is_not_left_and_a_dry_one_is():
    plain = release_rigid(rigid(), -math.pi / 2.0, duration=15.0)
    assert departure(half_swings(plain.time, plain.angle, sine=True)) is None
    dry = release_rigid(replace(rigid(damping=8e-4, friction=2.2e-3)), -math.pi / 2.0, duration=15.0)
    left = departure(half_swings(dry.time, dry.angle, sine=True))
    assert left is not None
    assert 3.0 < left < 15.0


def test_concealed_decays_lose_what_dry_friction_takes_over_each_half_swing():
    """J ω² (cos q₁ − cos q₀) = torque (|q₀| + |q₁|) from turning point to turning point, and rest where gravity cannot win."""
    torque, time = 0.012, np.linspace(0.0, 14.0, 14001)
    angle = readings.motion((0.0, torque, 0.0), -math.pi / 2.0, time)
    turning = [-math.pi / 2.0]
    while paper_restoring() * math.sin(abs(turning[-1])) > torque:
        now = turning[-1]
        turning.append(
            brentq(
                lambda q, now=now: paper_restoring() * (math.cos(q) - math.cos(now)) - torque * abs(q - now),
                0.0 if now < 0.0 else -abs(now),
                abs(now) if now < 0.0 else 0.0,
            )
            if paper_restoring() * (1.0 - math.cos(now)) > torque * abs(now)
            else _short_of_the_middle(now, torque)
        )
    peaks = [angle[k] for k in range(1, 14000) if (angle[k] - angle[k - 1]) * (angle[k + 1] - angle[k]) < 0.0]
    assert peaks == pytest.approx(turning[1 : len(peaks) + 1], abs=2e-5)
    assert len(peaks) >= len(turning) - 2
    assert angle[-1] == pytest.approx(turning[-1], abs=1e-6)


def _short_of_the_middle(now, torque):
    def lost(q):
        return paper_restoring() * (math.cos(q) - math.cos(now)) - torque * abs(q - now)

    return brentq(lost, 0.0, now * (1.0 - 1e-6))


def test_concealed_decays_without_dry_friction_are_those_of_mujoco():
    time = np.linspace(0.0, 5.0, 1001)
    model = registry.engine("mujoco").build(rigid(damping=1e-3, drag=4e-4))
    run = model.simulate(np.array([-1.5]), np.zeros(1), time)
    assert readings.motion((1e-3, 0.0, 4e-4), -1.5, time) == pytest.approx(run.position[:, 0], abs=1e-7)


def test_every_reading_errs_as_the_page_says():
    """Every sample names the laws and holds them in its intervals; the decrement takes dry friction for viscous damping."""
    for trial in (
        one for one in readings.trials(5) if one.release == 90.0 and one.laws in (("dry",), ("viscous", "dry"))
    ):
        found = readings.read(trial)
        assert found.laws == trial.laws
        off = [abs(x - c) / s for x, c, s in zip(found.sample, trial.coefficients, found.std, strict=True) if s]
        assert max(off) < 4.0
        assert found.decrement > 1.2 * trial.coefficients[0] + 5e-4
        assert found.printed > 20.0 * found.decrement


def test_an_arm_is_held_against_both_kinds_of_finite_elements():
    """By every kind and number of modes; and what a motion's finite elements are certain to is far below what one mode leaves."""
    pytest.importorskip("exudyn")
    _, errors = compared(Motion("FR", True, (1, 3), duration=0.05, elements=8, bricks=48, step=1e-4))
    assert not isinstance(errors, str)
    assert set(errors) == {"apart", "exudyn_ancf", "exudyn_ffrf"} | {
        f"{peer} {shapes} {modes}"
        for peer in ("exudyn_ancf", "exudyn_ffrf")
        for shapes in ("auto", "clamped_free")
        for modes in (1, 3)
    }
    for peer in ("exudyn_ancf", "exudyn_ffrf"):
        for shapes in ("auto", "clamped_free"):
            assert errors[f"{peer} {shapes} 3"] < 0.02 < errors[f"{peer} {shapes} 1"]
        assert errors[peer] < 0.005


def test_frequencies_of_a_strip_on_a_bar_at_a_right_angle_are_those_of_one_pinned():
    """The bar cannot move the strip's root across it: β l = 3.926602, 7.068583, 10.210176 of a beam pinned and free."""
    pytest.importorskip("exudyn")
    (found,) = configurations("RF", [math.pi / 2.0], elements=8, bricks=192)
    for k, beta in enumerate((3.926602, 7.068583, 10.210176)):
        exact = closed_form(beta, strip())
        assert found.own[k] == pytest.approx(exact, rel=1e-4)
        for peer in ("exudyn_ancf", "exudyn_ffrf"):
            assert found.peers[peer][k] == pytest.approx(exact, rel=2.5e-3)
