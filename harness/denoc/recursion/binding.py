"""The short way from Python into a kernel.

At one joint the recursion takes 50 ns, while numba's dispatcher spends four times that on recognising its arguments.
Here the kernel gets the array objects themselves, and looks by itself whether each is a plain float64 vector of the
right length (NumPy's public C layout, ``PyArrayObject_fields``, the same since NumPy 1.7). Anything else, a list, a
view with strides, integers, is left to the slow way, which converts and checks. ``works`` tests the assumption about
the layout once a process; where it does not hold (a debug or free-threaded interpreter) everything goes the slow way.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import carray, types
from numba.core.datamodel import models
from numba.extending import NativeValue, intrinsic, register_model, unbox
from numpy.typing import NDArray

from harness.denoc.compiling.compiled import compiled
from harness.denoc.recursion.rows import COLUMNS, WIDTH

Array = NDArray[np.float64]

# Words of the header that stands for a model on the way in.
# FORWARD and INVERSE: addresses of the dynamics. RECURSION: of the forward dynamics that read the bodies' rows at every call.
# BARE: not 0 where inverse dynamics leave passive forces out.
# Of models whose positions and velocities are not those of their joints of one degree of freedom (``harness.denoc.chart``):
# POSITIONS: number of positions, COORDINATES being that of velocities. INNER: header of the lowered model. PLACES, NUMBERS: the
# chart's tables. RATES, SETTLE: addresses of the positions' rates and of what puts a state back on its manifold, 0 for none.
# Of models that loops close (``harness.denoc.loops``): TREE: header of the tree. CUTS, CUT_NUMBERS: the loops' tables.
(
    BODIES, COORDINATES, ROWS, TOPOLOGY, ELASTIC, ELASTIC_SIZE, ARRAY_TYPE, FLOAT_TYPE, FORWARD, INVERSE, RECURSION, CHAIN,
    BARE, POSITIONS, INNER, PLACES, NUMBERS, RATES, SETTLE, TREE, CUTS, CUT_NUMBERS,
) = range(22)  # fmt: skip
HEADER_SIZE = 22

#: What an entry returns besides 0 and the row of a body without inertia.
NOT_PLAIN, NOT_FINITE = -1, -2

# Offsets into an array object, in words of eight bytes: its type, data, number of dimensions, dimensions, strides, type
# of the elements.
_TYPE, _DATA, _RANK, _SHAPE, _STRIDES, _ELEMENT = 1, 2, 3, 4, 5, 7


class ObjectReference(types.Opaque):
    """A Python object passed into a kernel as it is."""

    def __init__(self) -> None:
        super().__init__(name="ObjectReference")


object_reference = ObjectReference()
register_model(ObjectReference)(models.OpaqueModel)


@unbox(ObjectReference)
def _unbox(typ: Any, obj: Any, c: Any) -> Any:
    return NativeValue(obj)


@intrinsic
def _address(context: Any, reference: Any) -> Any:
    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.ptrtoint(arguments[0], target.get_value_type(types.int64))

    return types.int64(object_reference), code


@intrinsic
def _words(context: Any, address: Any) -> Any:
    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], target.get_value_type(signature.return_type))

    return types.CPointer(types.int64)(types.int64), code


@intrinsic
def _floats(context: Any, address: Any) -> Any:
    def code(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], target.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), code


# Optimized by themselves, and not only where they are used (``compiled.allocating``): references that are counted in vain
# are found better in small functions, which is a twentieth of a call at one joint.
@compiled
def vector_data(reference: Any, header: Any) -> int:
    """Address of the data of a contiguous float64 vector of the model's length, 0 if it is anything else."""
    fields = carray(_words(_address(reference)), 8)
    if fields[_TYPE] != header[ARRAY_TYPE] or fields[_ELEMENT] != header[FLOAT_TYPE]:
        return 0
    if (fields[_RANK] & 0xFFFFFFFF) != 1:
        return 0
    n = header[COORDINATES]
    if carray(_words(fields[_SHAPE]), 1)[0] != n:
        return 0
    if n > 1 and carray(_words(fields[_STRIDES]), 1)[0] != 8:
        return 0
    return fields[_DATA]


