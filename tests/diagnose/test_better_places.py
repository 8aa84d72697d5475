"""A member of a set that stands at the wrong place of a law with many valleys, and is looked for again."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import COM, MASS, Rig, nominal, releases

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

MOMENT = MASS * 9.81 * COM
CUBIC, COGGING, PERIODS = 0.03 * MOMENT, 0.03 * MOMENT, 7


def test_periods_found_beside_other_company_are_put_right() -> None:
    rig = Rig(torque=lambda t, q, v: -CUBIC * q**3 - COGGING * np.sin(PERIODS * q))
    system, runs = nominal(), releases(rig, (1.3, 0.9), 1e-3, seed=11)
    posed = pose(system, runs)
    windows = whole(posed.runs, range(len(posed.train)))
    bench = Study(
        posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), tuple(candidates(system, runs)), windows
    )
    by_key = {c.key: c for c in bench.candidates}
    cubic, cogging = by_key["cubic_stiffness@pivot"], by_key["cogging_torque@pivot"]
    # Four periods too many and held there, as a scan beside the other effect missing may leave it.
    hypothesis = Hypothesis((cubic, cogging))
    wrong = np.array([0.5 * COGGING, PERIODS + 4.0, 0.0])
    start = np.concatenate([np.zeros(len(bench.predictor.nominal)), to_internal(cubic, np.array([CUBIC])),
                            to_internal(cogging, wrong)])  # fmt: skip
    astray = bench.fit(hypothesis, [start], None, most_steps=40)
    assert bench.predictor.effect_values(hypothesis, 1, astray.x)[1] != pytest.approx(PERIODS)
    assert astray.score < 2.0 * bench.samples
    found = {f.hypothesis.identity: f for f in relatives(bench, astray, 1, 30)}[hypothesis.identity]
    amplitude, periods, _ = bench.predictor.effect_values(found.hypothesis, 1, found.x)
    assert periods == pytest.approx(PERIODS)
    assert amplitude == pytest.approx(COGGING, rel=0.2)
    assert found.score < min(astray.score, 1.1 * bench.samples)


def test_no_vibration_above_the_sampling_rate_is_sought() -> None:
    # Faster than half of it a link's ringing is not seen, but what it gives under slow forces is (one over its frequency squared).
    system, runs = nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0, rate=80.0)
    (bends,) = (c for c in candidates(system, runs) if c.key == "link_flexibility@rod")
    assert dict(zip(bends.effect.parameter_names, bends.effect.upper, strict=True))["frequency"] == pytest.approx(80.0)
