"""How kernels are compiled, said once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

# Fused multiply-add and free signs of zero, nothing that changes what NaN and infinity mean: bad input must stay visible.
FAST_MATH = {"contract", "nsz"}


def compiled(function: F) -> F:
    """The function as a kernel: compiled at first use, cached on disk, no bounds checks, division by zero gives inf."""
    return cast(F, njit(cache=True, error_model="numpy", fastmath=FAST_MATH)(function))
