"""The covariance of numbers that recordings tell very unequally well, or not at all."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.estimation.constants import WIDEST_INTERVAL
from harness.diagnose.estimation.least_squares import inverse


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
