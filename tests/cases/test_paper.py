"""What is computed of the paper's experiments, against hand formulas and against truths of the tests' own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.cases.paper import equations
from harness.cases.paper.links import arm
from harness.cases.paper.rig import release_rigid, rigid
from harness.cases.pendulums import GRAVITY, LENGTH, paper_inertia, paper_restoring
from harness.compare.decay.estimate import departure
from harness.compare.decay.swings import half_swings
from harness.engines.as_printed import AsPrinted
from harness.proof.paper_damping import KINDS, Trial, conceal, record


def test_the_accelerometer_reads_the_share_that_theory_gives_of_a_small_swing():
    run = release_rigid(rigid(damping=0.0), math.radians(3.0), duration=12.0)
    square = paper_restoring() / paper_inertia()
    # What gravity leaves, and the high-pass three times over (filter and two integrations), and the low-pass.
    at = 1.0 / (1.0 - 2.0j * 2.0 * math.pi / math.sqrt(square))
    share = (1.0 - GRAVITY / (square * LENGTH)) * abs(at**3 / (1.0 + 1j * math.sqrt(square) / (2.0 * math.pi * 30.0)))
    late = run.time > 6.0
    assert np.ptp(run.read["accelerometer"][late]) / np.ptp(run.angle[late]) == pytest.approx(share, rel=0.02)


def test_what_the_printed_equation_lacks_is_named_from_a_recording():
    """A recording made by the mended equations: the terms left out have the factor 1."""
    model = AsPrinted(("all",)).build(equations._rod())
    time = np.linspace(0.0, 0.8, 1601)
    run = model.simulate(np.array([-math.pi / 3.0, 0.0]), np.zeros(2), time)
    found = {m.name: m for m in equations.missing(time, run.position[:, 0], run.channels["rod.tip_deflection"])}
    assert {"elastic_stiffness_missing", "gravity_on_mode_missing"} <= set(found)
    for name in ("elastic_stiffness_missing", "gravity_on_mode_missing"):
        assert found[name].factor == pytest.approx(1.0, abs=0.03)


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
