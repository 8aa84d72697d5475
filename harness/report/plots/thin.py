"""Fewer samples of a curve that look like all of them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray


def thinned(count: int, *curves: NDArray[np.float64]) -> NDArray[np.intp]:
    """Indices of about ``count`` samples that keep the highest and lowest of every curve within each of equal stretches.

    curves: each of shape (T,), nan where there is none. All of them if there are no more; the first and last always.
    """
    total = len(curves[0])
    if total <= count:
        return np.arange(total)
    stretches = max(1, count // (2 * len(curves)))
    edges = np.linspace(0, total, stretches + 1).astype(np.intp)
    kept = [np.array([0, total - 1], dtype=np.intp)]
    for curve in curves:
        for begin, end in pairwise(edges):
            part = curve[begin:end]
            if np.isfinite(part).any():
                kept.append(np.array([begin + np.nanargmin(part), begin + np.nanargmax(part)], dtype=np.intp))
            elif end > begin:
                # A gap has to stay a gap.
                kept.append(np.array([begin], dtype=np.intp))
    return np.unique(np.concatenate(kept))
