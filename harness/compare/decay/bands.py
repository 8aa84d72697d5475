"""Swing and vibration of one signal parted by a filter, each with its frequency, amplitude and decay."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from harness.compare.decay.oscillator import Array
from harness.compare.decay.swings import FEWEST, HalfSwings, half_swings, white_noise
from harness.compare.spectrum import lines, parted
from harness.errors import InputError

# The band that is taken around a vibration's line, as multiples of its frequency.
AROUND = (0.6, 1.6)


@dataclass(frozen=True, eq=False)
class Band:
    """One band of a signal; numbers with their 95 % intervals.

    name: ``swing`` or ``vibration``. time [s], signal: the band alone (T,). turning: times and amplitudes of half-swings, (k,).
    frequency [Hz]; amplitude: at the first half-swing; rate: of the exponential decay of the amplitude [1/s];
    damping_ratio: rate / 2π frequency. line: frequency of the strongest line of the Fourier spectrum in the band [Hz], for the
    other way of parting.
    """

    name: str
    time: Array
    signal: Array
    turning: tuple[Array, Array]
    frequency: tuple[float, float, float]
    amplitude: tuple[float, float, float]
    rate: tuple[float, float, float]
    damping_ratio: tuple[float, float, float]
    line: float | None


def bands(time: Array, signal: Array, *, split: float | None = None) -> tuple[Band, Band]:
    """The swing below and the vibration above ``split`` [Hz]; None puts it at the geometric mean of the strongest lines of each.

    time [s], signal: (T,). Raises InputError if the signal has not both.
    """
    if split is None:
        split = _between(time, signal)
    slow, fast = parted(time, signal, split)
    even = np.linspace(float(time[0]), float(time[-1]), len(time))
    # A period of the split at each end is where the filter does not know what came before or comes after.
    ends = int(np.ceil(1.0 / split / (even[1] - even[0])))
    inner = slice(ends, len(even) - ends)
    return (
        _band("swing", even[inner], slow[inner], signal, (0.0, split)),
        _band("vibration", even[inner], fast[inner], signal, (split, np.inf)),
    )


def _between(time: Array, signal: Array) -> float:
    found = lines(time, signal, most=12)
    if not found:
        raise InputError("no line stands out of the spectrum", mend="give a longer recording, or one with less noise")
    lowest = min(
        (line for line in found if line.amplitude > 0.05 * found[0].amplitude), key=lambda line: line.frequency
    )
    # Harmonics of a wide swing are odd multiples up to some ten times its frequency.
    above = [line for line in found if line.frequency > 10.0 * lowest.frequency]
    if not above:
        raise InputError(
            f"nothing vibrates above the swing at {lowest.frequency:.3g} Hz", mend="give --split, or another channel"
        )
    fastest = max(above, key=lambda line: line.amplitude)
    return float(np.sqrt(lowest.frequency * fastest.frequency))


def _band(name: str, time: Array, signal: Array, whole: Array, limits: tuple[float, float]) -> Band:
    strongest = lines(time, signal, band=limits, most=1)
    raw = white_noise(whole)
    narrow, noise = signal, raw
    rate_of_samples = 1.0 / float(time[1] - time[0])
    if strongest and limits[0] > 0.0 and AROUND[1] * strongest[0].frequency < 0.4 * rate_of_samples:
        # Maxima of a noisy wave are too high; a band around the line leaves little of the noise.
        low, high = (factor * strongest[0].frequency for factor in AROUND)
        narrow = sosfiltfilt(butter(2, (low, high), btype="bandpass", fs=rate_of_samples, output="sos"), signal)
        noise = raw * float(np.sqrt(2.0 * (high - low) / rate_of_samples))
    found = half_swings(time, narrow, sine=False, noise=noise)
    if narrow is not signal:
        found = _away_from(found, 2.0 / strongest[0].frequency, time)
    frequency, amplitude, rate = _decay(found)
    return Band(
        name,
        time,
        signal,
        (found.time, found.amplitude),
        frequency,
        amplitude,
        rate,
        _ratio(rate, frequency),
        strongest[0].frequency if strongest else None,
    )


Interval = tuple[float, float, float]


def _away_from(found: HalfSwings, reach: float, time: Array) -> HalfSwings:
    """Half-swings further than ``reach`` [s] from both ends, where a narrow filter rings; all of them if hardly any are left."""
    inside = (found.time > time[0] + reach) & (found.time < time[-1] - reach)
    if np.count_nonzero(inside) < FEWEST:
        return found
    return replace(
        found,
        time=found.time[inside],
        amplitude=found.amplitude[inside],
        frequency=found.frequency[inside],
        std=found.std[inside],
    )


def _ratio(rate: Interval, frequency: Interval) -> Interval:
    """Damping ratio of a decay, with what both widths make of its own."""
    value = rate[0] / float(np.hypot(2.0 * np.pi * frequency[0], rate[0]))
    of_rate, of_frequency = (abs(one[2] - one[1]) / 2.0 / max(abs(one[0]), 1e-300) for one in (rate, frequency))
    reach = abs(value) * float(np.hypot(of_rate, of_frequency))
    return value, value - reach, value + reach


def _decay(found: HalfSwings) -> tuple[Interval, Interval, Interval]:
    """Frequency, first amplitude and rate of decay, by weighted straight lines: turning points, logarithms of amplitudes."""
    t, a = found.time - found.time[0], found.amplitude
    weight = a**2
    basis = np.column_stack([np.ones_like(t), -t])
    normal = basis.T @ (weight[:, None] * basis)
    level, rate = np.linalg.solve(normal, basis.T @ (weight * np.log(a)))
    residual = np.log(a) - basis @ np.array([level, rate])
    # Neighbouring amplitudes err alike where the law is not exponential or a beat goes through: their memory widens.
    scaled = np.sqrt(weight) * residual
    memory = float(np.clip(scaled[1:] @ scaled[:-1] / max(float(scaled @ scaled), 1e-300), 0.0, 0.95))
    variance = float(scaled @ scaled) / max(1, len(t) - 2) * (1.0 + memory) / (1.0 - memory)
    covariance = np.linalg.inv(normal) * variance
    reach = 1.96 * np.sqrt(np.diagonal(covariance))
    # The frequency by a straight line through the turning points, whose scatter a single half-swing's frequency has twice over.
    count = np.column_stack([np.ones_like(t), np.arange(len(t), dtype=np.float64)])
    begin, half = np.linalg.solve(count.T @ (weight[:, None] * count), count.T @ (weight * t))
    late = np.sqrt(weight) * (t - count @ np.array([begin, half]))
    kept = float(np.clip(late[1:] @ late[:-1] / max(float(late @ late), 1e-300), 0.0, 0.95))
    slack = float(late @ late) / max(1, len(t) - 2) * (1.0 + kept) / (1.0 - kept)
    mean = 0.5 / float(half)
    wide = mean * 1.96 * float(np.sqrt(np.linalg.inv(count.T @ (weight[:, None] * count))[1, 1] * slack)) / float(half)
    first = float(np.exp(level))
    return (
        (mean, mean - wide, mean + wide),
        (first, first * float(np.exp(-reach[0])), first * float(np.exp(reach[0]))),
        (float(rate), float(rate - reach[1]), float(rate + reach[1])),
    )
