"""Noise of each channel from the recording alone: how much, how coloured, how much of it rounding.

Motion is smooth and noise is not, so beyond some frequency a channel's spectrum is noise. The spectrum is estimated by
Slepian tapers on second differences (which keep the motion's power from leaking upwards), the lowest frequency above
which one noise model fits everywhere is searched, and the model is fitted there by Whittle's likelihood: white noise,
first-order autoregressive noise, or their sum, whichever the Bayesian information criterion prefers. Lines in the
spectrum (hum, vibration) are left out.

Sources: Thomson, Spectrum estimation and harmonic analysis, Proc. IEEE 70 (1982) 1055–1096; Whittle, Estimation and
information in stationary time series, Ark. Mat. 2 (1953) 423–434; Bennett, Spectra of quantized signals, Bell Syst. Tech. J. 27
(1948) 446–472 (variance of rounding, step²/12).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.signal.windows import dpss

from harness.recording.clean import quantisation_step
from harness.recording.recording import Recording
from harness.system.description import Array

HALF_BANDWIDTH = 6.0  # of the tapers, in bins
TAPERS = 6  # of 2 · 6 − 1 usable ones: those that leak less than 1e-6
DIFFERENCES = 2
SHORTEST = 64  # samples of a piece of the recording
CUTOFFS = 20  # frequencies tried as the lower end of the noise band
BANDS = 5  # neighbouring bands, in thirds of an octave, that a noise model must fit above its lower end
EXCESS = 3.0  # standard deviations of such a band's power over the model
DEGREE = 5  # of the polynomial that a sample is moved along to an even grid
LINE = 9.0  # power over the model's beyond which a bin belongs to a line: e⁻⁹ of the bins of noise
MOST_LINES = 0.1  # of the bins
CORNER = 0.5  # of a noise's corner frequency to the band's lower end, at least
MIXED_CORNER = 1.5  # the same beside white noise, where only the corner tells colour from the motion's tail
CONFIRM = 3.0  # of a band's lower end to that of the band that must show the same colour
GROUPS = 160  # of bins that the likelihood is summed over
STEP = 1e-8  # of a logarithm, over which the likelihood's slope is read off

Model = tuple[float, float, float]
"""Standard deviations of the white and of the autoregressive part, and φ."""


@dataclass(frozen=True)
class NoiseEstimate:
    """Noise of one channel.

    std: of all of it, rounding included [unit]. white: of its uncorrelated part [unit]. coloured: of its autoregressive
    part [unit], 0 if there is none. coefficient: φ of that part from sample to sample [1]. time: its correlation time
    −interval/ln φ [s]. step: of quantisation, 0 if none is seen [unit]. band: frequencies that it was estimated from [Hz].
    relative_error: standard error of ``std`` over ``std``. reliability: ``good``, ``fair`` (little of the spectrum is free of
    motion, or the samples are few) or ``poor`` (nowhere does noise alone explain the spectrum; ``std`` is an upper bound).
    """

    channel: str
    std: float
    white: float
    coloured: float
    coefficient: float
    time: float
    step: float
    unit: str
    band: tuple[float, float]
    relative_error: float
    reliability: str

    def words(self) -> str:
        """In a few words, for a table."""
        text = f"noise {self.std:.3g} {self.unit}"
        if self.coloured > 0.0:
            text += f", correlated over {self.time:.3g} s"
        if self.step > 0.0 and self.step / np.sqrt(12.0) > 0.3 * self.std:
            text += f", steps of {self.step:.3g} {self.unit}"
        return text if self.reliability == "good" else f"{text} ({self.reliability} estimate)"

    def autocovariance(self, lags: Array) -> Array:
        """Autocovariance at lags [s], same shape as ``lags``."""
        lags = np.abs(np.asarray(lags, dtype=np.float64))
        covariance = np.where(lags == 0.0, self.white**2, 0.0)
        if self.coloured > 0.0 and self.time > 0.0:
            covariance = covariance + self.coloured**2 * np.exp(-lags / self.time)
        return covariance


def recording_noise(recording: Recording) -> Mapping[str, NoiseEstimate]:
    """Noise of every measured channel by its name."""
    return {
        channel.name: estimate_noise(recording.time, channel.values, unit=channel.unit, channel=channel.name)
        for channel in recording.channels
    }


def estimate_noise(time: Array, values: Array, *, unit: str = "", channel: str = "") -> NoiseEstimate:
    """Noise of one signal.

    time: [s], ascending, even or not, shape (T,). values: shape (T,), nan where there is no sample.
    """
    present = np.isfinite(values)
    time, values = np.asarray(time)[present], np.asarray(values)[present]
    interval = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    step = quantisation_step(values)
    floor = step / np.sqrt(12.0)

    def result(
        white: float, coloured: float, phi: float, band: tuple[float, float], error: float, words: str
    ) -> NoiseEstimate:
        # Rounding that is not stirred by other noise hides from the spectrum in its lines, but is error all the same.
        white = float(np.hypot(white, np.sqrt(max(floor**2 - white**2 - coloured**2, 0.0))))
        constant_time = float(-interval / np.log(phi)) if coloured > 0.0 and 0.0 < phi < 1.0 else 0.0
        total = float(np.hypot(white, coloured))
        return NoiseEstimate(
            channel,
            total,
            white,
            coloured,
            phi if coloured > 0.0 else 0.0,
            constant_time,
            step,
            unit,
            band,
            error,
            words,
        )

    if len(values) < 8 or float(np.ptp(values)) == 0.0:
        return result(0.0, 0.0, 0.0, (0.0, 0.0), np.inf, "poor")
    frequency, power = _spectrum(time, values, interval)
    if len(frequency) < 16:
        rough = _rough(time, values)
        return result(rough, 0.0, 0.0, (0.0, 0.5 / interval), 1.0 / np.sqrt(len(values)), "poor")
    fit, lower, words = _search(frequency, power)
    white, coloured, phi = fit
    used = int((frequency >= lower).sum())
    error = 1.0 / np.sqrt(max(2 * used, 1))
    if coloured > 0.0:
        # The variance is then extrapolated below the band, by the uncertainty of the corner 1 − φ.
        error = float(
            np.hypot(error, 0.5 * np.sqrt(2.0 / max(used * (1.0 - phi), 1e-3)) * coloured / np.hypot(white, coloured))
        )
    return result(white, coloured, phi, (lower / interval, 0.5 / interval), error, words)


def _spectrum(time: Array, values: Array, interval: float) -> tuple[Array, Array]:
    """Frequencies [cycles a sample] and power of the signal's second differences taken back, pooled over even pieces.

    Power is scaled so that white noise of variance s² has power s² everywhere.
    """
    frequencies, powers = [], []
    for first, last in _pieces(time, interval):
        even = _on_even_grid(time[first:last], values[first:last])
        differenced = np.diff(even, n=DIFFERENCES)
        count = len(differenced)
        tapers = dpss(count, HALF_BANDWIDTH, Kmax=TAPERS)
        f = np.fft.rfftfreq(count)[1:]
        spectra = np.abs(np.fft.rfft(tapers * differenced, axis=1)[:, 1:]) ** 2
        gain = (2.0 * np.sin(np.pi * f)) ** (2 * DIFFERENCES)
        keep = f < 0.5 - 0.5 / count  # the Nyquist bin has one degree of freedom, not two
        frequencies.append(f[keep])
        powers.append(spectra.mean(axis=0)[keep] / gain[keep])
    if not frequencies:
        return np.empty(0), np.empty(0)
    f, p = np.concatenate(frequencies), np.concatenate(powers)
    order = np.argsort(f, kind="stable")
    return np.asarray(f[order], dtype=np.float64), np.asarray(p[order], dtype=np.float64)


def _pieces(time: Array, interval: float) -> list[tuple[int, int]]:
    """Stretches without gaps whose samples lie within half an interval (rms) of an even grid."""
    edges = [0, *(np.flatnonzero(np.diff(time) > 5.0 * interval) + 1).tolist(), len(time)]
    waiting = list(pairwise(edges))
    pieces = []
    while waiting:
        first, last = waiting.pop()
        if last - first < SHORTEST:
            continue
        index = np.arange(last - first, dtype=np.float64)
        slope, start = np.polyfit(index, time[first:last], 1)
        deviation = float(np.sqrt(np.mean((time[first:last] - start - slope * index) ** 2)))
        if deviation > 0.5 * interval and last - first >= 2 * SHORTEST:
            middle = (first + last) // 2
            waiting += [(first, middle), (middle, last)]
        else:
            pieces.append((first, last))
    return sorted(pieces)


def _on_even_grid(time: Array, values: Array) -> Array:
    """Samples moved to the nearest even grid along the local polynomial through their neighbours; noise moves with them."""
    count = len(time)
    index = np.arange(count, dtype=np.float64)
    slope, start = np.polyfit(index, time, 1)
    shift = start + slope * index - time
    if float(np.abs(shift).max()) < 1e-4 * slope:
        return values
    half = 6
    centre = np.clip(np.arange(count), half, count - 1 - half)
    neighbours = centre[:, None] + np.arange(-half, half + 1)[None, :]
    x = (time[neighbours] - time[:, None]) / (half * slope)
    basis = np.stack([x**power for power in range(DEGREE + 1)], axis=2)
    normal = np.einsum("kij,kil->kjl", basis, basis)
    right = np.einsum("kij,ki->kj", basis, values[neighbours])
    coefficients = np.linalg.solve(normal + 1e-12 * np.eye(DEGREE + 1), right[..., None])[..., 0]
    u = shift / (half * slope)
    move = np.zeros(count)
    for power in range(DEGREE, 0, -1):
        move = u * (coefficients[:, power] + move)
    return np.asarray(values + move)


def _search(frequency: Array, power: Array) -> tuple[Model, float, str]:
    """Noise model above the lowest frequency from which on it fits, that frequency, and how far to trust it."""
    lowest = min(1.5 * HALF_BANDWIDTH * float(frequency[0]), 0.2)
    found: list[tuple[Model, float]] = []
    for lower in np.geomspace(0.35, lowest, CUTOFFS):
        use = frequency >= lower
        if int(use.sum()) < 12:
            continue
        fit, kept = _fit(frequency[use], power[use], lower, found[-1][0] if found else None)
        if _fits(frequency[use], power[use], kept, fit, lower):
            found.append((fit, float(lower)))
    if not found:
        use = frequency >= 0.25
        return (float(np.sqrt(power[use].mean())), 0.0, 0.0), 0.25, "poor"
    fit, lower = found[-1]
    # Colour that a band well above does not show is the motion's own tail at the band's lower end.
    while fit[1] > 0.0:
        higher = [entry for entry in found if entry[1] > CONFIRM * lower]
        if not higher or higher[-1][0][1] > 0.0:
            break
        fit, lower = higher[-1]
    wide = lower < 0.25 and int((frequency >= lower).sum()) >= 60
    # Colour whose corner is at its bound is known by its slope only.
    seen = fit[1] < 0.3 * fit[0] or fit[2] < 0.98 * _reddest(lower)
    return fit, lower, "good" if wide and seen else "fair"


def _reddest(lower: float, corner: float = CORNER) -> float:
    """The largest φ whose corner frequency (1 − φ)/2π the band from ``lower`` on can show."""
    return float(max(1.0 - 2.0 * np.pi * corner * lower, 0.05))


def _fits(frequency: Array, power: Array, kept: NDArray[np.bool_], fit: Model, lower: float) -> bool:
    ratio = power / _model(frequency, *fit)
    edge = lower
    for _ in range(BANDS):
        band = (frequency >= edge) & (frequency < edge * 2.0 ** (1.0 / 3.0))
        edge *= 2.0 ** (1.0 / 3.0)
        if int(band.sum()) < 4:
            continue
        clean = band & kept
        count = int(clean.sum())
        if count < 0.7 * int(band.sum()):
            return False  # so many lines in a band are the motion itself
        if abs(float(ratio[clean].mean()) - 1.0) > EXCESS * np.sqrt(1.3 / count):
            return False
    return True


def _model(frequency: Array, white: float, coloured: float, phi: float) -> Array:
    """Power of white and first-order autoregressive noise of these standard deviations."""
    shape = (1.0 - phi**2) / (1.0 - 2.0 * phi * np.cos(2.0 * np.pi * frequency) + phi**2)
    return white**2 + coloured**2 * shape


def _fit(frequency: Array, power: Array, lower: float, start: Model | None) -> tuple[Model, NDArray[np.bool_]]:
    """White, coloured standard deviation and φ by Whittle's likelihood, and the bins that belong to no line."""
    kept = np.ones(len(frequency), dtype=bool)
    fit = (0.0, 0.0, 0.0)
    for _ in range(3):
        fit = _fit_once(*_grouped(frequency[kept], power[kept]), _reddest(lower), _reddest(lower, MIXED_CORNER), start)
        line = power > LINE * _model(frequency, *fit)
        if float(line.mean()) > MOST_LINES or np.array_equal(~line, kept):
            break
        kept = ~line
    return fit, kept


