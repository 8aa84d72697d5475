"""The dynamics of rigid mechanisms as functions at an address, for ``dynamics_call``.

Names at module level are all they use: a compiled function that closes over another is never found in the cache again.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numba import cfunc

from harness.denoc.compiling.compiled import compiled
from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.recursion.binding import (
    BARE,
    BODIES,
    CHAIN,
    COORDINATES,
    NOT_FINITE,
    NOT_PLAIN,
    RECURSION,
    header_at,
    matrix_of,
    rows_of,
    topology_of,
    vector_at,
    vector_data,
)
from harness.denoc.recursion.dynamics_call import SIGNATURE, call
from harness.denoc.recursion.rigid import forward_dynamics, inverse_dynamics, subtract_passive
from harness.denoc.recursion.rigid_chain import SIZE as CHAIN_SIZE
from harness.denoc.recursion.rigid_chain import forward_dynamics as chain_dynamics
from harness.denoc.recursion.rigid_mass import mass_matrix


@functools.cache
def addresses() -> tuple[int, int]:
    """Addresses of forward and of inverse dynamics."""
    return int(_forward().address), int(_inverse().address)


@functools.cache
def chain_address() -> int:
    """Address of the forward dynamics of a short chain, whose table stands at the header's CHAIN."""
    addresses()
    return int(_chain().address)


@compiled
def mass_entry(model: int, q: Any, mass: Any) -> int:
    """Generalized inertia matrix for ``binding.entry``; mass: an array (n, n) that the caller has just made."""
    header = header_at(model)
    n = header[COORDINATES]
    at = vector_data(q, header)
    if at == 0:
        return NOT_PLAIN
    position = vector_at(at, n)
    total = 0.0
    for value in position:
        total += value * 0.0
    if not np.isfinite(total):
        return NOT_FINITE
    mass_matrix(header[BODIES], rows_of(header), topology_of(header), position, matrix_of(mass, n))
    return 0


@functools.cache
def _forward() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def forward(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        d, t = rows_of(header), topology_of(header)
        at = vector_at(q, n), vector_at(qd, n), vector_at(tau, n), vector_at(qdd, n)
        return forward_dynamics(header[BODIES], d, t, at[0], at[1], at[2], at[3])

    return forward


@functools.cache
def _chain() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def chain(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        table = vector_at(header[CHAIN], CHAIN_SIZE)
        at = vector_at(q, n), vector_at(qd, n), vector_at(tau, n), vector_at(qdd, n)
        if chain_dynamics(n, table, at[0], at[1], at[2], at[3]) == 0:
            return 0
        return call(header[RECURSION], model, q, qd, tau, qdd)

    return chain


@functools.cache
def _inverse() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def inverse(model: int, q: int, qd: int, qdd: int, tau: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        d, t = rows_of(header), topology_of(header)
        at = vector_at(q, n), vector_at(qd, n), vector_at(qdd, n), vector_at(tau, n)
        inverse_dynamics(header[BODIES], d, t, at[0], at[1], at[2], at[3])
        if header[BARE] == 0:
            subtract_passive(header[BODIES], d, t, at[0], at[1], at[3])
        return 0

    return inverse
