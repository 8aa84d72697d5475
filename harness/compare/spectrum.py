"""Frequencies read off a motion: lines of a spectrum with their uncertainty, a swing against its amplitude.

A line is where the magnitude of the windowed Fourier transform peaks, evaluated between the bins. For a decaying
oscillation that is its own frequency, not the peak of a resonance curve: decay times window is a positive weight, and
the transform of a positive weight is greatest at zero offset.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import linear_sum_assignment, minimize_scalar
from scipy.signal import butter, detrend, find_peaks, sosfiltfilt
from scipy.signal.windows import blackmanharris

from harness.errors import InputError

Array = NDArray[np.float64]

# Half width of the Blackman-Harris window's main lobe in bins; beyond it a line leaks less than -92 dB.
_LOBE = 4.0
_LEAK = 10.0 ** (-92.0 / 20.0)
# A line has to stand out of the noise around it by this factor in magnitude; noise alone does so once in 1e4 spectra
# of a thousand bins.
_OUTSTANDING = 5.0
_PADDING = 4


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitude spectrum (Blackman-Harris, a sine of amplitude 1 peaks at 1): frequency [Hz] (k,), amplitude (k,)."""

    frequency: Array
    amplitude: Array


@dataclass(frozen=True)
class Line:
    """One line of a spectrum: frequency [Hz], its standard uncertainty [Hz], amplitude in the signal's unit.

    The uncertainty counts the noise around the line and the leakage of stronger lines; two lines within a main lobe
    (four bins of 1 / duration) are not told apart, then it is the width of a bin.
    """

    frequency: float
    std: float
    amplitude: float


@dataclass(frozen=True, eq=False)
class Swing:
    """A swing, one entry each half-swing between passages of the rest position.

    time: middle of the half-swing [s]; amplitude: greatest distance from rest, in the signal's unit; frequency: of a
    full swing at that amplitude [Hz]; std: standard uncertainty of the frequency [Hz]; all (k,).
    """

    time: Array
    amplitude: Array
    frequency: Array
    std: Array


def spectrum(time: ArrayLike, signal: ArrayLike) -> Spectrum:
    """Amplitude spectrum of a signal with its mean and trend taken off, zero-padded fourfold."""
    t, x = _even(time, signal)
    weighted = _weighted(x)
    padded = _PADDING * len(x)
    amplitude = np.abs(np.fft.rfft(weighted, padded))
    return Spectrum(np.fft.rfftfreq(padded, t[1] - t[0]), amplitude)


def lines(
    time: ArrayLike, signal: ArrayLike, *, band: tuple[float, float] | None = None, most: int = 20
) -> tuple[Line, ...]:
    """The lines that stand out of a spectrum, strongest first.

    time: [s], (T,), resampled if uneven; signal: (T,); band: lowest and highest frequency looked at [Hz].
    Raises InputError for less than 16 samples or a signal that is not finite.
    """
    t, x = _even(time, signal)
    step, duration = float(t[1] - t[0]), float(t[-1] - t[0]) + float(t[1] - t[0])
    weighted = _weighted(x)
    coarse = spectrum(t, x)
    low, high = band or (0.0, np.inf)
    # A line within a main lobe of zero is a trend.
    inside = (coarse.frequency >= max(low, _LOBE / 2.0 / duration)) & (coarse.frequency <= high)
    floor = _floor(coarse.amplitude)
    tops, _ = find_peaks(coarse.amplitude, distance=int(_LOBE / 2.0 * _PADDING))
    tops = tops[inside[tops]]
    tops = tops[coarse.amplitude[tops] > np.maximum(_OUTSTANDING * floor[tops], 1e-300)]
    tops = tops[np.argsort(-coarse.amplitude[tops])]
    found: list[Line] = []
    index = np.arange(len(x)) * step
    bin_width = 1.0 / duration
    # White noise of the magnitude seen around the line, through the curvature of the window's main lobe at its top.
    window = blackmanharris(len(x), sym=False)
    centred = index - index.mean()
    spread = float(np.sqrt(np.sum(window**2 * centred**2)) / np.sum(window * centred**2)) / (2.0 * np.pi)
    noise_gain = float(np.sqrt(np.sum(window**2)) / np.sum(window))
    for top in tops:

        def magnitude(f: float) -> float:
            return -float(np.abs(weighted @ np.exp(-2j * np.pi * f * index)))

        middle = float(coarse.frequency[top])
        best = minimize_scalar(
            magnitude,
            bounds=(middle - bin_width, middle + bin_width),
            method="bounded",
            options={"xatol": 1e-9 * bin_width},
        )
        frequency, amplitude = float(best.x), -float(best.fun)
        leak = _LEAK * sum(line.amplitude for line in found)
        if amplitude < _OUTSTANDING * leak:
            continue
        if any(abs(line.frequency - frequency) < 2.0 * bin_width for line in found):
            continue
        # White noise of deviation σ has a Rayleigh magnitude whose median, the floor, is √(2 ln 4) σ gain.
        sigma = float(floor[top]) / np.sqrt(2.0 * np.log(4.0)) / noise_gain
        std = sigma * np.sqrt(2.0) * spread / amplitude
        near = [line for line in found if abs(line.frequency - frequency) < _LOBE * bin_width]
        std = float(np.hypot(std, bin_width * leak / amplitude))
        if near:
            std = max(std, bin_width)
        found.append(Line(frequency, std, amplitude))
        if len(found) == most:
            break
    return tuple(found)


