"""How likely recordings are beside a force over the state, against SciPy's multivariate normal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import multivariate_normal

from harness.diagnose.estimation.constants import FORCE_LENGTH_SPREAD, USUAL_FORCE_LENGTH, USUAL_STATE_FORCE
from harness.diagnose.estimation.discrepancy import Profiled
from harness.diagnose.estimation.state_force import Force, Level, Numbers, StateForce, Sums
from harness.diagnose.problem.windows import Window

ONE = Force(np.array([0.3, 0.05]), np.array([0.5, 1.5]), np.array([1.2, 2.0]))
TWO = Force(np.array([1.0, 0.4]), np.array([2.0, 0.3]), np.array([1.0, 1.1]))


def _usual(own: Force) -> float:
    """−2 log of the priors: Cauchy for sizes, log-normal for lengths, up to a constant."""
    sizes = 2.0 * np.sum(np.log1p((own.sizes / USUAL_STATE_FORCE) ** 2))
    return float(sizes + np.sum((np.log(own.lengths / USUAL_FORCE_LENGTH) / FORCE_LENGTH_SPREAD) ** 2))


@pytest.fixture
def two_windows() -> tuple[StateForce, list[Window], list[Profiled]]:
    """Six nodes of two joints, two channels of 30 readings in each of two windows, no initial state to fit."""
    random = np.random.default_rng(5)
    windows = [Window(0, 0, 30), Window(1, 0, 30)]
    answers = {window: random.normal(size=(60, 6)) for window in windows}
    at = random.normal(size=(6, 2))
    force = StateForce(np.array([0, 0, 0, 1, 1, 1]), at, answers, 2, np.ones(2))
    free = [Profiled(random.normal(size=60), np.zeros((60, 0)), 60) for _ in windows]
    return force, windows, free


def test_how_likely_residuals_are_is_that_of_one_gaussian_over_all_recordings(
    two_windows: tuple[StateForce, list[Window], list[Profiled]],
) -> None:
    force, windows, free = two_windows
    sums = force.sums(windows, free)
    residual = np.concatenate([own.residual for own in free])
    answers = np.vstack([force.answers[window] for window in windows])

    def dense(own: Force) -> float:
        root = force.prior_root(own)
        loud = np.tile(np.repeat(own.louder, 30), 2)
        covariance = answers @ root @ root.T @ answers.T + np.diag(loud)
        return -2.0 * multivariate_normal(cov=covariance).logpdf(residual) + _usual(own)

    one = Force(np.array([0.3, 0.05]), np.array([0.5, 1.5]), np.array([1.2, 2.0]))
    two = Force(np.array([1.0, 0.4]), np.array([2.0, 0.3]), np.array([1.0, 1.1]))
    difference = force.surprise(sums, one) - force.surprise(sums, two)
    assert difference == pytest.approx(dense(one) - dense(two), rel=1e-9)
    difference = force.surprise(sums, ONE) - force.surprise(sums, TWO)
    assert difference == pytest.approx(dense(ONE) - dense(TWO), rel=1e-9)


@pytest.fixture
def with_numbers(two_windows: tuple[StateForce, list[Window], list[Profiled]]) -> tuple[StateForce, Sums, Numbers]:
    """The same with three numbers of the set: one that deviates from what is stated, and two that are held weakly."""
    force, windows, free = two_windows
    random = np.random.default_rng(6)
    shared = [random.normal(size=(60, 3)) for _ in windows]
    numbers = Numbers(shared, np.array([1.0, 0.01, 0.01]), np.array([1.5, 0.0, 0.0]))
    return force, force.sums(windows, free, None, numbers), numbers


def test_numbers_of_the_set_are_where_that_gaussian_is_likeliest(
    two_windows: tuple[StateForce, list[Window], list[Profiled]], with_numbers: tuple[StateForce, Sums, Numbers]
) -> None:
    force, sums, numbers = with_numbers
    _, windows, free = two_windows
    residual = np.concatenate([own.residual for own in free])
    answers = np.vstack([force.answers[window] for window in windows])
    shared = np.vstack(numbers.shared)

    def dense(own: Force) -> float:
        root = force.prior_root(own)
        loud = np.tile(np.repeat(own.louder, 30), 2)
        law = multivariate_normal(cov=answers @ root @ root.T @ answers.T + np.diag(loud))

        def surprise(step: np.ndarray) -> float:
            held = (step[0] + 1.5) ** 2 + 0.01 * float(step[1:] @ step[1:])
            return -2.0 * law.logpdf(residual + shared @ step) + held

        return minimize(surprise, np.zeros(3), tol=1e-10).fun + _usual(own)

    difference = force.surprise(sums, ONE) - force.surprise(sums, TWO)
    assert difference == pytest.approx(dense(ONE) - dense(TWO), abs=1e-6)


def test_the_likeliest_force_is_one_that_nothing_near_it_beats(with_numbers: tuple[StateForce, Sums, Numbers]) -> None:
    force, sums, _ = with_numbers
    found = force.likeliest(sums)

    def surprise(z: np.ndarray) -> float:
        return force.surprise(sums, Force(np.exp(z[:2]), np.exp(z[4:]), np.exp(z[2:4])))

    best = np.log(np.concatenate([found.force.sizes, found.force.louder, found.force.lengths]))
    assert surprise(best) == pytest.approx(found.value, rel=1e-9)
    # A search without slopes, by SciPy, from there.
    again = minimize(surprise, best, method="Nelder-Mead", bounds=[(b - 1.0, b + 1.0) for b in best])
    lower = [b for b, louder in zip(again.x, [False, False, True, True, False, False], strict=True) if louder]
    assert again.fun > found.value - 0.05 or min(lower) < 0.0  # noise is no quieter than the sensors'


def test_a_run_with_the_likeliest_force_is_as_likely_as_the_linear_view_says(
    two_windows: tuple[StateForce, list[Window], list[Profiled]],
) -> None:
    force, windows, free = two_windows
    sums = force.sums(windows, free)
    found = force.likeliest(sums)
    # Channels are linear here, so that what a run with the force would leave is known.
    after = [
        Profiled(own.residual - force.answers[window] @ found.nodes, own.states, own.samples)
        for window, own in zip(windows, free, strict=True)
    ]
    assert force.held(force.sums(windows, after), found.nodes, found.force) == pytest.approx(found.value, rel=1e-9)


def test_numbers_are_as_uncertain_as_generalised_least_squares_says(
    two_windows: tuple[StateForce, list[Window], list[Profiled]], with_numbers: tuple[StateForce, Sums, Numbers]
) -> None:
    force, sums, numbers = with_numbers
    _, windows, _ = two_windows
    answers = np.vstack([force.answers[window] for window in windows])
    shared = np.vstack(numbers.shared)
    root = force.prior_root(ONE)
    covariance = answers @ root @ root.T @ answers.T + np.diag(np.tile(np.repeat(ONE.louder, 30), 2))
    # Aitken's estimator with a normal prior.
    information = shared.T @ np.linalg.solve(covariance, shared) + np.diag(numbers.stiff)
    expected = np.sqrt(np.diag(np.linalg.inv(information)))
    assert force.spread(sums, ONE) == pytest.approx(expected, rel=1e-9)
    # With no force there is only noise, as loud as the residuals are.
    loud = np.tile(np.repeat(np.maximum(sums.left / sums.counts, 1.0), 30), 2)
    information = shared.T @ (shared / loud[:, None]) + np.diag(numbers.stiff)
    assert force.spread(sums, None) == pytest.approx(np.sqrt(np.diag(np.linalg.inv(information))), rel=1e-9)


LEVEL = np.array([False, False, True, False, False, True])  # of six nodes


@pytest.fixture
def with_levels(two_windows: tuple[StateForce, list[Window], list[Profiled]]) -> StateForce:
    """The same nodes, of which the last one of each joint is what one recording has of friction beside all."""
    force, _, _ = two_windows
    return replace(force, level=LEVEL.astype(np.intp) * Level.FRICTION)


def test_what_is_one_recordings_own_has_a_size_of_its_own_and_goes_with_nothing_else(with_levels: StateForce) -> None:
    sizes, lengths = np.array([0.3, 0.05, 0.02, 0.07]), np.array([0.5, 1.5])
    apart = (with_levels.at[:, None] - with_levels.at[None]) / lengths
    expected = np.exp(-0.5 * np.sum(apart**2, axis=-1))
    for k in range(6):
        for j in range(6):
            if k != j and (k // 3 != j // 3 or LEVEL[k] or LEVEL[j]):
                expected[k, j] = 0.0
    size = np.array([0.3, 0.3, 0.02, 0.05, 0.05, 0.07])
    root = with_levels.prior_root(Force(sizes, lengths, np.ones(2)))
    assert root @ root.T == pytest.approx(size[:, None] * (expected + 1e-6 * np.eye(6)) * size, abs=1e-9)


def test_the_likeliest_size_of_levels_is_one_that_nothing_near_it_beats(
    two_windows: tuple[StateForce, list[Window], list[Profiled]], with_levels: StateForce
) -> None:
    _, windows, free = two_windows
    # A thousandth of the natural torque is a reading as loud as the noise, so that three of them are far from nothing.
    answers = {w: 1e3 * with_levels.answers[w] * (LEVEL if w.run == 0 else ~LEVEL) for w in windows}
    force = replace(with_levels, answers=answers)
    pushed = [replace(free[0], residual=free[0].residual + 3e-3 * answers[windows[0]] @ LEVEL), free[1]]
    sums = force.sums(windows, pushed)
    found = force.likeliest(sums)
    assert np.all(found.force.sizes[2:] > 5e-4)
    assert found.nodes[LEVEL] == pytest.approx(3e-3, abs=1e-3)

    def surprise(z: np.ndarray) -> float:
        return force.surprise(sums, Force(np.exp(z), found.force.lengths, found.force.louder))

    best = np.log(found.force.sizes)
    again = minimize(surprise, best, method="Nelder-Mead", bounds=[(b - 1.0, b + 1.0) for b in best])
    assert again.fun > found.value - 0.05
