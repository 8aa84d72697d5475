"""The kernels of closed loops with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import MATRIX, VECTOR
from harness.denoc.loops import address


def loops() -> None:
    address.addresses()
    signature.compile_for(address.described, 1, VECTOR, VECTOR, MATRIX, MATRIX)
