"""Gain in cost by some columns together: by a combination of them, or by one of every window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import GAIN_RIDGE
from harness.diagnose.selection.score_tests import Nuisance, Projected

Array = NDArray[np.float64]


def solve_gain(seen: Projected, index: Sequence[int], strength: float = GAIN_RIDGE) -> tuple[float, Array, float]:
    """Gain in cost, coefficients and effective number of directions of a least-squares combination of some columns."""
    assert seen.gram is not None
    coefficients = np.zeros(len(index))
    norms = np.sqrt(np.maximum(seen.squares[list(index)], 0.0))
    keep = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    if not np.any(keep):
        return 0.0, coefficients, 0.0
    chosen = np.array(index)[keep]
    scaled = seen.gram[np.ix_(chosen, chosen)] / np.outer(norms[keep], norms[keep])
    values, vectors = np.linalg.eigh(scaled)
    # Eigenvalues are squares of singular values; rounding leaves them good to a few times 1e-13.
    strong = values > max(strength**2, 1e-12) * values[-1]
    along = vectors[:, strong].T @ (seen.along[chosen] / norms[keep])
    coefficients[keep] = -(vectors[:, strong] @ (along / values[strong])) / norms[keep]
    return float(np.sum(along**2 / values[strong])), coefficients, float(strong.sum())


def jointly(space: Nuisance, chosen: Sequence[Array]) -> float:
    """Gain in cost by a column of every window, (M_w,), or several, (k, M_w), with amplitudes of its own in each.

    It is not the sum of what windows gain by themselves: all have to do with the same shared parameters.
    """
    own = [np.atleast_2d(column) for column in chosen]
    ends = np.cumsum([0, *(len(o) for o in own)])
    columns = []
    for k, column in enumerate(own):
        rows = np.zeros((ends[-1], column.shape[1]))
        rows[ends[k] : ends[k + 1]] = column
        columns.append(rows)
    seen = space.measure(columns)
    if seen.gram is None:
        return 0.0
    size = np.sqrt(np.maximum(np.diag(seen.gram), 1e-300))
    amplitudes = np.linalg.lstsq(seen.gram / np.outer(size, size), seen.along / size, rcond=1e-9)[0]
    return float(amplitudes @ (seen.along / size))
