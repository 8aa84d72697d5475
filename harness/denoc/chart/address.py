"""Dynamics in positions on their manifold as functions at an address, for ``recursion.dynamics_call``.

Names at module level are all they use: a compiled function that closes over another is never found in the cache again.
"""

from __future__ import annotations

import functools
from typing import Any

from numba import cfunc

from harness.denoc.chart.kernels import (
    add_armature,
    add_products,
    normalise,
    numbers_of,
    places_of,
    position_rates,
    recentre,
    work_begins,
)
from harness.denoc.chart.tables import POSITIONS
from harness.denoc.compiling.compiled import allocating
from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.recursion.binding import COORDINATES, FORWARD, INNER, INVERSE, header_at, rows_of, vector_at
from harness.denoc.recursion.dynamics_call import SIGNATURE, call


@functools.cache
def addresses() -> tuple[int, int]:
    """Addresses of forward and of inverse dynamics, where lowered rates are the velocities themselves."""
    return int(_forward().address), int(_inverse().address)


@functools.cache
def state_addresses() -> tuple[int, int]:
    """Addresses of the positions' rates, and of what makes quaternions unit."""
    return int(_rates().address), int(_settle().address)


@allocating
def _recentred(header: Any, q: int, given: int) -> Any:
    """The chart's integers and floats, the lowered tree's positions once it is recentred at q, and a copy of the vector given."""
    n = header[COORDINATES]
    places = places_of(header)
    numbers = numbers_of(header, places)
    begin = work_begins(places)
    local, copy = numbers[begin : begin + n], numbers[begin + n : begin + 2 * n]
    recentre(rows_of(header_at(header[INNER])), places, numbers, vector_at(q, places[POSITIONS]), local)
    asked = vector_at(given, n)
    for i in range(n):
        copy[i] = asked[i]
    return places, numbers, local, copy


@functools.cache
def _forward() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def forward(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n, inner = header[COORDINATES], header[INNER]
        places, numbers, local, force = _recentred(header, q, tau)
        v = vector_at(qd, n)
        add_armature(places, numbers, v, -1.0, force)
        status = call(header_at(inner)[FORWARD], inner, local.ctypes.data, qd, force.ctypes.data, qdd)
        add_products(places, v, 1.0, vector_at(qdd, n))
        return status

    return forward


@functools.cache
def _inverse() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def inverse(model: int, q: int, qd: int, qdd: int, tau: int) -> int:
        header = header_at(model)
        n, inner = header[COORDINATES], header[INNER]
        places, numbers, local, asked = _recentred(header, q, qdd)
        v = vector_at(qd, n)
        add_products(places, v, -1.0, asked)
        status = call(header_at(inner)[INVERSE], inner, local.ctypes.data, qd, asked.ctypes.data, tau)
        add_armature(places, numbers, v, 1.0, vector_at(tau, n))
        return status

    return inverse


@functools.cache
def _rates() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def rates(model: int, q: int, qd: int, third: int, out: int) -> int:
        header = header_at(model)
        places = places_of(header)
        count = places[POSITIONS]
        position_rates(places, vector_at(q, count), vector_at(qd, header[COORDINATES]), vector_at(out, count))
        return 0

    return rates


@functools.cache
def _settle() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def settle(model: int, q: int, qd: int, third: int, out: int) -> int:
        places = places_of(header_at(model))
        normalise(places, vector_at(q, places[POSITIONS]))
        return 0

    return settle
