"""A delayed reading of a release from rest: the time shift can hardly be told from another initial state, but for the beginning."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.least_squares import fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.rewrites.relatives import relatives
from harness.diagnose.selection.study import Study

DELAY, NOISE, RATE = 0.04, 1e-3, 250.0


@pytest.fixture
def bench() -> Study:
    """Two free swings whose reading stands still for the delay."""
    rng = np.random.default_rng(11)
    time = np.arange(0.0, 8.0, 1.0 / RATE)
    late = [swing(Rig(), angle, np.maximum(time - DELAY, 0.0)) for angle in (1.5, 0.9)]
    runs = [
        recording(f"run{k}", time, {"pivot.position": q + NOISE * rng.standard_normal(len(time))})
        for k, q in enumerate(late)
    ]
    system = nominal(tolerance=0.01)
    posed = pose(system, runs)
    predictor, likelihood = Predictor(posed), Likelihood(posed, crude_colours(posed))
    return Study(posed, predictor, likelihood, tuple(candidates(system, runs)), whole(posed.runs, range(2)))


def test_a_step_along_which_the_states_go_far_is_not_the_end_of_the_way(bench: Study) -> None:
    base = bench.empty()
    (late,) = (c for c in bench.candidates if c.key == "sensor_delay@pivot.position")
    hypothesis = Hypothesis((late,))
    x = np.concatenate([base.x, to_internal(late, np.array([0.1 * DELAY]))])
    objective, states = bench.objective(hypothesis), bench.states_for(hypothesis, base)
    ((cost, _),) = objective.residuals([(x, states)])
    assert cost > 5.0 * base.cost  # all samples are shifted, until the initial states follow
    found = fit(objective, x, states, most_steps=25, enough=0.2)
    # A delay of nothing fits as the base does; with all else free a fit may not do worse.
    assert found.score < base.score + 1.0


def test_a_delay_is_found_from_a_release_that_is_as_late(bench: Study) -> None:
    (release,) = (c for c in bench.candidates if c.key == "late_release@pivot.position")
    hypothesis = Hypothesis((release,))
    x = np.concatenate([np.zeros(len(bench.predictor.nominal)), to_internal(release, np.array([DELAY]))])
    best = bench.fit(hypothesis, [x], None, most_steps=40)
    assert best.score < 1.1 * bench.samples
    found = {f.hypothesis.keys: f for f in relatives(bench, best, 0, 60)}
    delayed = found["sensor_delay@pivot.position",]
    assert delayed.score < 1.1 * bench.samples
    assert bench.predictor.effect_values(delayed.hypothesis, 0, delayed.x) == pytest.approx([DELAY], rel=0.05)
