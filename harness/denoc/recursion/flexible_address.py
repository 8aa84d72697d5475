"""The dynamics of flexible mechanisms as functions at an address, for ``dynamics_call``.

Names at module level are all they use: a compiled function that closes over another is never found in the cache again.
"""

from __future__ import annotations

import functools
from typing import Any

from numba import cfunc

from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.recursion.binding import (
    BARE,
    BODIES,
    COORDINATES,
    elastic_of,
    header_at,
    rows_of,
    topology_of,
    vector_at,
)
from harness.denoc.recursion.dynamics_call import SIGNATURE
from harness.denoc.recursion.flexible import forward_dynamics, inverse_dynamics, subtract_passive


@functools.cache
def addresses() -> tuple[int, int]:
    """Addresses of forward and of inverse dynamics."""
    return int(_forward().address), int(_inverse().address)


@functools.cache
def _forward() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def forward(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        d, t, e = rows_of(header), topology_of(header), elastic_of(header)
        at = vector_at(q, n), vector_at(qd, n), vector_at(tau, n), vector_at(qdd, n)
        return forward_dynamics(header[BODIES], d, t, e, at[0], at[1], at[2], at[3])

    return forward


@functools.cache
def _inverse() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def inverse(model: int, q: int, qd: int, qdd: int, tau: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        d, t, e = rows_of(header), topology_of(header), elastic_of(header)
        at = vector_at(q, n), vector_at(qd, n), vector_at(qdd, n), vector_at(tau, n)
        inverse_dynamics(header[BODIES], d, t, e, at[0], at[1], at[2], at[3])
        if header[BARE] == 0:
            subtract_passive(header[BODIES], d, t, e, at[0], at[1], at[3])
        return 0

    return inverse
