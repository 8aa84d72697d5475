"""What vibrates has initial states of its own in every window: they are paid for, and such effects wait where others will do."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linearisation import eliminated, vibrating
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis, dear
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.constants.search import VIBRATION_PRICE
from harness.diagnose.selection.study import Study


def bench(viscous: float, only: list[str]) -> Study:
    system, runs = nominal(), releases(Rig(viscous=viscous), (1.3, 0.9), 1e-3, seed=9)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=only))
    return Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))


def test_initial_states_count_as_far_as_the_data_tell_them() -> None:
    # Joint and vibration seen side by side; what is left of the vibration's column has square s² = |b|² − (a·b)²/|a|². Beside a
    # prior of standard deviation w it counts by (s w)²/(1 + (s w)²), as in Hastie, Tibshirani and Friedman (2009), eq. 3.50.
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(2, 40))
    width = 0.1
    left = b @ b - (a @ b) ** 2 / (a @ a)
    one = eliminated(0.0, [np.zeros(40)], [np.column_stack([a, b])], [np.zeros((40, 1))])
    share = left * width**2 / (1.0 + left * width**2)
    assert vibrating(one, np.array([0.0, 1.0 / width])) == pytest.approx(share, rel=1e-9)
    assert vibrating(one, np.zeros(2)) == 0.0


def test_a_link_that_bends_pays_for_how_it_began() -> None:
    study = bench(0.0, ["link_flexibility", "viscous_damping"])
    by_name = {c.effect.name: c for c in study.candidates}
    link, damping = by_name["link_flexibility"], by_name["viscous_damping"]
    nothing = np.zeros(len(study.predictor.nominal))
    # Two shapes with a place and a speed each, in two windows, plainly seen if they do not die out within a sample.
    start = np.concatenate([nothing, to_internal(link, np.array([9.0, 0.01]))])
    bent = study.fit(Hypothesis((link,)), [start], None, most_steps=1)
    assert 2.0 < bent.vibrating <= 8.0
    # And for how unusual its frequency and damping are.
    price = study.price(link) + VIBRATION_PRICE * bent.vibrating + study.surprise(bent)
    assert study.criterion(bent) == pytest.approx(bent.score + price, abs=1e-6)
    start = np.concatenate([nothing, to_internal(damping, np.array([1e-5]))])
    assert study.fit(Hypothesis((damping,)), [start], None, most_steps=1).vibrating == 0.0


def test_what_is_dear_waits_where_something_else_explains_all() -> None:
    study = bench(2e-3, ["viscous_damping", "link_flexibility", "coulomb_friction"])
    base = study.empty()
    assert base.score > 3.0 * study.samples
    likely = study.likely(base)
    assert likely[0].candidate.effect.name == "viscous_damping"
    assert not any(dear(s.candidate) for s in likely)
    assert any(dear(s.candidate) for s in study.ranked(base))
