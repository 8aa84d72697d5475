"""Stand-ins for the arguments of kernels, of which only the types are looked at."""

from __future__ import annotations

from typing import Any

import numpy as np

VECTOR, MATRIX, CUBE = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1))
WHOLE, TABLE = np.zeros(1, dtype=np.int64), np.zeros((1, 1), dtype=np.int64)
RIGID = (1, MATRIX, TABLE)
FLEXIBLE = (*RIGID, VECTOR)
# As ``LaneModel.tables``.
LANES = (TABLE, TABLE, WHOLE, MATRIX, CUBE, MATRIX)


def compile_for(kernel: Any, *arguments: Any) -> None:
    """Compile a kernel for arguments such as these, without running it."""
    from numba import typeof

    kernel.compile(tuple(typeof(argument) for argument in arguments))
