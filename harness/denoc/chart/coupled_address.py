"""Dynamics where joints follow others (mimics, helical joints): the lowered tree's, reduced to what is independent.

With lowered rates G v, the equations of motion are Gᵀ M G v̇ + Gᵀ (bias of the lowered tree) = Gᵀ τ (natural orthogonal
complement of the coupling; G is constant, so that its rate adds nothing). Forces are given for the independent velocities.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numba import cfunc

from harness.denoc.chart.kernels import (
    add_armature,
    add_products,
    numbers_of,
    places_of,
    recentre,
    work_begins,
)
from harness.denoc.chart.tables import LOWERED, POSITIONS
from harness.denoc.compiling.compiled import allocating, internal
from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.recursion.binding import (
    BODIES,
    COORDINATES,
    INNER,
    INVERSE,
    header_at,
    matrix_at,
    rows_of,
    topology_of,
    vector_at,
)
from harness.denoc.recursion.dynamics_call import SIGNATURE, call
from harness.denoc.recursion.rigid_mass import mass_matrix


@functools.cache
def addresses() -> tuple[int, int]:
    """Addresses of forward and of inverse dynamics."""
    return int(_forward().address), int(_inverse().address)


@internal
def spread(rates: Any, v: Any, out: Any) -> None:
    """Lowered rates G v."""
    for i in range(len(out)):
        value = 0.0
        for k in range(len(v)):
            value += rates[i, k] * v[k]
        out[i] = value


@internal
def gather(rates: Any, force: Any, out: Any) -> None:
    """Independent forces Gᵀ f."""
    for k in range(len(out)):
        value = 0.0
        for i in range(len(force)):
            value += rates[i, k] * force[i]
        out[k] = value


@internal
def cholesky_solve(a: Any, b: Any) -> int:
    """Solve a x = b for symmetric positive definite a, in place in b; 0, or one more than the coordinate without inertia."""
    n = len(b)
    for j in range(n):
        pivot = a[j, j]
        for k in range(j):
            pivot -= a[j, k] * a[j, k]
        if not pivot > 0.0:
            return j + 1
        pivot = np.sqrt(pivot)
        a[j, j] = pivot
        for i in range(j + 1, n):
            value = a[i, j]
            for k in range(j):
                value -= a[i, k] * a[j, k]
            a[i, j] = value / pivot
    for i in range(n):
        value = b[i]
        for k in range(i):
            value -= a[i, k] * b[k]
        b[i] = value / a[i, i]
    for i in range(n - 1, -1, -1):
        value = b[i]
        for k in range(i + 1, n):
            value -= a[k, i] * b[k]
        b[i] = value / a[i, i]
    return 0


@allocating
def _lowered(header: Any, q: int, qd: int) -> Any:
    """The chart's integers and floats, G, the lowered tree's positions recentred at q, its rates G v, and room for two more."""
    n = header[COORDINATES]
    places = places_of(header)
    m = places[LOWERED]
    numbers = numbers_of(header, places)
    begin = work_begins(places)
    local, rate = numbers[begin : begin + m], numbers[begin + m : begin + 2 * m]
    asked, found = numbers[begin + 2 * m : begin + 3 * m], numbers[begin + 3 * m : begin + 4 * m]
    rates = matrix_at(numbers.ctypes.data + 8 * (begin - m * n), m, n)
    recentre(rows_of(header_at(header[INNER])), places, numbers, vector_at(q, places[POSITIONS]), local)
    spread(rates, vector_at(qd, n), rate)
    return places, numbers, rates, local, rate, asked, found


@internal
def _independent_forces(
    header: Any, places: Any, numbers: Any, rates: Any, local: Any, rate: Any, asked: Any, found: Any, out: Any
) -> int:
    """Forces Gᵀ f of the lowered tree under the accelerations asked; what is asked and found is lowered, and overwritten."""
    inner = header[INNER]
    add_products(places, rate, -1.0, asked)
    status = call(
        header_at(inner)[INVERSE], inner, local.ctypes.data, rate.ctypes.data, asked.ctypes.data, found.ctypes.data
    )
    add_armature(places, numbers, rate, 1.0, found)
    gather(rates, found, out)
    return status


@functools.cache
def _forward() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def forward(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        places, numbers, rates, local, rate, asked, bias = _lowered(header, q, qd)
        m = places[LOWERED]
        begin = work_begins(places) + 6 * m + 4 * n
        base = numbers.ctypes.data
        whole = matrix_at(base + 8 * begin, m, m)
        small = matrix_at(base + 8 * (begin + m * m), n, n)
        half = matrix_at(base + 8 * (begin + m * m + n * n), m, n)
        applied, out = vector_at(tau, n), vector_at(qdd, n)
        inner = header_at(header[INNER])
        mass_matrix(inner[BODIES], rows_of(inner), topology_of(inner), local, whole)
        for i in range(m):
            asked[i] = 0.0
        status = _independent_forces(header, places, numbers, rates, local, rate, asked, bias, out)
        if status != 0:
            return status
        for k in range(n):
            out[k] = applied[k] - out[k]
            for i in range(m):
                value = 0.0
                for j in range(m):
                    value += whole[i, j] * rates[j, k]
                half[i, k] = value
        for k in range(n):
            for l in range(n):
                value = 0.0
                for i in range(m):
                    value += rates[i, k] * half[i, l]
                small[k, l] = value
        singular = cholesky_solve(small, out)
        if singular == 0:
            return 0
        # The row of a body that the coordinate moves.
        for i in range(m):
            if rates[i, singular - 1] != 0.0:
                return i + 1
        return singular

    return forward


@functools.cache
def _inverse() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def inverse(model: int, q: int, qd: int, qdd: int, tau: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        places, numbers, rates, local, rate, asked, needed = _lowered(header, q, qd)
        spread(rates, vector_at(qdd, n), asked)
        return _independent_forces(header, places, numbers, rates, local, rate, asked, needed, vector_at(tau, n))

    return inverse
