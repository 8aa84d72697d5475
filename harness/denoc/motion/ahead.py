"""The kernels of the integrators of one motion with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import MATRIX, VECTOR, WHOLE
from harness.denoc.motion.adaptive import dormand_prince8
from harness.denoc.motion.fixed_step import gauss_legendre6, runge_kutta4


def dop853() -> None:
    """The adaptive method."""
    signature.compile_for(
        dormand_prince8, 1, 1, MATRIX, WHOLE, VECTOR, VECTOR, VECTOR, MATRIX, True, 1.0, 1.0, 1.0,
        MATRIX, MATRIX, MATRIX, WHOLE,
    )  # fmt: skip


def rk4() -> None:
    """The classical Runge-Kutta method."""
    signature.compile_for(runge_kutta4, 1, 1, VECTOR, 1.0, MATRIX, True, MATRIX, MATRIX)


def gauss() -> None:
    """The Gauss-Legendre method."""
    signature.compile_for(gauss_legendre6, 1, 1, VECTOR, 1.0, MATRIX, True, *[MATRIX] * 5)