def parted(time: ArrayLike, signal: ArrayLike, split: float) -> tuple[Array, Array]:
    """Slow and fast part of an evenly sampled signal, parted at ``split`` [Hz] without shift in time; each (T,).

    Eighth order in effect (a fourth-order Butterworth filter there and back): an octave away from the split a part
    has lost less than 0.4 % of what is its own.
    """
    t, x = _even(time, signal)
    nyquist = 0.5 / float(t[1] - t[0])
    if not 0.0 < split < nyquist:
        raise InputError(
            f"a split at {split:g} Hz of a signal sampled at {2.0 * nyquist:g} Hz",
            mend=f"take it between 0 and {nyquist:g} Hz",
        )
    sections = butter(4, split / nyquist, output="sos")
    # Padding by three periods of the split keeps the ends from ringing.
    padding = min(len(x) - 1, int(3.0 * 2.0 * nyquist / split))
    slow: Array = sosfiltfilt(sections, x, padtype="odd", padlen=padding)
    return slow, x - slow


def match_modes(
    ours: Sequence[float] | Array, theirs: Sequence[float] | Array, *, within: float = 0.25
) -> tuple[tuple[int, int], ...]:
    """Which of their frequencies is which of ours: pairs of indices, ascending in ours, each used once.

    The sum of logarithmic distances is least, and no pair is further apart than ``within`` (relative); what is left
    unpaired has no counterpart.
    """
    a, b = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    if a.size == 0 or b.size == 0:
        return ()
    if np.any(a <= 0.0) or np.any(b <= 0.0):
        raise InputError("a frequency that is not positive cannot be matched", mend="leave it out")
    distance = np.abs(np.log(a[:, None] / b[None, :]))
    limit = np.log1p(within)
    # Pairs beyond the limit cost more than any number of good ones could save.
    cost = np.where(distance <= limit, distance, 1e3 * limit * (1 + min(a.size, b.size)))
    rows, columns = linear_sum_assignment(cost)
    return tuple((int(i), int(j)) for i, j in zip(rows, columns, strict=True) if distance[i, j] <= limit)


def swing(time: ArrayLike, position: ArrayLike, *, rest: float = 0.0) -> Swing:
    """Frequency of a swing against its amplitude, half-swing by half-swing.

    time: [s], (T,); position: (T,); rest: the position it swings about. Passages and turning points are found by
    polynomials fitted to the samples around them, which noise moves little; a half-swing lasts from one passage to the
    next. Raises InputError if the signal passes its rest position less than twice.
    """
    t, x = _even(time, position)
    x = x - rest
    found = lines(t, x, most=1)
    slow = x
    sampling = 1.0 / float(t[1] - t[0])
    if found and 6.0 * found[0].frequency < 0.4 * sampling:
        slow, _ = parted(t, x, 6.0 * found[0].frequency)
    change = np.flatnonzero(np.sign(slow[:-1]) * np.sign(slow[1:]) < 0)
    # Noise about the rest position passes it many times; a swing reaches a share of its size in between.
    size = float(np.max(np.abs(slow)))
    passages: list[int] = []
    for k in change:
        if passages and np.max(np.abs(slow[passages[-1] : k + 1])) < 1e-3 * size:
            continue
        passages.append(int(k))
    if len(passages) < 2:
        raise InputError(
            f"the signal passes its rest position {rest:g} less than twice",
            mend="give a longer recording, or the position it swings about",
        )
    half = float(np.median(np.diff(passages))) / sampling
    zeros = np.array([_zero(t, x, t[k] + 0.5 / sampling, half / 6.0) for k in passages])
    amplitude = np.array([_extreme(t, x, slow, first, last, half / 6.0) for first, last in pairwise(passages)])
    span = np.diff(zeros[:, 0])
    frequency = 0.5 / span
    std = frequency * np.hypot(zeros[1:, 1], zeros[:-1, 1]) / span
    return Swing(0.5 * (zeros[1:, 0] + zeros[:-1, 0]), amplitude, frequency, std)


