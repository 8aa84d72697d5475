"""The half-swings of a decaying signal: amplitude and frequency of each about the rest position they share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.compare.decay.oscillator import Array, period_ratio
from harness.compare.spectrum import Swing, swing
from harness.errors import InputError

# A half-swing this many deviations of the noise high can be told from it.
ABOVE_NOISE = 4.0
FEWEST = 4
# By such a share must the frequencies scatter less by one law of restoring than by the other to tell: the noise of the amplitudes
# is in that by the sine, so that where both agree they differ by a factor of three.
TOLD_APART = 1.0 / 9.0


@dataclass(frozen=True, eq=False)
class HalfSwings:
    """Half-swings between passages of the rest position, in order.

    time: of each turning point, the middle between its passages [s]; amplitude; frequency [Hz] and its std, each (k,).
    rest: position swung about. sign: of the first turning point. small: frequency of vanishing swings [Hz].
    noise: standard deviation of the signal's noise, from third differences.
    sine: whether the restoring force goes with sin q, which makes wide swings slower, or with q.
    """

    time: Array
    amplitude: Array
    frequency: Array
    std: Array
    rest: float
    sign: float
    small: float
    noise: float
    sine: bool


def white_noise(signal: Array) -> float:
    """Standard deviation of white noise on a smooth, densely sampled signal (T,), by the median of its third differences."""
    return float(1.4826 * np.median(np.abs(np.diff(signal, 3))) / np.sqrt(20.0))


def half_swings(time: Array, signal: Array, *, sine: bool | None = None, noise: float | None = None) -> HalfSwings:
    """Half-swings of a signal (T,) over time [s] (T,), as far as they stand out of the noise.

    sine: None decides by which of the two laws makes the half-swings' frequencies agree. noise: the signal's standard deviation of
    noise, None measures it.
    Raises InputError if there are fewer than four.
    """
    noise = white_noise(signal) if noise is None else noise
    rest = 0.5 * float(np.quantile(signal, 0.02) + np.quantile(signal, 0.98))
    found, sign = _told(time, signal, rest, noise)
    for _ in range(3):
        signs = sign * (-1.0) ** np.arange(len(found.amplitude))
        turning = rest + signs * found.amplitude
        # Every turning point against the mean of its neighbours on the other side: the middle they share.
        middle = 0.25 * (turning[:-2] + 2.0 * turning[1:-1] + turning[2:])
        rest = float(np.median(middle))
        found, sign = _told(time, signal, rest, noise)
    laws = (True, False) if sine is None else (sine,)
    scatter, small, chosen = min((*_small(found, law), law) for law in laws)
    return HalfSwings(
        found.time,
        found.amplitude,
        found.frequency,
        found.std,
        rest,
        sign,
        small,
        noise,
        chosen if scatter else laws[0],
    )


def restoring_told(found: HalfSwings) -> bool:
    """Whether the frequencies of the half-swings tell if the restoring force goes with sin q or q: not where none grows smaller."""
    each = Swing(found.time, found.amplitude, found.frequency, found.std)
    least, most = sorted(_small(each, law)[0] for law in (True, False))
    return least < TOLD_APART * most


def _small(found: Swing, sine: bool) -> tuple[float, float]:
    """Scatter of the frequency of vanishing swings by a law of restoring, and that frequency [Hz]."""
    each = found.frequency * period_ratio(np.minimum(found.amplitude, 3.0), sine=sine)
    weight = 1.0 / np.maximum(found.std, 1e-3 * float(np.median(found.std)) + 1e-12) ** 2
    mean = float(np.sum(weight * each) / np.sum(weight))
    return float(np.sum(weight * (each - mean) ** 2)), mean


def _told(time: Array, signal: Array, rest: float, noise: float) -> tuple[Swing, float]:
    """Half-swings above the noise, and the sign of the first."""
    found = swing(time, signal, rest=rest)
    usual = float(np.median(found.frequency[: max(4, len(found.frequency) // 3)]))
    fits = (found.amplitude > ABOVE_NOISE * noise) & (np.abs(found.frequency / usual - 1.0) < 0.5)
    count = len(fits) if fits.all() else int(np.argmin(fits))
    if count < FEWEST:
        raise InputError(
            f"only {count} half-swings stand out of the noise",
            mend=f"a decay needs {FEWEST}: record longer, release higher",
        )
    kept = Swing(*(column[:count] for column in (found.time, found.amplitude, found.frequency, found.std)))
    first = int(np.argmin(np.abs(time - kept.time[0])))
    return kept, float(np.sign(signal[first] - rest)) or 1.0
