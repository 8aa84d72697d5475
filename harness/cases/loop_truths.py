"""Closed forms of closed mechanisms, derived without loops: one or two coordinates and their Lagrangian."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from harness.cases.case import Array

GRAVITY = 9.81


def four_bars_angle(windows: int, speed: float, time: Array) -> Array:
    """Angle [rad] that the cranks of ``four_bars`` have turned clockwise from upright, begun there with ``speed`` [rad/s].

    Bars stay level: a pendulum of inertia (N+1)/3 + N and moment of weight g ((N+1)/2 + N), which goes right round. From the bottom
    φ = 2 am(ω_b t/2, k), k² = 4 W / (I ω_b²), ω_b² = ω² + 4 W/I.
    """
    inertia = (windows + 1) / 3.0 + windows
    weight = GRAVITY * ((windows + 1) / 2.0 + windows)
    fastest = np.sqrt(speed**2 + 4.0 * weight / inertia)
    square = 4.0 * weight / (inertia * fastest**2)
    amplitude: Array = ellipj(0.5 * fastest * time - ellipk(square), square)[3]
    return np.pi + 2.0 * amplitude


def single(
    inertia: Callable[[complex], complex],
    potential: Callable[[complex], complex],
    start: tuple[float, float],
    time: Array,
) -> Array:
    """Coordinate x(t) of T = I(x) ẋ²/2 and V(x): ẍ = −(I' ẋ²/2 + V') / I; derivatives by complex steps, which lose no digits."""
    tiny = 1e-30

    def slope(f: Callable[[complex], complex], x: float) -> float:
        return complex(f(x + 1j * tiny)).imag / tiny

    def rates(_: float, y: Array) -> list[float]:
        x, v = y
        return [v, -(0.5 * slope(inertia, x) * v * v + slope(potential, x)) / complex(inertia(x)).real]

    run = solve_ivp(rates, (time[0], time[-1]), start, "DOP853", t_eval=time, rtol=1e-13, atol=1e-14)
    found: Array = run.y[0]
    return found


def slider_crank_angle(start: tuple[float, float], time: Array, crank: float = 0.1, rod: float = 0.3) -> Array:
    """Crank angle [rad] of ``loop_mechanisms.slider_crank`` from (angle, speed): the rod's angle is −asin(r sin θ / l)."""
    m1, m2, m3 = 0.2, 0.5, 0.3

    def inertia(x: complex) -> complex:
        s, c = np.sin(x), np.cos(x)
        tilt = np.sqrt(rod**2 - (crank * s) ** 2)
        turn = -crank * c / tilt  # dφ/dθ
        # dx/dθ of the slider, and of the rod's middle; sin φ = −r sin θ / l, cos φ = tilt / l.
        slide = -crank * s + crank * s * turn
        middle = -crank * s + 0.5 * crank * s * turn, 0.5 * crank * c
        total = m1 * crank**2 / 3.0 + m2 * (middle[0] ** 2 + middle[1] ** 2) + m2 * rod**2 / 12.0 * turn**2
        return complex(total + m3 * slide**2)

    def potential(x: complex) -> complex:
        # Middles of both rods are at half the crank pin's height.
        return complex(GRAVITY * (m1 + m2) * 0.5 * crank * np.sin(x))

    return single(inertia, potential, start, time)


# The governor of ``loop_mechanisms.governor``: spindle and sleeve about the axis, balls, sleeve, and turning of arms and links.
_ABOUT_AXIS, _BALL, _SLEEVE, _TURNING, _ARM = 3e-3, 0.26, 0.4, 2.2e-4, 0.3


def governor_speed(angle: float) -> float:
    """Steady speed [rad/s] at which the arms hang ``angle`` [rad] below the horizontal: ω² = g (M + m) / (m l sin β)."""
    return float(np.sqrt(GRAVITY * (_SLEEVE + _BALL) / (_BALL * _ARM * np.sin(angle))))


def governor_motion(start: tuple[float, float, float, float], time: Array) -> Array:
    """Spindle angle and arms' angle β below the horizontal, (T, 2), from (ψ, β, ψ̇, β̇).

    T = ½ (I + 2 m l² cos²β + J) ψ̇² + ½ (2 m l² + 4 M l² cos²β + J) β̇², V = −2 g l sin β (M + m), J of arms and links together.
    """
    turning = _TURNING

    def rates(_: float, y: Array) -> list[float]:
        _, beta, spin, speed = y
        s, c = np.sin(beta), np.cos(beta)
        about = _ABOUT_AXIS + 2.0 * _BALL * _ARM**2 * c**2 + turning
        along = 2.0 * _BALL * _ARM**2 + 4.0 * _SLEEVE * _ARM**2 * c**2 + turning
        spun = 4.0 * _BALL * _ARM**2 * c * s * speed * spin / about
        pull = -2.0 * _BALL * _ARM**2 * c * s * spin**2 + 4.0 * _SLEEVE * _ARM**2 * c * s * speed**2
        pull += 2.0 * GRAVITY * _ARM * c * (_SLEEVE + _BALL)
        return [spin, speed, spun, pull / along]

    run = solve_ivp(rates, (time[0], time[-1]), start, "DOP853", t_eval=time, rtol=1e-13, atol=1e-14)
    found: Array = run.y[:2].T
    return found
