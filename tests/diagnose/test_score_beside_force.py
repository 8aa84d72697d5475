"""What a further effect is worth beside a force that may do its work, against generalised least squares."""

import numpy as np
import pytest

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linearisation import Linearisation
from harness.diagnose.estimation.state_force import Force, StateForce
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.score_beside_force import adjustable

READINGS, NODES, NUMBERS, STATES = 40, 5, 2, 2


def test_a_direction_gains_what_generalised_least_squares_says() -> None:
    random = np.random.default_rng(3)
    windows = (Window(0, 0, READINGS), Window(1, 0, READINGS))
    answers = [random.normal(size=(READINGS, NODES)) for _ in windows]
    shared = [random.normal(size=(READINGS, NUMBERS)) for _ in windows]
    bases = [random.normal(size=(READINGS, STATES)) for _ in windows]
    residuals = [random.normal(size=READINGS) for _ in windows]
    force = StateForce(
        np.zeros(NODES, dtype=np.intp),
        random.normal(size=(NODES, 2)),
        dict(zip(windows, answers, strict=True)),
        1,
        np.ones(1),
    )
    loud = np.array([4.0])
    shape, nodes = Force(np.array([0.3]), np.array([0.8, 1.3]), loud), 0.1 * random.normal(size=NODES)
    x = np.array([0.4, 1.0])  # the first is a nominal quantity, which has a unit normal prior
    linear = Linearisation(0.0, tuple(residuals), (), np.zeros((0, 2)), np.zeros(0), tuple(bases), tuple(shared))
    states = {w: np.zeros(STATES) for w in windows}
    here = Fit(Hypothesis(), windows, x, states, linear, 0.0, True, np.ones(2, dtype=bool))

    space = adjustable(force, shape, nodes, here, 1, loud)
    columns = [random.normal(size=(1, READINGS)) for _ in windows]
    gain = space.measure(columns).gains()[0]

    # The same by the dense covariance of residuals: the prior of forces and numbers about where they would be without data, noise
    # of one, and initial states of which nothing is known.
    root = force.prior_root(shape)
    moved = np.vstack([np.hstack([-0.5 * a @ root, j]) for a, j in zip(answers, shared, strict=True)])
    spread = np.diag([1.0] * NODES + [1.0, 100.0])
    anything = np.zeros((2 * READINGS, 2 * STATES))
    for k, basis in enumerate(bases):
        anything[k * READINGS : (k + 1) * READINGS, k * STATES : (k + 1) * STATES] = basis
    covariance = np.eye(2 * READINGS) + moved @ spread @ moved.T + 1e8 * anything @ anything.T
    stated = np.concatenate([-np.linalg.solve(root, nodes), [-x[0], 0.0]])
    surprise = np.concatenate(residuals) + moved @ stated
    direction = np.concatenate(columns, axis=1)[0]
    weighed = np.linalg.solve(covariance, direction)
    assert gain == pytest.approx((weighed @ surprise) ** 2 / (weighed @ direction), rel=1e-5)
