"""Quantiles of what several sets say of one number, against closed forms."""

import numpy as np
import pytest
from scipy.stats import norm

from harness.diagnose.claims.averaged import quantile


def test_one_set_alone_has_the_quantiles_of_a_normal_distribution() -> None:
    for level in (0.025, 0.5, 0.975):
        found = quantile(np.array([0.2]), np.array([3.0]), np.array([0.5]), level)
        assert found == pytest.approx(norm.ppf(level, 3.0, 0.5), abs=1e-9)


def test_sets_far_apart_each_give_their_share() -> None:
    # With a quarter of the weight at 0 and the rest at 100, 2.5 % of all are a tenth of the former.
    weights, means, spreads = np.array([1.0, 3.0]), np.array([0.0, 100.0]), np.array([1.0, 2.0])
    assert quantile(weights, means, spreads, 0.025) == pytest.approx(norm.ppf(0.1, 0.0, 1.0), abs=1e-9)
    assert quantile(weights, means, spreads, 0.975) == pytest.approx(norm.ppf(1.0 - 0.025 / 0.75, 100.0, 2.0), abs=1e-9)


def test_a_number_that_is_known_exactly_is_no_trouble() -> None:
    assert quantile(np.array([1.0]), np.array([2.0]), np.array([0.0]), 0.975) == pytest.approx(2.0, abs=1e-9)
