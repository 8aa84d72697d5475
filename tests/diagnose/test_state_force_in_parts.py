"""A force over the state in part of a window answers as one that is worked out there anew, whatever initial state it begins at."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, swing

from harness.diagnose.estimation.discrepancy import Responses, orthonormal, responses
from harness.diagnose.estimation.least_squares import fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linearisation import linearise
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.estimation.state_force import StateForce, over_the_state
from harness.diagnose.estimation.state_force_in_parts import in_parts
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import Window, whole
from harness.diagnose.selection.study import Study

TIME, NOISE = np.arange(0.0, 4.0, 0.01), 1e-3
PART = Window(0, 137, 330)


@pytest.fixture(scope="module")
def study() -> Study:
    noise = NOISE * np.random.default_rng(7).standard_normal(len(TIME))
    run = recording("run", TIME, {"pivot.position": swing(Rig(viscous=2e-3), 0.9, TIME) + noise})
    problem = pose(nominal(tolerance=1e-4), [run, run])
    likelihood = Likelihood(problem, (Colour(NOISE, interval=0.01),))
    return Study(problem, Predictor(problem), likelihood, (), whole(problem.runs, [0]))


@pytest.fixture(scope="module")
def found(study: Study) -> Responses:
    answers = responses(study.predictor, study.likelihood, study.empty(), 1.0, 1.0)
    assert answers is not None
    return answers


@pytest.fixture(scope="module")
def force(found: Responses) -> StateForce:
    over = over_the_state(found)
    assert over is not None
    return over


def test_a_part_answers_as_if_it_had_been_looked_at_alone(study: Study, found: Responses, force: StateForce) -> None:
    empty = study.empty()
    inside = in_parts(force, study.problem.runs, [PART])

    # The same nodes along the same motion, in a free run from where it is at the part's first sample.
    motion, start = found.motion(empty.windows[0]), float(TIME[PART.first])
    assert motion is not None
    state = np.array([np.interp(start, motion.time, own) for own in (motion.q[:, 0], motion.qd[:, 0])])
    objective = study.objective(empty.hypothesis).on((PART,))
    held = np.ones(len(empty.x), dtype=bool)
    alone = fit(objective, empty.x, {PART: state}, fixed=held, most_steps=0)
    fresh = responses(study.predictor, study.likelihood, alone, 1.0, 1.0)
    assert fresh is not None
    own = fresh.motion(PART)
    assert own is not None
    shares = [np.interp(own.time, inside.motions[PART].time, row) for row in inside.shares[PART]]
    answers = fresh.moved(own, 0, np.array(shares))

    (basis,) = linearise(objective, empty.x, {PART: state}, fixed=held).bases
    states = orthonormal(basis)

    def seen(columns: np.ndarray) -> np.ndarray:
        return np.asarray(columns - states @ (states.T @ columns))

    expected = seen(answers)
    # Both motions are the same to the interpolation of where the part begins.
    assert np.linalg.norm(seen(inside.answers[PART]) - expected) < 2e-3 * np.linalg.norm(expected)


def test_what_pushes_in_a_part_is_what_pushes_there_in_the_whole(study: Study, force: StateForce) -> None:
    nodes = np.random.default_rng(3).normal(size=len(force.joint))
    (every,) = force.pushes(nodes).values()
    (part,) = in_parts(force, study.problem.runs, [PART]).pushes(nodes).values()
    when = np.arange(0.0, float(TIME[PART.last - 1] - TIME[PART.first]), 0.003)
    np.testing.assert_allclose(
        part.on(["pivot"], when), every.on(["pivot"], when + float(TIME[PART.first])), atol=1e-9 * np.abs(nodes).max()
    )


def test_a_whole_window_stays_as_it_is(study: Study, force: StateForce) -> None:
    again = in_parts(force, study.problem.runs, study.windows)
    np.testing.assert_array_equal(again.answers[study.windows[0]], force.answers[study.windows[0]])
    np.testing.assert_array_equal(again.shares[study.windows[0]], force.shares[study.windows[0]])
