"""Vectors of three numbers in compiled code, as tuples: they stay in registers, and no array is made."""

from __future__ import annotations

from harness.denoc.compiling.compiled import inlined

Triple = tuple[float, float, float]


@inlined
def cross(a: Triple, b: Triple) -> Triple:
    """The vector product a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot3(a: Triple, b: Triple) -> float:
    """The scalar product a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def plus(a: Triple, b: Triple) -> Triple:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a: Triple, b: Triple) -> Triple:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
