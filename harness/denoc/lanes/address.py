"""The recursions of the lanes as functions at an address, so that one is compiled only where a mechanism needs it.

The integrator calls through the address; a recursion that it linked in would be compiled again with each of its parts.
Names at module level are all that these functions use: one that closes over another is never found in the cache again.
"""

from __future__ import annotations

import functools
from typing import Any

from numba import carray, cfunc, types

from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.lanes import closed as closed_lanes
from harness.denoc.lanes.nodes import COLUMNS, PLAN
from harness.denoc.lanes.planar import planar_accelerations
from harness.denoc.lanes.tree import accelerations
from harness.denoc.simd.vector import allocating, integers_at, numbers_at

# Addresses of tree, flags, constants, beams, laws, workspace; and what else ``accelerations`` takes.
_SIGNATURE = types.void(*[types.int64] * 11)


@functools.cache
def spatial() -> int:
    """Address of the recursion in space."""
    return int(_spatial().address)


@functools.cache
def planar() -> int:
    """Address of the recursion in a plane."""
    return int(_planar().address)


@functools.cache
def closed() -> int:
    """Address of a recursion with loops, or with what turns in space; the first row of its tree has the address of its plan."""
    return int(_closed().address)


# The arrays' lengths are nowhere read: indices are not checked, and none is negative.
@allocating
def _arrays(tree: int, nodes: int, flags: int, constants: int, beams: int, laws: int, ws: int, n: int) -> Any:
    return (
        carray(integers_at(tree), (nodes, COLUMNS)),
        carray(integers_at(flags), n),
        carray(numbers_at(constants), 1),
        carray(numbers_at(beams), 1),
        carray(numbers_at(laws), 1),
        carray(numbers_at(ws), 1),
    )


@functools.cache
def _spatial() -> Any:
    @cfunc(_SIGNATURE, cache=True, error_model="numpy", pipeline_class=Kernel)
    def spatial_at(
        tree: int, nodes: int, flags: int, constants: int, beams: int, laws: int, ws: int, n: int, user: int, shaken: int,
        loaded: int,
    ) -> None:  # fmt: skip
        t, f, c, b, l, w = _arrays(tree, nodes, flags, constants, beams, laws, ws, n)
        accelerations(t, f, c, b, l, w, n, user, shaken, loaded)

    return spatial_at


@functools.cache
def _planar() -> Any:
    @cfunc(_SIGNATURE, cache=True, error_model="numpy", pipeline_class=Kernel)
    def planar_at(
        tree: int, nodes: int, flags: int, constants: int, beams: int, laws: int, ws: int, n: int, user: int, shaken: int,
        loaded: int,
    ) -> None:  # fmt: skip
        t, f, c, b, l, w = _arrays(tree, nodes, flags, constants, beams, laws, ws, n)
        planar_accelerations(t, f, c, b, l, w, n, user, shaken, loaded)

    return planar_at


@functools.cache
def _closed() -> Any:
    @cfunc(_SIGNATURE, cache=True, error_model="numpy", pipeline_class=Kernel)
    def closed_at(
        tree: int, nodes: int, flags: int, constants: int, beams: int, laws: int, ws: int, n: int, user: int, shaken: int,
        loaded: int,
    ) -> None:  # fmt: skip
        plan = carray(integers_at(carray(integers_at(tree), (nodes, COLUMNS))[0, PLAN]), 1)
        dry, l, w = carray(integers_at(flags), n), carray(numbers_at(laws), 1), carray(numbers_at(ws), 1)
        closed_lanes.accelerations(
            plan, tree, nodes, flags, constants, beams, laws, ws, dry, l, w, user, shaken, loaded
        )

    return closed_at
