"""Bending frequencies of a uniform strip on a hub that turns freely, or clamped, from its characteristic equation."""

from __future__ import annotations

import numpy as np

from harness.system.description import Array


def strip_frequencies(
    bending_stiffness: float,
    mass: float,
    length: float,
    *,
    hub_inertia: float = 0.0,
    payload: float = 0.0,
    clamped: bool = False,
    count: int = 1,
) -> Array:
    """The lowest bending frequencies [Hz] of an Euler-Bernoulli beam, without gravity, shape (count,).

    bending_stiffness: EI [N·m²]; mass: of the beam [kg]; length [m]. At the root the deflection is zero and the hub
    turns against its inertia [kg·m²], EI w″ = -ω² I_h w′ (or w′ = 0 if clamped); at the tip w″ = 0 and
    EI w‴ = -ω² m_p w with the payload m_p [kg].
    Source: L. Meirovitch, Fundamentals of Vibrations, 2001, ch. 8 (separation of variables, boundary conditions).
    """
    from scipy.optimize import brentq  # a third of a second, which only audits need

    hub = hub_inertia / (mass * length**2)
    tip = payload / mass

    def determinant(x: Array) -> Array:
        # w = A sin + B sinh + C (cos - cosh) of x ξ; w(0) = 0 holds. Rows: root, tip moment, tip shear. Columns with
        # sinh and cosh are divided by cosh x, which moves no root and keeps high modes finite.
        s, c, sh, ch = np.sin(x), np.cos(x), np.tanh(x), np.ones_like(x)
        one = 1.0 / np.cosh(x)
        if clamped:
            r1, r2, r3 = np.ones_like(x), one, np.zeros_like(x)
        else:
            # -2 x² C = -x⁴ h (x A + x B), divided by x².
            r1, r2, r3 = hub * x**3, hub * x**3 * one, -2.0 * np.ones_like(x)
        # The column of C mixes both kinds; scaled by 1 / cosh x as well.
        m1, m2, m3 = -s, sh, -(c * one + ch)
        v1, v2, v3 = (
            -c + tip * x * s,
            ch + tip * x * sh,
            (s * one - sh) + tip * x * (c * one - ch),
        )
        r3 = r3 * one
        return np.asarray(r1 * (m2 * v3 - m3 * v2) - r2 * (m1 * v3 - m3 * v1) + r3 * (m1 * v2 - m2 * v1))

    def value(x: float) -> float:
        return float(determinant(np.array([x]))[0])

    # Roots of any such strip lie about π apart; a pinned strip's rigid turn is the root at zero, left out.
    grid = np.geomspace(0.02, 1.0, 60)
    grid = np.concatenate([grid, np.arange(1.02, np.pi * (count + 1) + 1.0, 0.02)])
    values = determinant(grid)
    changes = np.nonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)[0][:count]
    roots = np.array([brentq(value, grid[k], grid[k + 1], xtol=1e-13) for k in changes])
    density = mass / length
    return np.asarray(roots**2 / (2.0 * np.pi * length**2) * np.sqrt(bending_stiffness / density))
