"""What a fit leaves of a beam on a fixed joint is put to every check, though there is no joint that a force could act at."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from test_cantilever import MODEL, NOISE, OMEGA

from harness.diagnose.criticism.check import Asked, left_by
from harness.diagnose.criticism.remainder import answers, asked_of
from harness.diagnose.criticism.shaken_support import UP_AND_DOWN, shaken_up_and_down
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study
from harness.recording import Channel, Recording
from harness.system import load
from harness.system.description import constant


def _slowed(name: str, size: float, seed: int) -> Recording:
    """A tip whose vibration begins two hundredths slow and gains speed, which a beam does not: something is left of it."""
    time = np.arange(0.0, 2.0, 0.004)
    phase = OMEGA * (time + 0.02 * (np.exp(-time) - 1.0))
    tip = size * np.cos(phase) + NOISE * np.random.default_rng(seed).standard_normal(len(time))
    channel = Channel("strip.tip_deflection", "strip", "tip_deflection", "m", constant(tip))
    return Recording(name, name, constant(time), (channel,), ())


def test_every_check_of_a_beam_without_joints_answers(tmp_path: Path) -> None:
    path = tmp_path / "strip.toml"
    path.write_text(MODEL, encoding="utf-8")
    system, runs = load(path), [_slowed("one", 0.006, 1), _slowed("two", 0.004, 2)]
    posed = pose(system, runs)
    likelihood, swing = Likelihood(posed, crude_colours(posed)), 2.0 * np.pi / OMEGA
    study = Study(posed, Predictor(posed), likelihood, (), whole(posed.runs, range(2)), swing=swing)
    fitted = study.fit(Hypothesis(), [np.zeros(len(study.predictor.nominal))], None)
    assert fitted.cost > 10.0 * study.samples
    tests = [test for _, test in answers(left_by(study, fitted), asked_of(*Asked))]
    assert tests and all(np.isfinite(test.gain) for test in tests)
    # A support that moves up and down turns no joint here.
    assert shaken_up_and_down(study, fitted) is None
    assert UP_AND_DOWN not in {test.name for test in tests}
