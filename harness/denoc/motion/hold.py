"""Forces between the points of a grid, kept from each to the next or joined by straight lines: either as the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def joined(steps: Array) -> Array:
    """Forces (…, G, n) to be joined by straight lines that act as ones that are kept from each point to the next."""
    out = steps.copy()
    out[..., 1:, :] = 0.5 * (steps[..., 1:, :] + steps[..., :-1, :])
    return out


def kept(straight: Array) -> Array:
    """Forces (…, G, n) to be kept from each point to the next that act as ones joined by straight lines."""
    out = straight.copy()
    out[..., :-1, :] = 0.5 * (straight[..., 1:, :] + straight[..., :-1, :])
    return out
