"""Random effects against a published data set, and outliers at the rate that is stated."""

from __future__ import annotations

import numpy as np
import pytest

from harness.fleet.spread import FALSE, away, chances, outlying, spread

# Thirteen trials of the BCG vaccine (Colditz et al., JAMA 271 (1994) 698): ill and well, vaccinated; ill and well, not.
TRIALS = np.array([
    (4, 119, 11, 128), (6, 300, 29, 274), (3, 228, 11, 209), (62, 13536, 248, 12619), (33, 5036, 47, 5761),
    (180, 1361, 372, 1079), (8, 2537, 10, 619), (505, 87886, 499, 87892), (29, 7470, 45, 7232), (17, 1699, 65, 1600),
    (186, 50448, 141, 27197), (5, 2493, 3, 2338), (27, 16886, 29, 17825),
])  # fmt: skip


def log_relative_risk() -> tuple[np.ndarray, np.ndarray]:
    ill, well, ill0, well0 = TRIALS.T.astype(float)
    values = np.log(ill / (ill + well)) - np.log(ill0 / (ill0 + well0))
    return values, np.sqrt(1 / ill - 1 / (ill + well) + 1 / ill0 - 1 / (ill0 + well0))


def test_the_spread_of_a_published_data_set():
    """τ² by Paule and Mandel, its Q-profile interval, and Cochran's Q as the package metafor and Viechtbauer (2007) print them."""
    found = spread(*log_relative_risk())
    assert found.between**2 == pytest.approx(0.3181, abs=5e-5)
    assert (found.low**2, found.high**2) == pytest.approx((0.1197, 1.1115), abs=5e-5)
    assert found.chance < 1e-4  # Q = 152.23 on 12 degrees of freedom
    assert found.mean == pytest.approx(-0.7150, abs=5e-4)


def test_equal_units_have_no_spread():
    found = spread(np.array([1.0, 1.1, 0.9]), np.array([0.5, 0.5, 0.5]))
    assert found.between == found.low == 0.0
    assert found.chance > 0.9
    # Inverse variances: three equal ones.
    assert (found.mean, found.mean_std) == pytest.approx((1.0, 0.5 / 3**0.5))


@pytest.mark.parametrize(("units", "between"), [(10, 0.0), (15, 10.0), (50, 1.0), (200, 1.0)])
def test_no_more_false_outliers_than_stated(units, between):
    """In fleets without an outlier the adjusted chance of any is the stated share, whatever the spread."""
    rng = np.random.default_rng(units)
    fleets, alarms = 400, 0
    for _ in range(fleets):
        stds = rng.uniform(0.5, 1.5, units)
        z, _ = away(between * rng.standard_normal(units) + stds * rng.standard_normal(units), stds)
        alarms += bool(outlying([chances(z)])[0].min() < FALSE)
    # Three standard deviations of the count above the stated share.
    assert alarms <= fleets * FALSE + 3.0 * (fleets * FALSE * (1.0 - FALSE)) ** 0.5


def test_outliers_do_not_hide_one_another():
    rng = np.random.default_rng(4)
    stds = np.full(60, 0.2)
    values = rng.standard_normal(60) + stds * rng.standard_normal(60)
    values[:6] += 9.0
    z, between = away(values, stds)
    assert list(np.flatnonzero(outlying([chances(z)])[0] < FALSE)) == list(range(6))
    assert between == pytest.approx(1.0, abs=0.35)  # 60 units know a robust scale to a fifth
    # The spread of all takes them in, and would call none of them an outlier at three of its deviations.
    assert spread(values, stds).between > 2.5


def test_one_unit_has_no_spread():
    with pytest.raises(ValueError, match="nothing of how units differ"):
        spread(np.array([1.0]), np.array([0.1]))
