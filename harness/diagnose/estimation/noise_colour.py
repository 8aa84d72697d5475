"""The colour of measurement noise: white noise beside a first-order coloured part, and the filter that whitens both.

Noise is estimated from the spectrum of a residual, one-sidedly: where the motion itself has power, a misfit of the model
can only raise the spectrum, so there the noise is held *below* what is seen; above the motion's harmonics it is held to
it. That way a misfit is not taken for noise.

A coloured part must show beyond the motion's band and may not remember longer than a swing: a jump of the reading has the spectrum
of noise with endless memory, and is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.signal import lfilter
from scipy.stats import gamma

from harness.diagnose.estimation.constants import MISFIT_BAND_COST, QUIET_QUANTILE, SPECTRAL_LINE_RATIO

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Colour:
    """Stationary noise: white of ``white`` plus AR(1) of ``coloured`` standard deviation and coefficient ``phi`` a sample.

    white, coloured: standard deviations [channel unit]; interval: time of one sample step [s].
    """

    white: float
    coloured: float = 0.0
    phi: float = 0.0
    interval: float = 1.0

    @property
    def std(self) -> float:
        """Standard deviation of one sample [channel unit]."""
        return float(np.hypot(self.white, self.coloured))

    @property
    def innovation(self) -> tuple[float, float]:
        """Moving-average coefficient θ and innovation standard deviation of the equivalent ARMA(1, 1)."""
        drive = self.coloured**2 * (1.0 - self.phi**2)
        g0 = drive + self.white**2 * (1.0 + self.phi**2)
        g1 = -self.phi * self.white**2
        # The root inside the unit circle, without the difference that cancels where one part is much weaker than the other.
        root = np.sqrt(max(g0**2 - 4.0 * g1**2, 0.0))
        return float(2.0 * g1 / (g0 + root)), float(np.sqrt(0.5 * (g0 + root)))

    @property
    def effective_fraction(self) -> float:
        """Share of the samples that counts as independent for what varies slowly: variance over spectrum at zero."""
        if self.coloured == 0.0:
            return 1.0
        at_zero = self.white**2 + self.coloured**2 * (1.0 + self.phi) / (1.0 - self.phi)
        return float(min(1.0, self.std**2 / at_zero))

    def spectrum(self, omega: Array) -> Array:
        """Expected periodogram |Σ x e^{-iωk}|²/T at ``omega`` [rad per sample]."""
        shape = (1.0 - self.phi**2) / np.abs(1.0 - self.phi * np.exp(-1j * omega)) ** 2
        return np.asarray(self.white**2 + self.coloured**2 * shape)

    def whiten(self, residual: Array, axis: int = -1) -> Array:
        """Residuals [channel unit], samples along ``axis``, as unit-variance innovations of the same shape."""
        if self.coloured == 0.0 or self.phi == 0.0:
            return np.asarray(residual / self.std)
        theta, sigma = self.innovation
        out = np.asarray(lfilter([1.0, -self.phi], [1.0, theta], residual, axis=axis)) / sigma
        np.moveaxis(out, axis, -1)[..., 0] *= sigma / self.std
        return out

    def louder(self, variance: float) -> Colour:
        """The same noise with so many times its variance."""
        if variance == 1.0:
            return self
        root = float(np.sqrt(variance))
        return Colour(self.white * root, self.coloured * root, self.phi, self.interval)

    def thinned(self, step: int) -> Colour:
        """The same noise after averaging over blocks of ``step`` samples."""
        if step == 1:
            return self
        lags = np.arange(1, step)
        mean_correlation = (step + 2.0 * np.sum((step - lags) * self.phi**lags)) / step**2
        coloured = self.coloured * float(np.sqrt(mean_correlation)) if self.coloured else 0.0
        return Colour(self.white / np.sqrt(step), coloured, self.phi**step, self.interval * step)


def _bands(omega: Array, power: Array, averaged: int, motion: float) -> tuple[Array, Array, Array]:
    """Power and number of bins in bands that widen with frequency, robust against peaks.

    averaged: periodograms behind each bin, whose power is then gamma distributed with that shape.
    motion: angular frequency below which the motion has power; there the quieter bins speak for the noise.
    """
    count = len(omega)
    edges = np.unique(np.round(np.geomspace(1, count + 1, 28)).astype(int)) - 1
    centre, level, bins = [], [], []
    for lo, hi in pairwise(edges):
        chunk = power[lo:hi]
        k = len(chunk)
        centre.append(float(np.mean(omega[lo:hi])))
        part = QUIET_QUANTILE if centre[-1] < motion and k >= 4 else 0.5
        quantile = float(gamma.ppf(part, averaged)) / averaged
        # A sample quantile of one value has the mean of the distribution; of many, its quantile.
        bias = quantile + (1.0 - quantile) / k
        level.append(float(np.quantile(chunk, part)) / bias)
        bins.append(float(k))
    return np.array(centre), np.array(level), np.array(bins)


def periodogram(segments: list[Array]) -> tuple[Array, Array]:
    """Hann-windowed periodograms of several stretches, each cut to the shortest and averaged bin by bin.

    Returns angular frequencies [rad per sample] without zero, and power in units of variance.
    """
    length = min(len(s) for s in segments)
    taper = np.hanning(length + 2)[1:-1]
    norm = float(np.sum(taper**2))
    total = np.zeros(length // 2)
    for s in segments:
        x = (s[:length] - np.mean(s[:length])) * taper
        total += (np.abs(np.fft.rfft(x))[1 : length // 2 + 1] ** 2) / norm
    omega = 2.0 * np.pi * np.arange(1, length // 2 + 1) / length
    return omega, total / len(segments)


def estimate_colour(segments: list[Array], interval: float, motion_band_hz: float, swing_hz: float) -> Colour:
    """Noise behind residual stretches.

    segments: residuals on an even grid [channel unit]; interval: [s] a sample; motion_band_hz: below this frequency the
    motion has power of its own and a misfit may show. swing_hz: no noise remembers longer than the swing lasts: what does is
    misfit (a jump of the reading has the spectrum of noise with endless memory).
    """
    segments = [s for s in segments if len(s) >= 32]
    if not segments:
        raise ValueError("no stretch of residual is long enough to tell the noise from")
    omega, power = periodogram(segments)
    motion = 2.0 * np.pi * motion_band_hz * interval
    centre, level, bins = _bands(omega, power, len(segments), motion)
    bins = bins * len(segments)
    inside = centre < motion
    if inside.sum() > len(centre) - 4:
        inside[-4:] = False
    scale = float(np.median(level[~inside]))
    longest = float(np.exp(-2.0 * np.pi * swing_hz * interval))

    relative, cosine = level / scale, np.cos(centre)

    def loss(x: Sequence[float] | Array, weights: Array | None = None) -> float:
        white, coloured, memory = map(float, x)
        phi = longest / (1.0 + exp(-min(max(memory, -12.0), 9.0)))
        shape = (1.0 - phi**2) / (1.0 + phi**2 - 2.0 * phi * cosine)
        ratio = relative / (exp(min(max(white, -30.0), 30.0)) + exp(min(max(coloured, -30.0), 30.0)) * shape)
        # Whittle: log S + I/S, zero at its best value; bounded where a misfit may stand far above the noise.
        cost = ratio - 1.0 - np.log(ratio)
        cost = np.where(inside & (ratio > 1.0), np.minimum(cost, MISFIT_BAND_COST), cost)
        return float(np.sum((bins if weights is None else weights) * cost))

    white_only = minimize(lambda y: loss((y[0], -40.0, 0.0)), [0.0], method="Nelder-Mead")
    best, best_x = float(white_only.fun), np.array([white_only.x[0], -40.0, 0.0])
    beyond = np.where(inside, 0.0, bins)
    bare = minimize(lambda y: loss((y[0], -40.0, 0.0), beyond), [0.0], method="Nelder-Mead")
    for start in ([-2.0, 0.0, 0.0], [-2.0, 1.0, 3.0], [0.0, 2.0, 4.5], [-4.0, 1.0, 1.5]):
        trial = minimize(loss, start, method="Nelder-Mead", options={"maxiter": 600, "xatol": 1e-3, "fatol": 1e-3})
        if trial.fun < best:
            best, best_x = float(trial.fun), np.asarray(trial.x)
    # Two more parameters must earn their place (difference of twice the log-likelihood is 2·cost), and beyond the motion's
    # band: what shows only inside it is misfit until it is explained.
    if 2.0 * (float(bare.fun) - loss(best_x, beyond)) < 2.0 * np.log(max(np.sum(bins), 2.0)):
        best_x = np.array([white_only.x[0], -60.0, 0.0])
        plain = Colour(float(np.sqrt(np.exp(white_only.x[0]) * scale)), interval=interval)
        size = _scale(omega, power, plain, motion)
        return Colour(plain.white * size, interval=interval)
    phi = float(longest / (1.0 + np.exp(-np.clip(best_x[2], -12, 9))))
    white = float(np.sqrt(np.exp(np.clip(best_x[0], -30, 30)) * scale))
    coloured = float(np.sqrt(np.exp(np.clip(best_x[1], -30, 30)) * scale))
    size = _scale(omega, power, Colour(white, coloured, phi, interval), motion)
    return Colour(white * size, coloured * size, phi, interval)


def _scale(omega: Array, power: Array, colour: Colour, motion: float) -> float:
    """Factor on a noise's standard deviation that sets its mean power right beyond the motion's band (medians are coarse)."""
    ratio = power / colour.spectrum(omega)
    beyond = ratio[(omega >= motion) & (ratio < SPECTRAL_LINE_RATIO)]
    return float(np.sqrt(np.mean(beyond))) if len(beyond) >= 20 else 1.0
