"""What recorded efforts tell of a joint that turns about: it sticks, and which way friction acts is not in its place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import sqrtm
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from simulated_recordings import nominal, recording

from harness.diagnose.inverse.band import cutoff_for, driven_at, pace
from harness.diagnose.inverse.effort_fit import EffortData
from harness.diagnose.inverse.effort_model import EffortModel
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.effort_noise import effort_noise, grid_of
from harness.diagnose.inverse.ordinary_torque import link_terms, ordinary_torque
from harness.diagnose.inverse.pushes import find_pushes
from harness.diagnose.problem.hypothesis import Hypothesis

SYSTEM = nominal()
RATE, DRY, EARLY = 250.0, 0.4, 0.03  # Hz; N·m; s by which friction goes over before a joint's wanted speed does
TIME = np.arange(0.0, 24.0, 1.0 / RATE)
WAY = 0.8 * np.sin(2.0 * np.pi * 0.4 * TIME) + 0.3 * np.sin(2.0 * np.pi * 0.7 * TIME + 1.0)


def wanted(time: np.ndarray) -> np.ndarray:
    """The speed that a joint is asked for [rad/s]."""
    parts = ((0.8, 0.4, 0.0), (0.3, 0.7, 1.0))
    return np.sum([a * 2.0 * np.pi * f * np.cos(2.0 * np.pi * f * time + p) for a, f, p in parts], axis=0)


# It sticks while that is less than 0.3 rad/s, and begins and stops at once.
SPEED = np.where(np.abs(wanted(TIME)) > 0.3, wanted(TIME), 0.0)
RESTS = SPEED == 0.0
RNG = np.random.default_rng(3)
ANGLE = np.cumsum(SPEED) / RATE + 5e-5 * RNG.standard_normal(len(TIME))
FRICTION = DRY * np.sign(wanted(TIME + EARLY)) + 0.004 * RNG.standard_normal(len(TIME))
RECORDED = recording("run", TIME, {"pivot.position": ANGLE, "pivot.effort": FRICTION})
CUTOFF = 3.0
RUN = effort_run(SYSTEM, RECORDED, CUTOFF)


def test_a_joint_at_rest_between_two_motions_has_no_direction():
    """The motion's own low-pass rings by a tenth of the speed after a stop; a straight line through a short stretch does not."""
    rests = np.interp(RUN.time, TIME, RESTS.astype(float))
    step = float(RUN.time[1] - RUN.time[0])
    deep = RUN.usable & (minimum_filter1d(rests, round(0.06 / step)) == 1.0)
    assert np.count_nonzero(deep) > 30
    assert np.abs(RUN.direction[deep, 0]).max() < 0.7
    assert np.abs(np.tanh(RUN.qd[deep, 0] / RUN.still[0])).max() > 0.9
    fast = RUN.usable & (maximum_filter1d(rests, round(0.08 / step)) == 0.0)
    assert np.all(RUN.direction[fast, 0] * np.sign(wanted(RUN.time[fast])) > 0.999)


def test_slopes_over_short_stretches_have_the_noise_of_a_straight_line():
    """σ_v = σ/Δt √(12/(n(n²−1))): a joint may rest below five standard deviations of it."""
    still = recording("still", TIME, {"pivot.position": 1.0 * TIME + 1e-3 * np.random.default_rng(1).standard_normal(len(TIME)),
                                      "pivot.effort": FRICTION})  # fmt: skip
    run = effort_run(SYSTEM, still, CUTOFF)
    spread = float(np.std(run.sharp[run.usable, 0]))
    assert run.still[0] == pytest.approx(5.0 * spread, rel=0.15)


def data_of(dry: float) -> EffortData:
    noise = effort_noise([0.004 * np.random.default_rng(5).standard_normal(400)], dry)
    return EffortData(EffortModel(SYSTEM, [RUN]), (grid_of(RUN),), (noise,))


def test_rows_are_whitened_for_a_turn_that_comes_early_every_time():
    """Σ = W⁻² + u uᵀ in units of the noise: the rows' covariance, were friction off so, becomes one; by SciPy's matrix root."""
    data = data_of(DRY)
    without = data_of(0.0)
    whitened = data.whitened
    rows = len(whitened.weights)
    assert rows > 60
    plain = without.rows(Hypothesis(), np.zeros(len(data.model.nominal)))
    late = whitened._late
    expected = np.linalg.inv(np.real(sqrtm(np.eye(rows) + np.outer(late, late)))) @ (whitened.weights * plain)
    assert np.allclose(
        data.rows(Hypothesis(), np.zeros(len(data.model.nominal))), expected, atol=1e-9 * np.abs(plain).max()
    )


