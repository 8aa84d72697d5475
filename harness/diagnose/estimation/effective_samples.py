"""How many readings of a series that follows itself are worth one that does not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import CORRELATION_REACH

Array = NDArray[np.float64]


def hanging_together(pieces: Sequence[Array]) -> Array:
    """How many samples of every channel (C,) err together: the sum of squared correlations over lags and over channels.

    pieces: residuals (C, T) of stretches. Two series that are alike so correlated have a correlation by chance of this over T.
    """
    longest = max(piece.shape[1] for piece in pieces)
    count = len(pieces[0])
    lags = np.zeros((count, count, longest))
    for piece in pieces:
        size = piece.shape[1]
        ahead = np.fft.rfft(piece, 2 * size)
        across = np.fft.irfft(ahead[:, None] * np.conj(ahead[None]))[..., :size]
        lags[..., :size] += across
    power = np.maximum(lags[np.arange(count), np.arange(count), 0], 1e-300)
    correlation = np.clip(lags / np.sqrt(power[:, None] * power[None])[..., None], -1.0, 1.0)
    # A lag of one channel behind another is one of that ahead of it.
    square = np.sum(correlation**2 + np.swapaxes(correlation, 0, 1) ** 2, axis=1)
    square[:, 0] /= 2.0
    out = np.empty(count)
    for c in range(count):
        total = np.cumsum(square[c])
        far = np.arange(longest) >= CORRELATION_REACH * total
        out[c] = total[int(np.argmax(far))] if far.any() else total[-1]
    return out
