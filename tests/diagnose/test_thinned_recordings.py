"""Recordings faster than a fit needs are averaged in blocks, and what a sensor makes of the motion is averaged alike."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, passed_slowly, recording, swing

from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import Window

RATE, BLOCK = 1040.0, 4
ANGLE, AMPLITUDE, PERIODS, PHASE = 1.2, 0.01, 200.0, 0.4


def test_an_encoder_error_faster_than_a_block_is_predicted_as_it_is_averaged() -> None:
    time = np.arange(0.0, 2.0, 1.0 / RATE)
    angle = swing(Rig(), ANGLE, time)
    # What the sensor adds is written out here; four samples pass up to half a period of it.
    read = angle + AMPLITUDE * np.sin(PERIODS * angle + PHASE)
    system, runs = nominal(), [recording("fast", time, {"pivot.position": read})]
    posed = pose(system, runs, heldout=runs[0])
    (run,) = posed.train
    assert run.averaged == BLOCK
    assert run.values[0] == pytest.approx(read[: len(run.time) * BLOCK].reshape(-1, BLOCK).mean(axis=1))
    (encoder,) = (c for c in candidates(system, runs) if c.key == "encoder_interpolation@pivot.position")
    predictor, hypothesis = Predictor(posed), Hypothesis((encoder,))
    start, step = run.time[0], 1e-4
    at = swing(Rig(), ANGLE, np.array([0.0, start - step, start, start + step]))
    state = np.array([at[2], (at[3] - at[1]) / (2.0 * step)])
    x = np.concatenate([np.zeros(len(predictor.nominal)), to_internal(encoder, np.array([AMPLITUDE, PERIODS, PHASE]))])
    (predicted,) = predictor.predict(hypothesis, x[None], [(0, Window(0, 0, len(run.time)), state)])
    # The change of a block's average that its samples' own change makes, as if the error were slow, would be off by its size.
    assert predicted[0] == pytest.approx(run.values[0], abs=1e-3 * AMPLITUDE)


def test_a_slow_sensor_on_a_release_from_rest_is_predicted_as_it_is_averaged() -> None:
    # Settled on the held angle; that a block's samples begin within the motion must not count as a motion that was there before,
    # which would be off by several milliradians.
    cutoff, every = 5.0, 10
    fine = np.arange(0.0, 2.0, 1.0 / (every * RATE))
    passed = passed_slowly(swing(Rig(), ANGLE, fine), 1.0 / (every * RATE), cutoff)
    system, runs = nominal(), [recording("fast", fine[::every], {"pivot.position": passed[::every]})]
    posed = pose(system, runs, heldout=runs[0])
    (run,) = posed.train
    assert run.averaged == BLOCK
    (slow,) = (c for c in candidates(system, runs) if c.key == "sensor_lowpass@pivot.position")
    predictor, hypothesis = Predictor(posed), Hypothesis((slow,))
    start, step = run.time[0], 1e-4
    at = swing(Rig(), ANGLE, np.array([0.0, start - step, start, start + step]))
    state = np.array([at[2], (at[3] - at[1]) / (2.0 * step)])
    x = np.concatenate([np.zeros(len(predictor.nominal)), to_internal(slow, np.array([cutoff]))])
    (predicted,) = predictor.predict(hypothesis, x[None], [(0, Window(0, 0, len(run.time)), state)])
    assert predicted[0] == pytest.approx(run.values[0], abs=2e-5)
