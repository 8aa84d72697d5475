"""The linear oscillator with viscous and dry friction in closed form, phase by phase; dry friction sticks."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from harness.engines.protocol import Array


def oscillate(
    start: tuple[float, float],
    mass: float,
    damping: float,
    stiffness: float,
    force: Array,
    friction: float,
    time: Array,
) -> tuple[Array, Array]:
    """Position and velocity, each (T,), of m x'' + d x' + k x + F_c sign(x') = force.

    start: position and velocity at time[0]. force: (T,), held between samples. friction: F_c; at rest the body is
    held while the force it would take is at most F_c.
    """
    position, velocity = np.empty_like(time), np.empty_like(time)
    x, v = start
    position[0], velocity[0] = x, v
    for k in range(1, time.size):
        left = time[k] - time[k - 1]
        while left > 0.0:
            if v == 0.0 and abs(force[k - 1] - stiffness * x) <= friction:
                break
            sense = np.sign(v) if v != 0.0 else np.sign(force[k - 1] - stiffness * x)
            drive = force[k - 1] - friction * sense
            rest = _first_rest(x, v, mass, damping, stiffness, drive, left) if friction else None
            span = left if rest is None else rest
            x, v = _flow(x, v, mass, damping, stiffness, drive, span)
            if rest is not None:
                v = 0.0
            left -= span
        position[k], velocity[k] = x, v
    return position, velocity


def _flow(x: float, v: float, mass: float, damping: float, stiffness: float, force: float, span: float) -> Array:
    """Exact (x, v) after ``span`` [s] under a constant force, by the exponential of the augmented matrix."""
    matrix = np.array([[0.0, 1.0, 0.0], [-stiffness / mass, -damping / mass, force / mass], [0.0, 0.0, 0.0]])
    return (expm(matrix * span) @ np.array([x, v, 1.0]))[:2]


def _first_rest(
    x: float, v: float, mass: float, damping: float, stiffness: float, force: float, span: float
) -> float | None:
    """When, within ``span`` [s], the velocity next passes through zero; None if it does not."""

    def rate(t: float) -> float:
        return float(_flow(x, v, mass, damping, stiffness, force, t)[1])

    decay = 0.5 * damping / mass
    square = stiffness / mass - decay**2
    acceleration = (force - stiffness * x - damping * v) / mass
    if square > 0.0:
        # v(t) = e^(-σt) (v cos ωt + (a + σ v)/ω sin ωt)
        omega = np.sqrt(square)
        angle = np.arctan2(-v, (acceleration + decay * v) / omega) % np.pi
        when = float((angle if angle > 0.0 else np.pi) / omega)
        return when if when <= span else None
    # Without oscillation the velocity changes sign at most once, and a body starting from rest does not turn back.
    if v == 0.0 or rate(span) * v > 0.0:
        return None
    return float(brentq(rate, 0.0, span, xtol=1e-15, rtol=1e-14))
