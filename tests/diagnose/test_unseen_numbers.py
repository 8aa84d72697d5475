"""The covariance of numbers that recordings tell very unequally well, or not at all."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.estimation.constants import WIDEST_INTERVAL
from harness.diagnose.estimation.least_squares import inverse
from harness.diagnose.problem.hypothesis import Nominal, bent_by


def test_what_nothing_turns_on_is_not_known_for_what_another_number_is() -> None:
    rows = np.random.default_rng(0).normal(size=(50, 3))
    units = np.array([1e8, 1.0, 1e-6])  # fourteen decades apart
    sigma = np.sqrt(np.diag(inverse(np.pad((rows * units).T @ (rows * units), (0, 1)))))
    assert sigma[:3] == pytest.approx(np.sqrt(np.diag(np.linalg.inv(rows.T @ rows))) / units, rel=1e-9)
    assert sigma[3] == WIDEST_INTERVAL


def test_of_two_that_do_the_same_neither_is_known() -> None:
    column = np.random.default_rng(1).normal(size=50)
    sigma = np.sqrt(np.diag(inverse(np.array([[1.0, 1.0], [1.0, 1.0]]) * float(column @ column))))
    assert np.all(sigma > 1e5)


def test_no_step_of_a_fit_bends_a_mechanism_to_nothing() -> None:
    quantities = (Nominal("length", "rod", 0.03), Nominal("mass", "rod", 0.01))
    factors = bent_by(quantities, np.array([-5e4, 1e5]))
    assert np.all(factors > 1e-4) and np.all(factors < 1e4)
    assert bent_by(quantities, np.array([1.0, -2.0])) == pytest.approx(np.exp([0.03, -0.02]), rel=1e-15)
