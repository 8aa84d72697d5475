"""Effects whose promised size lies outside the valley that the fit stands in."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import whole
from harness.diagnose.selection.multi_start import absent
from harness.diagnose.selection.score_tests import Score
from harness.diagnose.selection.study import Study

ADDED = 0.25 * (INERTIA + MASS * COM**2)


def study(rig: Rig, angles: tuple[float, ...], duration: float) -> Study:
    """A bench of free runs of whole recordings."""
    system = nominal(tolerance=0.005)
    runs = releases(rig, angles, 1e-3, seed=5, duration=duration)
    posed = pose(system, runs)
    windows = whole(posed.runs, range(len(posed.train)))
    out = Study(
        posed, Predictor(posed), Likelihood(posed, crude_colours(posed)), tuple(candidates(system, runs)), windows
    )
    return out


def longer() -> float:
    """How much farther from the joint the centre of mass must be to swing as slowly as with the added inertia."""
    ratio = MASS * COM / (INERTIA + MASS * COM**2 + ADDED)
    return float(brentq(lambda s: MASS * COM * s / (INERTIA + MASS * (COM * s) ** 2) - ratio, 0.8, 2.0))


def test_inertia_is_found_along_the_way_back_from_a_bent_model() -> None:
    # The rig turns a quarter heavier; the nominal quantities, bent by a dozen deviations, can stand for that.
    bench = study(Rig(inertia=INERTIA + ADDED), (0.9, 1.4, 0.6), 30.0)
    bent = np.zeros(len(bench.predictor.nominal))
    bent[[n.kind for n in bench.predictor.nominal].index("length")] = np.log(longer()) / 0.005
    base = bench.fit(Hypothesis(), [bent], None, most_steps=60)
    assert base.cost < 1.1 * bench.samples
    assert bench.stretched(base)
    (added,) = (c for c in bench.candidates if c.key == "added_inertia@pivot")
    # Half as much again as there is would be many cycles off in thirty seconds.
    fitted = bench.extend(base, Score(added, 1e4, np.array([1.5 * ADDED]), 1.0))
    (size,) = bench.predictor.effect_values(fitted.hypothesis, 0, fitted.x)
    assert size == pytest.approx(ADDED, rel=0.03)
    assert fitted.score < 1.1 * bench.samples


def test_everything_else_follows_before_a_new_effect_is_sized() -> None:
    # A spring that the nominal quantities hide for the most part: by itself it would be far too much.
    spring = 0.03 * MASS * 9.81 * COM
    bench = study(Rig(torque=lambda t, q, v: -spring * q), (0.9, 1.4, 0.6), 20.0)
    base = bench.fit(Hypothesis(), [np.zeros(len(bench.predictor.nominal))], None, most_steps=60)
    (joint_spring,) = (c for c in bench.candidates if c.key == "joint_stiffness@pivot")
    hypothesis = Hypothesis((joint_spring,))
    start = np.concatenate([base.x, to_internal(joint_spring, np.array([spring, 0.0]))])
    states = bench.states_for(hypothesis, base)
    ((cost, _),) = bench.objective(hypothesis).residuals([(start, states)])
    assert cost > 2.0 * base.cost
    fitted = bench.extend(base, Score(joint_spring, 1e4, np.array([spring, 0.0]), 1.0))
    stiffness, _ = bench.predictor.effect_values(fitted.hypothesis, 0, fitted.x)
    assert stiffness == pytest.approx(spring, rel=0.1)
    assert fitted.score < 1.1 * bench.samples


def test_an_angle_has_no_size() -> None:
    bench = study(Rig(), (0.5, 0.8), 4.0)
    (joint_spring,) = (c for c in bench.candidates if c.key == "joint_stiffness@pivot")
    x = np.concatenate([np.zeros(len(bench.predictor.nominal)), [2.0, 0.3]])
    assert absent(bench.predictor, Hypothesis((joint_spring,)), 0, x)[-2:] == pytest.approx([0.0, 0.3])