@compiled
def header_at(address: int) -> Any:
    """A model's header, (HEADER_SIZE,), at its address."""
    return carray(_words(address), HEADER_SIZE)


@compiled
def rows_of(header: Any) -> Any:
    """The bodies' rows, (bodies + 1, WIDTH); see ``rows``."""
    return carray(_floats(header[ROWS]), (header[BODIES] + 1, WIDTH))


@compiled
def topology_of(header: Any) -> Any:
    """The bodies' integers, (bodies + 1, COLUMNS); see ``rows``."""
    return carray(_words(header[TOPOLOGY]), (header[BODIES] + 1, COLUMNS))


@compiled
def elastic_of(header: Any) -> Any:
    """The packed beams; see ``elastic``."""
    return carray(_floats(header[ELASTIC]), header[ELASTIC_SIZE])


@compiled
def words_at(address: int, n: int) -> Any:
    """Integers at an address, (n,)."""
    return carray(_words(address), n)


@compiled
def vector_at(address: int, n: int) -> Any:
    """Numbers at an address, (n,)."""
    return carray(_floats(address), n)


@compiled
def matrix_at(address: int, rows: int, columns: int) -> Any:
    """Numbers at an address by rows, (rows, columns)."""
    return carray(_floats(address), (rows, columns))


@compiled
def matrix_of(reference: Any, n: int) -> Any:
    """An array of Python's as an (n, n) matrix, unseen: for one that the caller has just made."""
    return carray(_floats(carray(_words(_address(reference)), 8)[_DATA]), (n, n))


def entry(kernel: Any, vectors: int) -> Callable[..., int]:
    """The compiled function itself, without dispatcher, of a kernel (header address, vector, …, vector)."""
    signature = (types.int64, *([object_reference] * vectors))
    if signature not in kernel.overloads:
        kernel.compile(signature)
    function: Callable[..., int] = kernel.overloads[signature].entry_point
    return function


def make_header(
    bodies: int, n: int, rows: Array, topology: NDArray[np.int64], elastic: Array, forward: int, inverse: int
) -> NDArray[np.int64]:
    """Header of a model with the addresses of its dynamics; whoever holds it must hold the arrays as well."""
    header = np.zeros(HEADER_SIZE, dtype=np.int64)
    header[BODIES], header[COORDINATES], header[POSITIONS] = bodies, n, n
    header[ROWS], header[TOPOLOGY] = rows.ctypes.data, topology.ctypes.data
    header[ELASTIC], header[ELASTIC_SIZE] = elastic.ctypes.data, len(elastic)
    header[FORWARD], header[INVERSE], header[RECURSION] = forward, inverse, forward
    if works():
        header[ARRAY_TYPE], header[FLOAT_TYPE] = id(np.ndarray), id(np.dtype(np.float64))
    return header


@compiled
def _probe(address: int, reference: Any) -> int:
    return vector_data(reference, header_at(address))


@functools.cache
def works() -> bool:
    """Whether array objects are laid out in this process as assumed."""
    if np.dtype(np.intp).itemsize != 8 or object.__basicsize__ != 16 or np.ndarray.__basicsize__ < 64:
        return False
    header = np.zeros(HEADER_SIZE, dtype=np.int64)
    header[COORDINATES] = 3
    header[ARRAY_TYPE], header[FLOAT_TYPE] = id(np.ndarray), id(np.dtype(np.float64))
    probe = entry(_probe, 1)
    plain = np.arange(3.0)
    unfit = (np.arange(4.0), np.arange(3), np.zeros((3, 1)), np.arange(6.0)[::2], np.zeros(()), [0.0, 1.0, 2.0], None)
    return probe(header.ctypes.data, plain) == plain.ctypes.data and not any(
        probe(header.ctypes.data, other) for other in unfit
    )
