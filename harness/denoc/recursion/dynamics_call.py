"""The equations of motion behind an address: one compiled function for every kind of mechanism and every caller.

What calls through an address is compiled once, whether links bend or not: the short way in from Python, the integrators,
the loops over many states. (A kernel that a caller links in is optimized again with each of them.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from harness.denoc.compiling.compiled import compiled
from harness.denoc.recursion.binding import (
    COORDINATES,
    FORWARD,
    INVERSE,
    NOT_FINITE,
    NOT_PLAIN,
    header_at,
    vector_at,
    vector_data,
)

#: Of what stands at an address: (header, q, q̇, τ or q̈, result) -> status, all of them addresses.
SIGNATURE = types.int64(*[types.int64] * 5)


@intrinsic
def call(context: Any, function: Any, model: Any, q: Any, qd: Any, third: Any, out: Any) -> Any:
    """Call what stands at ``function``: (header, q, q̇, τ or q̈, result) -> status, all of them addresses."""

    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)
        pointer = builder.inttoptr(arguments[0], ir.FunctionType(word, [word] * 5).as_pointer())
        return builder.call(pointer, arguments[1:])

    return types.int64(*[types.int64] * 6), code


@compiled
def _checked(function: int, model: int, header: Any, q: Any, qd: Any, third: Any, result: Any) -> int:
    """Call with plain vectors of Python; refuse anything else, and results that are not finite."""
    at_q, at_qd = vector_data(q, header), vector_data(qd, header)
    at_third, at_result = vector_data(third, header), vector_data(result, header)
    if at_q == 0 or at_qd == 0 or at_third == 0 or at_result == 0:
        return NOT_PLAIN
    status = call(function, model, at_q, at_qd, at_third, at_result)
    if status != 0:
        return status
    total = 0.0
    for value in vector_at(at_result, header[COORDINATES]):
        total += value * 0.0
    return 0 if np.isfinite(total) else NOT_FINITE


@compiled
def forward_entry(model: int, q: Any, qd: Any, tau: Any, qdd: Any) -> int:
    """Forward dynamics for ``binding.entry``."""
    header = header_at(model)
    return _checked(header[FORWARD], model, header, q, qd, tau, qdd)


@compiled
def inverse_entry(model: int, q: Any, qd: Any, qdd: Any, tau: Any) -> int:
    """Inverse dynamics for ``binding.entry``."""
    header = header_at(model)
    return _checked(header[INVERSE], model, header, q, qd, qdd, tau)


@compiled
def call_rows(function: int, model: int, q: Any, qd: Any, third: Any, out: Any) -> int:
    """Call for every row of (B, n) arrays; 0 or the first status that is not."""
    for k in range(len(q)):
        status = call(function, model, q[k].ctypes.data, qd[k].ctypes.data, third[k].ctypes.data, out[k].ctypes.data)
        if status != 0:
            return status
    return 0