def _grouped(frequency: Array, power: Array) -> tuple[Array, Array, Array]:
    """Means of frequency and power over narrow groups of bins, and the groups' sizes: the likelihood in fewer terms."""
    edges = np.geomspace(frequency[0], frequency[-1] * (1.0 + 1e-9), GROUPS + 1)
    group = np.searchsorted(edges, frequency, side="right")
    size = np.bincount(group).astype(np.float64)
    used = size > 0.0
    size_safe = np.where(used, size, 1.0)
    centre = np.bincount(group, weights=frequency) / size_safe
    mean = np.bincount(group, weights=power) / size_safe
    return centre[used], mean[used], size[used]


def _fit_once(
    frequency: Array, power: Array, size: Array, reddest: float, mixed_reddest: float, start: Model | None
) -> Model:
    count = float(size.sum())
    level = float(power @ size) / count
    cosine = np.cos(2.0 * np.pi * frequency)
    log_level = np.log(level)

    def shape(phi: float) -> Array:
        return (1.0 - phi * phi) / (1.0 - 2.0 * phi * cosine + phi * phi)

    def phi_of(logit: float, most: float) -> float:
        return float(most / (1.0 + np.exp(-logit)))

    def loss(model: Array) -> float:
        return float(size @ (np.log(model) + power / model))

    def coloured_loss(x: Array) -> float:
        return loss(np.exp(x[0]) * shape(phi_of(x[1], reddest)))

    def mixed_loss(x: Array) -> float:
        return loss(np.exp(x[0]) * shape(phi_of(x[1], mixed_reddest)) + np.exp(x[2]))

    box = ((log_level - 30.0, log_level + 30.0), (-6.0, 6.0))
    ends = [_least(coloured_loss, (log_level, logit), box) for logit in (0.0, 2.5)]
    single = min(ends, key=lambda end: float(end.fun))
    guesses = [(single.x[0], single.x[1], np.log(power.min()))]
    if start is not None and start[0] > 0.0 and start[1] > 0.0:
        share = min(max(start[2] / mixed_reddest, 0.01), 0.99)
        guesses.append((2.0 * np.log(start[1]), np.log(share / (1.0 - share)), 2.0 * np.log(start[0])))
    doubles = [_least(mixed_loss, g, (*box, box[0])) for g in guesses]
    double = min(doubles, key=lambda end: float(end.fun))
    penalty = np.log(count)
    scores: list[tuple[float, Model]] = [
        (2.0 * loss(np.full(len(power), level)) + penalty, (float(np.sqrt(level)), 0.0, 0.0)),
        (
            2.0 * float(single.fun) + 2.0 * penalty,
            (0.0, float(np.exp(single.x[0] / 2.0)), phi_of(single.x[1], reddest)),
        ),
        (
            2.0 * float(double.fun) + 3.0 * penalty,
            (float(np.exp(double.x[2] / 2.0)), float(np.exp(double.x[0] / 2.0)), phi_of(double.x[1], mixed_reddest)),
        ),
    ]
    return min(scores, key=lambda score: score[0])[1]


def _least(loss: Callable[[Array], float], start: tuple[float, ...], box: tuple[tuple[float, float], ...]) -> Any:
    """SciPy's least value of a loss of a few numbers within a box.

    Slopes are forward differences, as SciPy's own are, which spends most of its time on finding out what was asked of it.
    """

    def with_slopes(x: Array) -> tuple[float, Array]:
        here = loss(x)
        slopes = np.empty(len(x))
        for k, (_, upper) in enumerate(box):
            there = x.copy()
            there[k] += STEP if x[k] + STEP <= upper else -STEP
            slopes[k] = (loss(there) - here) / (there[k] - x[k])
        return here, slopes

    return minimize(with_slopes, start, jac=True, method="L-BFGS-B", bounds=box)


def _rough(time: Array, values: Array) -> float:
    """Robust standard deviation of white noise from second differences generalised to uneven times."""
    h0, h1 = np.diff(time)[:-1], np.diff(time)[1:]
    weight = h1 / (h0 + h1)
    residual = values[1:-1] - weight * values[:-2] - (1.0 - weight) * values[2:]
    size = np.sqrt(1.0 + weight**2 + (1.0 - weight) ** 2)
    return float(1.4826 * np.median(np.abs(residual / size)))
