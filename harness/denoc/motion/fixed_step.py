"""Integrators with a fixed step: explicit Runge-Kutta 4, and Gauss-Legendre 6 for modes that are stiff.

Both step through the sampling intervals, each cut into equal steps no longer than the one asked for; forces are held
from one sample to the next, or run linearly.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.compiling.compiled import allocating, internal, stepper
from harness.denoc.recursion.binding import RATES, SETTLE, header_at
from harness.denoc.recursion.dynamics_call import call

Vector = Any
Matrix = Any

#: What the integrators return besides 0 and the row of a body without inertia.
DIVERGED = -3


@internal
def force_at(tau: Matrix, linear: bool, k: int, share: float, out: Vector) -> None:
    """Forces within sampling interval k, at ``share`` of it."""
    if len(tau) == 0:
        return
    for i in range(len(out)):
        out[i] = tau[k, i] + share * (tau[k + 1, i] - tau[k, i]) if linear else tau[k, i]


@internal
def copy_from(source: Vector, first: int, out: Vector) -> None:
    """Numbers of ``source`` from ``first`` on, to ``out``: an assignment of slices brings a second of compiling with it."""
    for i in range(len(out)):
        out[i] = source[first + i]


@stepper
def runge_kutta4(
    function: int,
    model: int,
    time: Vector,
    step: float,
    tau: Matrix,
    linear: bool,
    position: Matrix,
    velocity: Matrix,
) -> int:
    """Classical fourth order; position[0], velocity[0] hold the initial state."""
    nq, n = position.shape[1], velocity.shape[1]
    work = np.zeros((10, max(nq, n)))
    q, q1, dq, rate = work[0, :nq], work[1, :nq], work[2, :nq], work[3, :nq]
    v, v1, dv, a, force = work[4, :n], work[5, :n], work[6, :n], work[7, :n], work[8, :n]
    rates, settle = header_at(model)[RATES], header_at(model)[SETTLE]
    copy_from(position[0], 0, q)
    copy_from(velocity[0], 0, v)
    for k in range(len(time) - 1):
        steps = max(1, int(np.ceil((time[k + 1] - time[k]) / step * (1.0 - 1e-12))))
        h = (time[k + 1] - time[k]) / steps
        for s in range(steps):
            for i in range(nq):
                q1[i], dq[i] = q[i], 0.0
            for i in range(n):
                v1[i], dv[i] = v[i], 0.0
            for stage in range(4):
                c = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
                weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
                # Of the next stage; the last one's is not used.
                ahead = h if stage == 2 else 0.5 * h
                force_at(tau, linear, k, (s + c) / steps, force)
                status = call(function, model, q1.ctypes.data, v1.ctypes.data, force.ctypes.data, a.ctypes.data)
                if status != 0:
                    return status
                if rates == 0:
                    copy_from(v1, 0, rate)
                else:
                    call(rates, model, q1.ctypes.data, v1.ctypes.data, 0, rate.ctypes.data)
                for i in range(nq):
                    dq[i] += weight * rate[i]
                    q1[i] = q[i] + ahead * rate[i]
                for i in range(n):
                    change = a[i]
                    dv[i] += weight * change
                    v1[i] = v[i] + ahead * change
            for i in range(nq):
                q[i] += dq[i]
            for i in range(n):
                v[i] += dv[i]
            if settle != 0:
                status = call(settle, model, q.ctypes.data, v.ctypes.data, 0, 0)
                if status != 0:
                    return status
        for i in range(nq):
            if not np.isfinite(q[i]):
                return DIVERGED
            position[k + 1, i] = q[i]
        for i in range(n):
            if not np.isfinite(v[i]):
                return DIVERGED
            velocity[k + 1, i] = v[i]
    return 0


_ROOT = np.sqrt(15.0)
GAUSS_C = np.array([0.5 - _ROOT / 10.0, 0.5, 0.5 + _ROOT / 10.0])
GAUSS_A = np.array(
    [
        [5.0 / 36.0, 2.0 / 9.0 - _ROOT / 15.0, 5.0 / 36.0 - _ROOT / 30.0],
        [5.0 / 36.0 + _ROOT / 24.0, 2.0 / 9.0, 5.0 / 36.0 - _ROOT / 24.0],
        [5.0 / 36.0 + _ROOT / 30.0, 2.0 / 9.0 + _ROOT / 15.0, 5.0 / 36.0],
    ]
)
GAUSS_SQUARED = GAUSS_A @ GAUSS_A
GAUSS_B = np.array([5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0])
_STAGES = 3
_SWEEPS = 40
_CLOSE = 1e-13
# Sweeps beyond which a fresh factorization pays.
_SLOW = 9


@stepper
def gauss_legendre6(
    function: int,
    model: int,
    time: Vector,
    step: float,
    tau: Matrix,
    linear: bool,
    probe: Matrix,
    stiffness: Matrix,
    damping: Matrix,
    position: Matrix,
    velocity: Matrix,
) -> int:
    """Three-stage Gauss collocation: order 6, symplectic, stable for every frequency.

    The stages are solved by simplified Newton sweeps whose Jacobian holds what is stiff, the linear ``stiffness`` and
    ``damping`` (n, n) behind the mass matrix, which is found from the dynamics by unit forces (``probe``, zeros (n, n))
    whenever sweeps get slow. position[0], velocity[0] hold the initial state.
    """
    n = position.shape[1]
    size = _STAGES * n
    work = np.zeros((4, n))
    q, v, force, rest = work[0], work[1], work[2], work[3]
    qs, vs = np.zeros((_STAGES, n)), np.zeros((_STAGES, n))
    a, found = np.zeros((_STAGES, n)), np.zeros((_STAGES, n))
    jacobian = np.zeros((size, size))
    pivots = np.zeros(size, dtype=np.int64)
    change = np.zeros(size)
    guess = np.zeros((_STAGES, _STAGES))
    copy_from(position[0], 0, q)
    copy_from(velocity[0], 0, v)
    factored = 0.0
    previous = 0.0
    fresh = True
    for k in range(len(time) - 1):
        steps = max(1, int(np.ceil((time[k + 1] - time[k]) / step * (1.0 - 1e-12))))
        h = (time[k + 1] - time[k]) / steps
        for s in range(steps):
            # First guess: the collocation polynomial of the last step, continued.
            if previous > 0.0:
                _continuation(h / previous, guess)
                for i in range(n):
                    a0, a1, a2 = a[0, i], a[1, i], a[2, i]
                    for r in range(_STAGES):
                        a[r, i] = guess[r, 0] * a0 + guess[r, 1] * a1 + guess[r, 2] * a2
            else:
                force_at(tau, linear, k, 0.0, force)
                status = call(function, model, q.ctypes.data, v.ctypes.data, force.ctypes.data, rest.ctypes.data)
                if status != 0:
                    return status
                for r in range(_STAGES):
                    copy_from(rest, 0, a[r])
            attempts = 0
            while True:
                if fresh or factored != h:
                    status = _factor(function, model, h, q, probe, stiffness, damping, jacobian, pivots)
                    if status != 0:
                        return status
                    factored = h
                    fresh = False
                    attempts += 1
                last = np.inf
                converged = False
                for sweep in range(_SWEEPS):
                    for r in range(_STAGES):
                        for i in range(n):
                            x, y = 0.0, 0.0
                            for c in range(_STAGES):
                                x += GAUSS_SQUARED[r, c] * a[c, i]
                                y += GAUSS_A[r, c] * a[c, i]
                            qs[r, i] = q[i] + h * GAUSS_C[r] * v[i] + h * h * x
                            vs[r, i] = v[i] + h * y
                        force_at(tau, linear, k, (s + GAUSS_C[r]) / steps, force)
                        status = call(
                            function,
                            model,
                            qs[r].ctypes.data,
                            vs[r].ctypes.data,
                            force.ctypes.data,
                            found[r].ctypes.data,
                        )
                        if status != 0:
                            return status
                        for i in range(n):
                            change[r * n + i] = found[r, i] - a[r, i]
                    _solve(jacobian, pivots, change)
                    size_of_change, scale = 0.0, 1e-30
                    for r in range(_STAGES):
                        for i in range(n):
                            a[r, i] += change[r * n + i]
                            # Measured as what it does to the velocity.
                            size_of_change = max(size_of_change, abs(change[r * n + i]) * h)
                            scale = max(scale, abs(a[r, i]) * h, abs(v[i]))
                    if not np.isfinite(size_of_change):
                        break
                    # At the level of rounding it no longer falls.
                    if size_of_change <= _CLOSE * scale or (
                        size_of_change <= 1e-9 * scale and size_of_change > 0.5 * last
                    ):
                        converged = True
                        fresh = sweep >= _SLOW
                        break
                    last = size_of_change
                if converged:
                    break
                if attempts > 0:
                    return DIVERGED
                # The factorization was of another configuration: once more, with this one's.
                fresh = True
                force_at(tau, linear, k, s / steps, force)
                status = call(function, model, q.ctypes.data, v.ctypes.data, force.ctypes.data, rest.ctypes.data)
                for r in range(_STAGES):
                    copy_from(rest, 0, a[r])
            for i in range(n):
                x, y = 0.0, 0.0
                for c in range(_STAGES):
                    y += GAUSS_B[c] * a[c, i]
                    # b A as weights of the acceleration in the position.
                    x += GAUSS_B[c] * (1.0 - GAUSS_C[c]) * a[c, i]
                q[i] += h * v[i] + h * h * x
                v[i] += h * y
            previous = h
        for i in range(n):
            if not np.isfinite(q[i]) or not np.isfinite(v[i]):
                return DIVERGED
            position[k + 1, i], velocity[k + 1, i] = q[i], v[i]
    return 0


@internal
def _continuation(ratio: float, guess: Matrix) -> None:
    """Lagrange weights that carry stage values over to the next step's stages, ``ratio`` the quotient of the steps."""
    for r in range(_STAGES):
        x = 1.0 + ratio * GAUSS_C[r]
        for c in range(_STAGES):
            value = 1.0
            for o in range(_STAGES):
                if o != c:
                    value *= (x - GAUSS_C[o]) / (GAUSS_C[c] - GAUSS_C[o])
            guess[r, c] = value