def _even(time: ArrayLike, signal: ArrayLike) -> tuple[Array, Array]:
    """Time and signal as arrays on an even grid; a cubic spline resamples what is not even."""
    t, x = np.asarray(time, dtype=np.float64), np.asarray(signal, dtype=np.float64)
    if t.ndim != 1 or t.shape != x.shape or len(t) < 16:
        raise InputError(
            f"a signal of shape {x.shape} over time of shape {t.shape}", mend="give at least 16 samples of both"
        )
    if not (np.all(np.isfinite(t)) and np.all(np.isfinite(x))) or np.any(np.diff(t) <= 0.0):
        raise InputError("time does not increase, or a sample is not finite", mend="remove such samples")
    gaps = np.diff(t)
    if np.ptp(gaps) <= 1e-6 * float(np.mean(gaps)):
        return t, x
    even = np.linspace(t[0], t[-1], len(t))
    return even, np.asarray(CubicSpline(t, x)(even))


def _weighted(x: Array) -> Array:
    window = blackmanharris(len(x), sym=False)
    weighted: Array = detrend(x) * window * (2.0 / np.sum(window))
    return weighted


def _floor(amplitude: Array) -> Array:
    """Running median of the magnitudes over some 120 bins: noise without the lines in it."""
    width = 120 * _PADDING
    if len(amplitude) <= width:
        return np.full_like(amplitude, np.median(amplitude))
    blocks = np.arange(0, len(amplitude) - width + 1, width // 4)
    medians = np.array([np.median(amplitude[k : k + width]) for k in blocks])
    floor: Array = np.interp(np.arange(len(amplitude)), blocks + width / 2.0, medians)
    return floor


def _around(t: Array, middle: float, reach: float) -> slice:
    """Samples within ``reach`` [s] of ``middle``, at least ten of them."""
    step = float(t[1] - t[0])
    reach = max(reach, 5.0 * step)
    first = max(0, int(np.ceil((middle - reach - t[0]) / step)))
    last = min(len(t), int(np.floor((middle + reach - t[0]) / step)) + 1)
    return slice(first, last)


def _fitted(t: Array, x: Array, degree: int) -> tuple[Array, Array, float, float]:
    """Polynomial through samples: coefficients over scaled time, their covariance, centre and half width of the scale."""
    centre, width = 0.5 * float(t[0] + t[-1]), 0.5 * float(t[-1] - t[0])
    degree = min(degree, len(t) - 2)
    basis = np.vander((t - centre) / width, degree + 1, increasing=True)
    coefficients = np.asarray(np.linalg.lstsq(basis, x, rcond=None)[0], dtype=np.float64)
    residual = x - basis @ coefficients
    variance = float(residual @ residual) / max(1, len(t) - degree - 1)
    covariance = np.asarray(variance * np.linalg.inv(basis.T @ basis), dtype=np.float64)
    return coefficients, covariance, centre, width


def _zero(t: Array, x: Array, guess: float, reach: float) -> tuple[float, float]:
    """Time of the passage through zero near ``guess`` and its standard uncertainty [s]."""
    near = _around(t, guess, reach)
    coefficients, covariance, centre, width = _fitted(t[near], x[near], 5)
    polynomial = np.polynomial.Polynomial(coefficients)
    found = np.asarray(polynomial.roots(), dtype=np.complex128)
    roots = np.real(found[np.abs(np.imag(found)) < 1e-9])
    roots = roots[np.abs(roots) <= 1.2]
    where = (
        float(roots[np.argmin(np.abs(roots - (guess - centre) / width))]) if len(roots) else (guess - centre) / width
    )
    row = where ** np.arange(len(coefficients))
    slope = float(polynomial.deriv()(where))
    std = float(np.sqrt(row @ covariance @ row)) / abs(slope) * width if slope else np.inf
    return centre + width * where, std


def _extreme(t: Array, x: Array, slow: Array, first: int, last: int, reach: float) -> float:
    """Greatest distance from zero between two passages."""
    top = first + int(np.argmax(np.abs(slow[first : last + 1])))
    near = _around(t, float(t[top]), reach)
    coefficients, _, centre, width = _fitted(t[near], x[near], 6)
    polynomial = np.polynomial.Polynomial(coefficients)
    found = np.asarray(polynomial.deriv().roots(), dtype=np.complex128)
    turning = np.real(found[np.abs(np.imag(found)) < 1e-9])
    turning = turning[np.abs(turning) <= 1.0]
    values = np.abs(polynomial(np.append(turning, (t[top] - centre) / width)))
    return float(np.max(values))
