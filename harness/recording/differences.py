"""Third differences: what four neighbouring samples tell of noise, for motion is smooth and noise is not."""

from __future__ import annotations

import numpy as np

from harness.system.description import Array

SQUARE = 20.0  # variance of a third difference of white noise, times the noise's: 1 + 9 + 9 + 1


def third_differences(time: Array, values: Array) -> Array:
    """Third differences of samples (…, T) taken evenly or not, as large as those of even ones; (…, T − 3).

    They vanish on parabolas, and independent errors make their variance ``SQUARE`` times their own. nan where stamps are equal.
    """
    return weighted(third_weights(time), values)


def weighted(weights: Array, values: Array) -> Array:
    """Such differences (…, T − 3) where the weights (4, T − 3) are known."""
    count = values.shape[-1] - 3
    return np.asarray(sum(weights[k] * values[..., k : count + k] for k in range(4)))


def third_weights(time: Array) -> Array:
    """What each of four neighbouring samples counts for in such a difference, (4, T − 3)."""
    stamps = np.stack([time[k : len(time) - 3 + k] for k in range(4)])
    apart = stamps[:, None] - stamps[None, :]
    apart[np.arange(4), np.arange(4)] = 1.0
    product = np.prod(apart / (time[-1] - time[0]), axis=1)
    weights = 1.0 / np.where(product == 0.0, np.nan, product)
    weights *= np.sqrt(SQUARE / np.sum(weights**2, axis=0))
    return np.asarray(weights)


def white_noise(time: Array, values: Array) -> float:
    """Standard deviation of the white noise of a signal (T,), robustly from its third differences; nan without samples.

    A signal that most samples do not have (of a slower sensor) is compared from reading to reading.
    """
    third = np.abs(third_differences(time, values))
    seen, read = third[np.isfinite(third)], np.isfinite(values)
    if 2 * len(seen) < np.count_nonzero(read) - 3:
        third = np.abs(third_differences(time[read], values[read]))
        seen = third[np.isfinite(third)]
    return float(np.median(seen) / 0.6745 / np.sqrt(SQUARE)) if len(seen) else np.nan
