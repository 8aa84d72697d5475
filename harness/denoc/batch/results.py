"""Where methods over many states write their results (the caller's ``out=`` in numpy's manner, or room of their own), and whether
numbers are finite."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.simd.vector import aligned
from harness.errors import InputError

Array = NDArray[np.float64]

# For fewer numbers no kernel is compiled, or read from disk.
_MANY = 1000


def place_for(shape: tuple[int, ...], out: Array | None) -> Array:
    """``out``, to be overwritten, or a new array if it is None, which begins where a cache line does.

    Raises InputError unless out has this shape, is of float64, C-contiguous, aligned and writeable.
    """
    if out is None:
        return aligned(prod(shape)).reshape(shape)
    fault = _fault(shape, out)
    if fault:
        raise InputError(f"out {fault}", mend=f"give a writeable, C-contiguous array of float64 of shape {shape}")
    return out


def _fault(shape: tuple[int, ...], out: Any) -> str:
    """What keeps results of this shape from being written to out; empty if nothing does."""
    if not isinstance(out, np.ndarray):
        return f"is no array but {type(out).__name__}"
    if out.shape != shape:
        return f"has shape {out.shape}"
    if out.dtype != np.float64:
        return f"holds {out.dtype}"
    if not out.flags.c_contiguous:
        return "is not C-contiguous"
    if not out.flags.aligned:
        return "is not aligned"
    return "" if out.flags.writeable else "is read-only"


def finite(array: Array) -> bool:
    """Whether all numbers of a C-contiguous array are finite."""
    if array.size < _MANY or not array.flags.writeable:
        return bool(np.isfinite(array).all())
    # A third of numpy's time, which is up to a tenth of that of the dynamics.
    from harness.denoc.batch.dynamics import all_finite

    return bool(all_finite(array.reshape(-1)))


def apart(array: Array, out: Array | None) -> Array:
    """The array, or a copy of it where it may share memory with out, so that no result is written over what is still read."""
    return array if out is None or not np.may_share_memory(array, out) else array.copy()
