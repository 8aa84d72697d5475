"""What a fit would leave without a member, and smaller sets that had ended in a wrong valley, begun anew from a larger one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.answer.explain import finding_words
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.study import Study
from harness.diagnose.selection.wald_test import rise_without

NOISE = 1e-3


def bench(rig: Rig, **sizes: float) -> tuple[Study, Fit]:
    """A study of two releases, and the fit of a set of effects begun at these sizes."""
    system, runs = nominal(), releases(rig, (1.2, 0.8), NOISE, seed=33)
    posed = pose(system, runs)
    known = tuple(candidates(system, runs, only=list(sizes)))
    study = Study(posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), known, whole(posed.runs, range(2)))
    members = tuple(sorted(known, key=lambda c: list(sizes).index(c.effect.name)))
    own = [to_internal(c, np.array([sizes[c.effect.name]])) for c in members]
    start = np.concatenate([np.zeros(len(study.predictor.nominal)), *own])
    return study, study.fit(Hypothesis(members), [start], None, most_steps=30)


def test_the_linear_view_knows_what_hardly_matters() -> None:
    # A sensor's offset that is not there: one deviation of the noise or two, so that a fit without it is the judge.
    study, both = bench(Rig(dry=2e-3), coulomb_friction=2e-3, sensor_offset=0.02)
    nominal_size = len(study.predictor.nominal)
    without = study.reduce(both, 1)
    assert rise_without(both, nominal_size, 1) == pytest.approx(without.score - both.score, rel=0.05, abs=0.05)
    # Friction is there: far more than any price.
    assert rise_without(both, nominal_size, 0) > 1e3


def test_a_smaller_set_in_a_wrong_valley_is_begun_anew() -> None:
    # On a base turned by −α a joint swings as a sensor would say that reads α too much: one takes back what the other does.
    study, both = bench(Rig(), sensor_offset=-0.02, base_tilt=-0.02)
    right = study.reduce(both, 1)
    scales = [member.scales[0] for member in both.hypothesis.members]
    alone = np.append(both.x[:-2], -0.02 / scales[0])
    taken_back, every = np.append(alone, -0.02 / scales[1]), np.ones(len(both.x), dtype=bool)
    base = replace(fit(study.objective(both.hypothesis), taken_back, both.states, fixed=every), free=every)
    assert base.score < both.score + 20.0
    # As if a fit without the tilt had ended elsewhere, worse than its price; better than the offset by itself is where it stands.
    worse = right.linear.cost + study.price(both.hypothesis.members[1]) + 30.0
    study.fits[right.hypothesis.identity] = replace(right, linear=replace(right.linear, cost=worse))
    ((by_itself, _),) = study.objective(right.hypothesis).residuals([(alone, right.states)])
    assert by_itself > 10.0 * worse
    assert rise_without(base, len(study.predictor.nominal), 1) < study.price(both.hypothesis.members[1])
    assert study.reduce(base, 1).score == pytest.approx(right.score, abs=1.0)


def test_an_interval_wider_than_its_deviation_is_told_itself() -> None:
    units = {"mass": "kg"}
    lopsided = {"mass": Estimate(0.0182, 0.015, 2e-6, 169.0)}
    assert finding_words("compliant base", "base", lopsided, units) == (
        "compliant base at base (mass 2e-06 … 170 kg (95 %), best 0.0182)"
    )
    even = {"mass": Estimate(0.5, 0.01, 0.48, 0.52)}
    assert finding_words("payload", "rod", even, units) == "payload at rod (mass 0.500 ± 0.01 kg)"
