"""The physical pendulum in closed form: Jacobi's elliptic functions, any amplitude, swinging over included.

Source: P. F. Byrd and M. D. Friedman, Handbook of Elliptic Integrals (1971); DLMF §22.19(i).
"""

from __future__ import annotations

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

from harness.engines.protocol import Array


def swing(angle: float, rate: float, small: float, time: Array) -> tuple[Array, Array]:
    """Angle from the lower equilibrium [rad] and its rate [rad/s], each shape (T,), of φ'' = -ω² sin φ.

    angle, rate: at time[0]. small: ω, circular frequency of small swings [rad/s]. time: [s], shape (T,).
    """
    turns = np.round(angle / (2.0 * np.pi))
    start = angle - 2.0 * np.pi * turns
    since = time - time[0]
    # k sn(u) = sin(φ/2) and k cn(u) = φ'/2ω: taken together they keep a release from rest exact.
    sine, cosine = np.sin(0.5 * start), 0.5 * rate / small
    modulus = float(np.hypot(sine, cosine))
    if modulus == 0.0:
        return np.full_like(since, angle), np.zeros_like(since)
    if modulus <= 1.0:
        m = modulus**2
        phase = ellipkinc(np.arctan2(sine, cosine), m) + small * since
        sn, cn, dn, _ = ellipj(phase, m)
        half = np.arctan2(modulus * sn, dn)
        return 2.0 * (half + np.pi * turns), 2.0 * modulus * small * cn
    # Swinging over: the half angle is the amplitude function itself.
    m = 1.0 / modulus**2
    sense = np.sign(rate)
    phase = ellipkinc(0.5 * sense * start, m) + modulus * small * since
    # Whole turns are taken out first, because ellipj gives the amplitude without loss only near zero.
    quarter = ellipk(m)
    half_turns = np.round(phase / (2.0 * quarter))
    sn, cn, dn, _ = ellipj(phase - 2.0 * quarter * half_turns, m)
    half = sense * (np.arctan2(sn, cn) + np.pi * half_turns)
    return 2.0 * (half + np.pi * turns), 2.0 * modulus * small * sense * dn


def period(amplitude: float, small: float) -> float:
    """Period [s] of a swing released at rest from ``amplitude`` [rad], |amplitude| < π: T = 4 K(sin²(A/2)) / ω."""
    return 4.0 * float(ellipk(np.sin(0.5 * amplitude) ** 2)) / small
