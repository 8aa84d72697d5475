"""Ends of a search that are no bounds of physics are left behind by what is to be told."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linearisation import Linearisation
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.prediction.coordinates import from_internal, internal_bounds, start_vector
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.constants.starts import FURTHER_REACH
from harness.diagnose.selection.search_bounds import beyond_the_ends

RECORDINGS = releases(Rig(), (0.6, -0.4), 1e-3, seed=2, duration=2.0, rate=50.0)


def candidate(name: str) -> Candidate:
    return next(c for c in candidates(nominal(), RECORDINGS) if c.effect.name == name)


@pytest.mark.parametrize(
    ("name", "index", "sense", "continued"),
    [
        ("base_compliance", 0, 1, True),  # stiffer than it was searched
        ("base_compliance", 2, -1, True),
        ("base_compliance", 0, 0, False),
        ("link_flexibility", 1, 1, False),  # a damping ratio of nearly one is an end of physics
        ("dahl_friction", 1, 1, False),  # what stands there is plain dry friction
    ],
)
def test_only_what_gives_or_has_play_is_continued(name: str, index: int, sense: int, continued: bool) -> None:
    member = candidate(name)
    predictor = Predictor(pose(nominal(), RECORDINGS))
    x = np.concatenate([np.zeros(len(predictor.nominal)), start_vector(member)])
    low, high = internal_bounds(member)
    x[len(predictor.nominal) + index] = (x[len(predictor.nominal) + index], high[index], low[index])[sense]
    nothing = Linearisation(1.0, (), (), np.zeros((0, len(x))), np.zeros(0), (), ())
    fitted = Fit(Hypothesis((member,)), (), x, {}, nothing, 0.0, True, np.ones(len(x), dtype=bool))
    better = replace(fitted, prior=-1.0)
    study = SimpleNamespace(predictor=predictor, fit=lambda *_, **__: better)
    assert beyond_the_ends(study, fitted) is (better if continued else fitted)
    assert predictor.reach == ({member.key: FURTHER_REACH} if continued else {})
    # Once is enough.
    assert beyond_the_ends(study, fitted) is fitted


def test_a_fit_may_then_go_there() -> None:
    member = candidate("base_compliance")
    posed = pose(nominal(), RECORDINGS)
    predictor = Predictor(posed)
    likelihood = Likelihood(posed, (Colour(white=1e-3, interval=0.02),))
    objective = Objective(predictor, likelihood, Hypothesis((member,)), whole(posed.runs, range(2)))
    count = len(predictor.nominal)
    usual = [from_internal(member, end[count:]) for end in objective.bounds()]
    predictor.reach[member.key] = FURTHER_REACH
    further = [from_internal(member, end[count:]) for end in objective.bounds()]
    assert further[0] == pytest.approx(usual[0] / 5.0)
    assert further[1] == pytest.approx(usual[1] * 5.0)
