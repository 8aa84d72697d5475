"""Time integration for engines that give accelerations only: classical RK4 or adaptive DOP853, forces held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from harness.engines.protocol import Array, EngineError

Acceleration = Callable[[Array, Array, Array], Array]


def march(
    acceleration: Acceleration,
    q0: Array,
    qd0: Array,
    time: Array,
    tau: Array | None,
    step: float | None,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-13,
) -> tuple[Array, Array]:
    """Positions and velocities, each (T, n), sampled at ``time`` [s].

    acceleration: (q, qd, tau) -> qdd. tau: (T, n), held between samples, or None.
    step: largest RK4 step [s]; None integrates adaptively to ``rtol``, ``atol``.
    Raises EngineError where the motion stops being finite.
    """
    n = q0.size

    def slope(y: Array, force: Array) -> Array:
        return np.concatenate([y[n:], acceleration(y[:n], y[n:], force)])

    start, idle = np.concatenate([q0, qd0]), np.zeros(n)
    if step is None:
        states = adaptive(slope, start, time, tau, idle, rtol=rtol, atol=atol)
    else:
        states = _fixed(slope, start, time, tau, idle, step)
    return states[:, :n], states[:, n:]


def adaptive(
    slope: Callable[[Array, Array], Array],
    start: Array,
    time: Array,
    tau: Array | None,
    idle: Array,
    *,
    rtol: float,
    atol: float,
    longest: float = np.inf,
) -> Array:
    """States (T, S) at ``time`` [s] by DOP853 from ``start`` (S,).

    slope: (state, force) -> its rate. tau: forces (T, n), held between samples, or None for ``idle``. longest: step [s].
    Raises EngineError where the motion cannot be followed.
    """
    states = np.empty((time.size, start.size))
    states[0] = start
    for first, last, force in _stretches(time, tau, idle, whole=True):
        solution = solve_ivp(
            lambda _, y, f=force: slope(y, f),
            (time[first], time[last]),
            states[first],
            method="DOP853",
            t_eval=time[first + 1 : last + 1],
            rtol=rtol,
            atol=atol,
            max_step=longest,
        )
        if not solution.success:
            raise EngineError(f"integration stopped at t = {solution.t[-1] if solution.t.size else time[first]} s")
        states[first + 1 : last + 1] = solution.y.T
        _check_finite(states[last], time[last])
    return states


def _fixed(
    slope: Callable[[Array, Array], Array], start: Array, time: Array, tau: Array | None, idle: Array, step: float
) -> Array:
    """The same by classical RK4 with steps of at most ``step`` [s]."""
    states = np.empty((time.size, start.size))
    states[0] = state = start
    for first, last, force in _stretches(time, tau, idle, whole=False):
        span = time[last] - time[first]
        # A hair of slack, so that a sample spacing equal to the step is one step in spite of rounding.
        count = max(1, int(np.ceil(span / step * (1.0 - 1e-9))))
        h = span / count
        for _ in range(count):
            a = slope(state, force)
            b = slope(state + 0.5 * h * a, force)
            c = slope(state + 0.5 * h * b, force)
            d = slope(state + h * c, force)
            state = state + h / 6.0 * (a + 2.0 * (b + c) + d)
        states[last] = state
        _check_finite(state, time[last])
    return states


def _check_finite(state: Array, time: float) -> None:
    if not np.all(np.isfinite(state)):
        raise EngineError(f"the motion is not finite any more before t = {time} s: use a smaller step")


def _stretches(time: Array, tau: Array | None, idle: Array, *, whole: bool) -> list[tuple[int, int, Array]]:
    """Runs of samples (first, last, force) over which the force is constant; single intervals unless ``whole``."""
    stretches: list[tuple[int, int, Array]] = []
    first = 0
    for k in range(1, time.size):
        force = idle if tau is None else tau[first]
        if not whole or k == time.size - 1 or (tau is not None and not np.array_equal(tau[k], force)):
            stretches.append((first, k, force))
            first = k
    return stretches