@allocating
def _factor(
    function: int,
    model: int,
    h: float,
    q: Vector,
    probe: Matrix,
    stiffness: Matrix,
    damping: Matrix,
    jacobian: Matrix,
    pivots: Vector,
) -> int:
    """LU factors of I + h² A² ⊗ M⁻¹K + h A ⊗ M⁻¹C at configuration q."""
    n = len(q)
    zero, unit, rest = np.zeros(n), np.zeros(n), np.zeros(n)
    status = call(function, model, q.ctypes.data, zero.ctypes.data, zero.ctypes.data, rest.ctypes.data)
    if status != 0:
        return status
    for i in range(n):
        unit[i] = 1.0
        status = call(function, model, q.ctypes.data, zero.ctypes.data, unit.ctypes.data, probe[i].ctypes.data)
        if status != 0:
            return status
        for j in range(n):
            probe[i, j] -= rest[j]
        unit[i] = 0.0
    # The inverse mass matrix is symmetric: rows serve as columns.
    soft, lossy = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for k in range(n):
            share = probe[i, k]
            for j in range(n):
                soft[i, j] += share * stiffness[k, j]
                lossy[i, j] += share * damping[k, j]
    for r in range(_STAGES):
        for c in range(_STAGES):
            for i in range(n):
                for j in range(n):
                    value = h * h * GAUSS_SQUARED[r, c] * soft[i, j] + h * GAUSS_A[r, c] * lossy[i, j]
                    if r == c and i == j:
                        value += 1.0
                    jacobian[r * n + i, c * n + j] = value
    _decompose(jacobian, pivots)
    return 0


@internal
def _decompose(a: Matrix, pivots: Vector) -> None:
    """LU with row exchanges, in place."""
    n = len(a)
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, n):
            if a[i, k] != 0.0:
                a[i, k] *= inverse
                factor = a[i, k]
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]


@internal
def _solve(a: Matrix, pivots: Vector, x: Vector) -> None:
    """Solve with the factors of ``_decompose``, in place."""
    n = len(a)
    for k in range(n):
        best = pivots[k]
        if best != k:
            x[k], x[best] = x[best], x[k]
    for i in range(n):
        value = x[i]
        for j in range(i):
            value -= a[i, j] * x[j]
        x[i] = value
    for i in range(n - 1, -1, -1):
        value = x[i]
        for j in range(i + 1, n):
            value -= a[i, j] * x[j]
        x[i] = value / a[i, i]
