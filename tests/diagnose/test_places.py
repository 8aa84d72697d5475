"""A force over the angle is looked for at every number of periods that may do as well, and intervals own up to it."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.intervals import estimates
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.cogging_periods import replaced
from harness.diagnose.selection.profile_likelihood import profiled, spanning
from harness.diagnose.selection.study import Study

NOISE, RATE = 1e-3, 100.0
WAVE, PERIODS, PHASE = 0.004, 18, -1.1


@pytest.fixture
def bench() -> Study:
    """Two free swings of a pendulum over a small wave of 18 periods a turn."""
    rng = np.random.default_rng(8)
    time = np.arange(0.0, 6.0, 1.0 / RATE)
    rig = Rig(torque=lambda t, q, v: WAVE * np.sin(PERIODS * q + PHASE))
    runs = [
        recording(f"run{k}", time, {"pivot.position": swing(rig, a, time) + NOISE * rng.standard_normal(len(time))})
        for k, a in enumerate((1.2, -0.9))
    ]
    system = nominal(tolerance=0.005)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=["cogging_torque", "coulomb_friction"]))
    return Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))


def fitted(bench: Study, periods: int) -> Fit:
    """The set of the wave alone, fitted from a number of periods that stays within one of where it is begun."""
    (wave,) = (c for c in bench.candidates if c.effect.name == "cogging_torque")
    own = to_internal(wave, np.array([WAVE, float(periods), 0.3]))
    return bench.fit(Hypothesis((wave,)), [np.concatenate([np.zeros(len(bench.predictor.nominal)), own])], None)


def test_a_wave_fitted_at_a_wrong_number_of_periods_is_found_at_the_right_one(bench: Study) -> None:
    wrong = fitted(bench, 41)
    assert abs(estimates(bench.predictor, wrong, 0)["periods"].value - PERIODS) > 5
    best = replaced(bench, wrong)
    found = profiled(bench, best, 0, estimates(bench.predictor, best, 0))
    assert found["periods"].value == PERIODS
    assert abs(found["amplitude"].value - WAVE) < 5.0 * (found["amplitude"].std or 0.0)


def test_intervals_reach_to_places_that_are_as_likely_and_the_phase_is_then_open(bench: Study) -> None:
    best = fitted(bench, PERIODS)
    alone = estimates(bench.predictor, best, 0)
    both = spanning(best.hypothesis.members[0], alone, [np.array([0.5 * WAVE, 31.0, 2.0])])
    assert (both["periods"].low, both["periods"].high) == (PERIODS, 31.0)
    assert both["amplitude"].low <= 0.5 * WAVE < alone["amplitude"].low
    assert both["phase"].high - both["phase"].low == pytest.approx(2.0 * np.pi)
    assert alone["phase"].high - alone["phase"].low < 1.0


def test_a_search_that_cannot_come_within_reach_ends_early_and_one_that_can_does_not(bench: Study) -> None:
    (rub,) = (c for c in bench.candidates if c.effect.name == "coulomb_friction")
    objective, nominal_count = bench.objective(Hypothesis((rub,))), len(bench.predictor.nominal)
    start = np.concatenate([np.zeros(nominal_count), to_internal(rub, np.array([10.0 * WAVE]))])
    states = bench.states_for(Hypothesis((rub,)))
    patient = fit(objective, start, states, most_steps=40)
    runs = bench.predictor.lanes_run
    reached = fit(objective, start, states, most_steps=40, target=1.01 * patient.score)
    with_reach, runs = bench.predictor.lanes_run - runs, bench.predictor.lanes_run
    assert reached.score == pytest.approx(patient.score, rel=1e-3)
    given_up = fit(objective, start, states, most_steps=40, target=0.2 * patient.score)
    assert bench.predictor.lanes_run - runs < with_reach
    assert not given_up.converged
