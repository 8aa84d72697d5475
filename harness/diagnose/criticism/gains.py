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
    """Gain in cost by a column of every window, (M_w,), or several, (k, M_w), with amplitudes of its own in each."""
    return window_by_window(space, [np.atleast_2d(column) for column in chosen], 1e-9)[0]


def window_by_window(
    space: Nuisance, columns: Sequence[Array], strength: float = GAIN_RIDGE
) -> tuple[float, list[Array], float]:
    """Gain in cost, coefficients by window and effective number of directions of columns of every window, (k_w, M_w).

    It is not the sum of what windows gain by themselves: all have to do with the same shared parameters. These are few, so that
    however many windows there are no matrix of all columns is needed (Woodbury's identity).
    """
    least = max(strength**2, 1e-12)
    ends = np.cumsum([0, *(len(q) for q in space.states)])
    units, alone, shared = [], [], []
    for own, states, first, last in zip(columns, space.states, ends, ends[1:], strict=False):
        changes = own / space.softness
        changes = changes - (changes @ states) @ states.T
        # What columns of a window change beside each other, in directions of unit size.
        norms = np.linalg.norm(changes, axis=1)
        seen = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
        scale = np.divide(1.0, norms, out=np.zeros(len(norms)), where=seen)
        values, vectors = np.linalg.eigh(np.outer(scale, scale) * (changes @ changes.T))
        strong = values > least * max(float(values.max(initial=0.0)), 1e-300)
        across = scale[:, None] * vectors[:, strong] / np.sqrt(values[strong])
        units.append(across)
        alone.append(across.T @ (changes @ space.residual[first:last]))
        shared.append(across.T @ (changes @ space.shared[first:last]))
    along, of_shared = np.concatenate(alone), np.vstack(shared)
    squares, turned = np.linalg.eigh(of_shared.T @ of_shared)
    left = 1.0 - squares
    # A combination of all columns that does what a shared parameter does is no change beside that.
    apart = left > least
    factor = np.where(apart, 1.0 / np.where(apart, left, 1.0), -1.0 / np.maximum(squares, least))
    reached = turned.T @ (of_shared.T @ along)
    gain = float(along @ along + np.sum(factor * reached**2))
    found = along + of_shared @ (turned @ (factor * reached))
    edges = np.cumsum([0, *(across.shape[1] for across in units)])
    coefficients = [-(across @ found[a:b]) for across, a, b in zip(units, edges, edges[1:], strict=False)]
    return gain, coefficients, float(len(along) - np.count_nonzero(~apart))
