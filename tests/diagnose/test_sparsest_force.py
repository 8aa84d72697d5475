"""The sparsest form of an unnamed force: two terms that only together explain anything are found, and no more than pay."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.criticism.checks.force_of_few_terms import _best_subset
from harness.diagnose.selection.score_tests import Projected


def projected(columns: np.ndarray, residual: np.ndarray) -> Projected:
    """What columns (K, M) have to do with a residual (M,) and with one another."""
    gram = columns @ columns.T
    return Projected(columns @ residual, np.diag(gram).copy(), np.diag(gram, 1).copy(), gram)


def test_drive_and_brake_of_a_limit_cycle_are_found_together() -> None:
    # Nearly the same column twice, the residual along their small difference: neither explains any of it.
    rng = np.random.default_rng(8)
    columns = rng.standard_normal((9, 400))
    difference = rng.standard_normal(400)
    difference -= columns[3] * (columns[3] @ difference) / (columns[3] @ columns[3])
    columns[6] = columns[3] + 0.01 * difference
    residual = difference + 0.1 * rng.standard_normal(400)
    seen = projected(columns, residual)
    alone, _ = _best_subset(seen, 1)
    gain, chosen = _best_subset(seen, 2)
    wanted = np.linalg.lstsq(columns[[3, 6]].T, residual, rcond=None)
    assert set(chosen) == {3, 6}
    assert gain == pytest.approx(float(residual @ residual - wanted[1][0]), rel=1e-6)
    assert alone < 0.1 * gain


def test_columns_that_are_the_same_count_once() -> None:
    rng = np.random.default_rng(9)
    columns = rng.standard_normal((4, 200))
    columns[1] = -2.0 * columns[0]
    residual = columns[0] + 0.5 * columns[2]
    _, chosen = _best_subset(projected(columns, residual), 2)
    assert 2 in chosen
    assert not {0, 1} <= set(chosen)
