"""The equations of motion behind one address, so that an integrator is compiled once for every kind of mechanism."""

from __future__ import annotations

import functools
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import cfunc, types
from numba.extending import intrinsic

from harness.denoc.binding import BODIES, COORDINATES, elastic_of, header_at, rows_of, topology_of, vector_at

_SIGNATURE = types.int64(types.int64, types.int64, types.int64, types.int64, types.int64)


@functools.cache
def address(flexible: bool) -> int:
    """Address of forward_dynamics(header, q, qd, tau, qdd) -> status, all arguments addresses."""
    return int((_flexible() if flexible else _rigid()).address)


@functools.cache
def _rigid() -> Any:
    from harness.denoc import rigid

    forward = rigid.forward_dynamics

    @cfunc(_SIGNATURE, cache=True)
    def dynamics(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        return forward(
            header[BODIES],
            rows_of(header),
            topology_of(header),
            vector_at(q, n),
            vector_at(qd, n),
            vector_at(tau, n),
            vector_at(qdd, n),
        )

    return dynamics


@functools.cache
def _flexible() -> Any:
    from harness.denoc import flexible

    forward = flexible.forward_dynamics

    @cfunc(_SIGNATURE, cache=True)
    def dynamics(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
        header = header_at(model)
        n = header[COORDINATES]
        return forward(
            header[BODIES],
            rows_of(header),
            topology_of(header),
            elastic_of(header),
            vector_at(q, n),
            vector_at(qd, n),
            vector_at(tau, n),
            vector_at(qdd, n),
        )

    return dynamics


@intrinsic
def call(context: Any, function: Any, model: Any, q: Any, qd: Any, tau: Any, qdd: Any) -> Any:
    """Call what stands at ``function``."""

    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)
        pointer = builder.inttoptr(arguments[0], ir.FunctionType(word, [word] * 5).as_pointer())
        return builder.call(pointer, arguments[1:])

    return types.int64(*[types.int64] * 6), code
