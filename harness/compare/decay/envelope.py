"""Dry, viscous and quadratic damping from the amplitudes of the half-swings alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from harness.compare.decay.oscillator import LAWS, Array, amplitudes
from harness.compare.decay.swings import HalfSwings


@dataclass(frozen=True, eq=False)
class Envelope:
    """Coefficients (3,) of ``LAWS`` over the inertia with standard uncertainties, and the amplitudes they give (k,)."""

    coefficients: Array
    std: Array
    amplitude: Array
    rms: float


def envelope(found: HalfSwings, laws: tuple[str, ...] = LAWS) -> Envelope:
    """The coefficients whose losses give the amplitudes, none of them negative; laws: which are free, the others zero."""
    circular = 2.0 * np.pi * found.small
    free = np.array([law in laws for law in LAWS])
    count, first = len(found.amplitude), float(found.amplitude[0])
    loss = 1.0 - float(found.amplitude[-1]) / first
    # What each law alone would need for the whole loss.
    scale = np.array([2.0, first * circular, 1.0 / first]) * loss * circular / (np.pi * count)

    def model(x: Array) -> Array:
        coefficients = np.zeros(3)
        coefficients[free] = x[1:] * scale[free]
        return amplitudes(first * float(x[0]), count, coefficients, circular, sine=found.sine)

    def miss(x: Array) -> Array:
        return (model(x) - found.amplitude) / first

    if not free.any():
        return Envelope(np.zeros(3), np.zeros(3), np.full(count, first), float(np.std(found.amplitude)))
    start = np.append(1.0, np.full(int(free.sum()), 1.0 / free.sum()))
    lower = np.append(0.5, np.zeros(int(free.sum())))
    fit = least_squares(miss, start, bounds=(lower, np.inf), x_scale=0.1, diff_step=1e-5)
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac) * 2.0 * fit.cost / max(1, count - len(start))
    coefficients, std = np.zeros(3), np.zeros(3)
    coefficients[free] = fit.x[1:] * scale[free]
    # A pseudo-inverse of what is nearly singular can end a rounding below zero.
    std[free] = np.sqrt(np.maximum(np.diagonal(covariance)[1:], 0.0)) * scale[free]
    rms = float(first * np.sqrt(2.0 * fit.cost / count))
    return Envelope(coefficients, std, model(fit.x), rms)
