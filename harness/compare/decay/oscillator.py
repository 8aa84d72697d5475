"""What one half-swing of an oscillator costs, by each law of damping; unit inertia.

q'' + ω² sin q (or ω² q) + viscous q' + dry sign(q') + quadratic q' |q'| = 0, coefficients over the inertia: 1/s, rad/s²,
1/rad. Losses are those of the undamped half-swing of the same amplitude, exact to first order in the damping.
Source: L. D. Landau and E. M. Lifshitz, Mechanics, §11 and §49; R. A. Nelson and M. G. Olsson, Am. J. Phys. 54 (1986) 112.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipe, ellipk

Array = NDArray[np.float64]

LAWS = ("viscous", "dry", "quadratic")
#: Units of the coefficients over the inertia, and of the coefficients themselves at a revolute joint.
UNITS = {"viscous": "1/s", "dry": "rad/s²", "quadratic": "1/rad"}
TORQUE_UNITS = {"viscous": "N·m·s/rad", "dry": "N·m", "quadratic": "N·m·s²/rad²"}


def energy(amplitude: Array, circular: float, *, sine: bool) -> Array:
    """Energy at a turning point over the inertia [rad²/s²]; circular: ω of small swings [rad/s]."""
    if sine:
        return np.asarray(circular**2 * (1.0 - np.cos(amplitude)))
    return np.asarray(0.5 * circular**2 * amplitude**2)


def losses(amplitude: Array, circular: float, *, sine: bool) -> Array:
    """Energy that a half-swing of each amplitude (k,) loses by a unit coefficient of each of ``LAWS``, shape (3, k)."""
    if sine:
        m = np.sin(0.5 * amplitude) ** 2
        # ∫ q' dq over a half-swing, a quarter of a libration's action twice over.
        action = 8.0 * circular * (ellipe(m) - (1.0 - m) * ellipk(m))
        # ∫ q'² dq with q'² = 2 ω² (cos q − cos A)
        square = 4.0 * circular**2 * (np.sin(amplitude) - amplitude * np.cos(amplitude))
    else:
        action = 0.5 * np.pi * circular * amplitude**2
        square = 4.0 / 3.0 * circular**2 * amplitude**3
    return np.array([action, 2.0 * amplitude, square])


def period_ratio(amplitude: Array, *, sine: bool) -> Array:
    """Period of a swing of the amplitude over that of a vanishing one."""
    if not sine:
        return np.ones_like(amplitude)
    return np.asarray(2.0 / np.pi * ellipk(np.sin(0.5 * amplitude) ** 2))


def amplitudes(first: float, count: int, coefficients: Array, circular: float, *, sine: bool) -> Array:
    """Amplitudes (count,) of successive half-swings, the first given; coefficients (3,) of ``LAWS`` over the inertia.

    Between the turning points A and A' the energy falls by the mean of the losses at both; where nothing is left it rests.
    """
    grid = np.linspace(0.0, first, 2001)
    lost = coefficients @ losses(grid, circular, sine=sine)
    held = energy(grid, circular, sine=sine)
    after, before = held + 0.5 * lost, held - 0.5 * lost
    out = np.empty(count)
    amplitude = first
    for k in range(count):
        out[k] = amplitude
        left = float(np.interp(amplitude, grid, before))
        amplitude = float(np.interp(left, after, grid)) if left > 0.0 else 0.0
    return out
