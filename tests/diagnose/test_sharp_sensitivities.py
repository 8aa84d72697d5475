"""Intervals where parameters make up for one another: only a small difference of long columns is told by the data.

A free swing of one rigid pendulum depends on one number, moment of gravity over inertia (Goldstein, Classical Mechanics, ch. 3), so
mass, length, inertia and a shift of the centre of mass leave the motion as it is along three directions. No more may be told.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness.diagnose.estimation.intervals import Estimate, across, estimates, no_more_exact_than_the_law
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.profile_likelihood import profiled
from harness.diagnose.selection.study import Study

NOISE, RATE, TOLERANCE, SHIFT = 1e-4, 100.0, 0.02, -0.09


def test_nothing_is_told_of_what_leaves_the_motion_as_it_is() -> None:
    system = nominal(TOLERANCE)
    runs = releases(Rig(com=COM + SHIFT), (1.2, -0.8), NOISE, seed=5, duration=20.0, rate=RATE)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=["com_offset"]))
    colours = (Colour(white=NOISE, interval=1.0 / RATE),)
    study = Study(posed, Predictor(posed), Likelihood(posed, colours), known, whole(posed.runs, range(2)))
    count = len(study.predictor.nominal)
    start = np.concatenate([np.zeros(count), to_internal(known[0], np.array([SHIFT]))])
    rough = study.fit(Hypothesis(known), [start], None, most_steps=40)
    best = study.sharpened(rough)
    assert best.score < 1.1 * study.samples
    told = np.linalg.svd(best.linear.matrix, compute_uv=False)
    assert told[0] > 1e3
    # Beside a tolerance, whose standard deviation is one, a hundredth of one says nothing.
    assert (told[1:] < 0.01).all(), told
    for sharp, plain in zip(best.linear.shared, rough.linear.shared, strict=True):
        assert np.linalg.norm(sharp - plain) < 0.01 * np.linalg.norm(plain)
    # So the shift is known as well as the stated quantities let it be: m c g / (I + m c²) is what is known of them.
    (shift,) = profiled(study, best, 0, estimates(study.predictor, best, 0)).values()
    assert shift.std is not None
    c = COM + SHIFT
    slope = 1.0 / c - 2.0 * MASS * c / (INERTIA + MASS * c**2)  # of the logarithm, by the centre of mass
    wide = INERTIA / (INERTIA + MASS * c**2)  # by the logarithm of the inertia, the sign left out
    assert shift.std == pytest.approx(TOLERANCE * np.hypot(wide / slope, COM), rel=0.2)
    assert shift.low < SHIFT < shift.high


def test_intervals_reach_over_sets_that_are_not_parted() -> None:
    runs = releases(Rig(), (1.0, -0.7), NOISE, seed=1, duration=2.0, rate=RATE)
    (wave,) = candidates(nominal(TOLERANCE), runs, only=["cogging_torque"])
    own = {"amplitude": Estimate(1.0, 0.1, 0.8, 1.2), "phase": Estimate(0.0, 0.1, -0.2, 0.2)}
    other = {"amplitude": Estimate(1.5, 0.1, 1.3, 1.7), "phase": Estimate(3.0, 0.1, 2.8, 3.2)}
    found = across(wave, own, [other])
    assert (found["amplitude"].value, found["amplitude"].low, found["amplitude"].high) == (1.0, 0.8, 1.7)
    assert found["amplitude"].std == pytest.approx(0.9 / 2 / 1.96, rel=1e-3)
    assert found["phase"] == own["phase"]
    assert across(wave, own, []) == own
    # Beside something that does the same, it may as well be absent: that says nothing of its size.
    made_up_for = {"amplitude": Estimate(1.5, 40.0, -80.0, 80.0), "phase": Estimate(0.0, 0.1, -0.2, 0.2)}
    assert across(wave, own, [made_up_for]) == own


def test_no_interval_is_narrower_than_what_the_model_of_the_effect_is_good_for() -> None:
    (bends,) = candidates(nominal(), releases(Rig(), (0.5,), 1e-3, seed=1, duration=2.0), only=["link_flexibility"])
    sharp = {"frequency": Estimate(50.0, 0.01, 49.98, 50.02), "damping_ratio": Estimate(0.02, 1e-4, 0.0198, 0.0202)}
    told = no_more_exact_than_the_law(bends, sharp)
    # A uniform error of up to a hundredth has 1/√3 of it as its standard deviation.
    assert told["frequency"].std == pytest.approx(np.hypot(0.01, 0.5 / np.sqrt(3.0)))
    assert (told["frequency"].low, told["frequency"].high) == pytest.approx((49.48, 50.52))
    assert told["damping_ratio"] == sharp["damping_ratio"]