def test_a_row_counts_for_less_where_friction_is_unsure():
    """1/(1 + (F d/σ)²) of a sample, d the share of the smoothed direction that is unsure: inverse variance."""
    data = data_of(DRY)
    (grid,) = data.grids
    samples = np.concatenate(grid.stretches)
    expected = 1.0 / (1.0 + (DRY * RUN.unsure[samples, 0] / data.noises[0].std) ** 2)
    if not data.noises[0].ahead.any():
        assert np.allclose(data.whitened.weights**2, expected)
    assert data.samples == pytest.approx(float(np.sum(data.whitened.weights**2)))
    assert data.samples < 0.9 * len(samples)
    assert data_of(0.0).samples == len(samples)


def test_friction_at_turns_is_no_push():
    """Recorded friction goes over 0.03 s before the joint turns: nobody pushes."""
    assert find_pushes(SYSTEM, [RUN]) == ()


def test_the_noise_of_an_effort_is_found_beside_a_law_nobody_stated():
    """A rotor's inertia and cogging of nine waves a turn, beyond what scaled inertia, gravity and friction can do."""
    rng = np.random.default_rng(7)
    rotor = 0.05 * np.gradient(np.gradient(WAY, TIME), TIME)
    effort = rotor + 0.3 * np.sin(9.0 * WAY + 0.5) + 0.02 * rng.standard_normal(len(TIME))
    run = effort_run(SYSTEM, recording("run", TIME, {"pivot.position": WAY + 1e-5 * rng.standard_normal(len(TIME)),
                                                     "pivot.effort": effort}), CUTOFF)  # fmt: skip
    left = ordinary_torque(SYSTEM, [run], 0, link_terms(SYSTEM, [run])).left[0][run.usable]
    # White noise through a Butterworth of order 4 there and back: ∫ df/(1 + (f/fc)⁸)² = 0.897 fc of the band to 125 Hz.
    assert float(np.std(left)) == pytest.approx(0.02 * np.sqrt(0.897 * CUTOFF / 125.0), rel=0.25)


def test_an_upright_axis_is_looked_at_as_fast_as_it_is_driven():
    """A joint that swings once in minutes but is driven at 0.5 Hz: the mean frequency of two waves is √(Σf²a²/Σa²)."""
    noise = 1e-3 * np.random.default_rng(2).standard_normal(len(TIME))
    run = recording("run", TIME, {"pivot.position": WAY + noise, "pivot.effort": FRICTION})
    expected = np.sqrt((0.4**2 * 0.8**2 + 0.7**2 * 0.3**2) / (0.8**2 + 0.3**2))
    assert driven_at(run, "pivot") == pytest.approx(expected, rel=0.02)
    weightless = replace(SYSTEM, gravity=np.asarray(SYSTEM.gravity) * 1e-6)
    assert pace(weightless, run) == pytest.approx(expected, rel=0.02)
    assert cutoff_for(weightless, run, pace(weightless, run)) > expected


def test_what_a_regression_foretells_of_another_motion_is_no_push():
    """An excursion of ten times the swing that it may not look at: fits to different noise err there by far more than the noise."""
    far = WAY + 8.0 * np.exp(-(((TIME - 12.0) / 0.4) ** 2))
    there, told = [], []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        effort = 0.3 * far**3 + 0.05 * rng.standard_normal(len(TIME))
        reading = far + 1e-6 * rng.standard_normal(len(TIME))
        run = effort_run(SYSTEM, recording("run", TIME, {"pivot.position": reading, "pivot.effort": effort}), CUTOFF)
        run = run.without((run.time > 10.5) & (run.time < 13.5))
        found = ordinary_torque(SYSTEM, [run], 0, link_terms(SYSTEM, [run]))
        k = int(np.argmin(np.abs(run.time - 12.0)))
        there.append(abs(found.left[0][k]))
        told.append(abs(found.surely([run], 0)[0][k]))
        assert np.all(found.reach[0][run.usable] == 1.0)
    # White noise through a Butterworth of order 4 there and back, as above.
    noise = 0.05 * np.sqrt(0.897 * CUTOFF / 125.0)
    assert max(there) > 50.0 * noise
    assert max(told) < 6.0 * noise
