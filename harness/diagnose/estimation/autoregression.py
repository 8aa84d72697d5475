"""How likely residuals are as noise that follows itself as it likes.

What a model leaves out moves slowly beside the sensors' noise. A likelihood that lets every residual follow itself in its own
way holds two explanations against each other whatever each leaves: what hangs together over hundreds of samples costs what it
takes to say so, neither as much as if every sample were news nor as little as if the rest of the recording had not been read.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import FAINTEST_VARIANCE, LONGEST_NOISE_MEMORY

Array = NDArray[np.float64]


def surprise_of_innovations(stretches: Sequence[Array]) -> float:
    """−2 log L of whitened residuals (C, T) under an autoregression of every channel's own, up to a constant of their number.

    Least squares of what each sample follows from those before it; its order, and the price of that, by Schwarz's criterion
    (Lütkepohl, New Introduction to Multiple Time Series Analysis (2005), ch. 4). Stretches under twice the longest order say
    nothing.
    """
    long = [stretch for stretch in stretches if stretch.shape[1] > 2 * LONGEST_NOISE_MEMORY]
    return sum(_of_channel([stretch[c] for stretch in long]) for c in range(len(long[0]))) if long else 0.0


def _of_channel(stretches: Sequence[Array]) -> float:
    count = sum(map(len, stretches))
    # A sample last, those before it from the latest on: one factorisation has the errors of every order.
    lags = [*range(1, LONGEST_NOISE_MEMORY + 1), 0]
    rows = np.vstack(
        [np.column_stack([own[LONGEST_NOISE_MEMORY - k : len(own) - k] for k in lags]) for own in stretches]
    )
    root = np.asarray(np.linalg.qr(rows, mode="r"))
    errors = np.cumsum(root[::-1, -1] ** 2)[::-1]
    variance = np.maximum(errors / len(rows), FAINTEST_VARIANCE)
    return float(np.min(count * np.log(variance) + np.arange(LONGEST_NOISE_MEMORY + 1) * np.log(count)))
