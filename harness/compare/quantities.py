"""How far two values of a quantity are apart, as one number without a unit.

Coordinates of a mechanism mix radians with metres, and near an equilibrium everything is nearly zero; so differences are
measured in the norm that the mass matrix gives (kinetic energy), or against the largest entry over many states.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Below this share of the largest value over all states there is nothing left to be relative to.
FLOOR = 0.01


def relative(a: Array, b: Array, *, floor: float = FLOOR, terms: Array | None = None) -> Array:
    """Largest difference of each state over the state's largest entry, shape (B,).

    a, b: values at B states, shape (B, …). The scale is at least ``floor`` of the largest entry over all states.
    terms: sizes of the terms that the values are sums of, shape (B,), where they may cancel; the scale is at least that.
    Values that are not finite differ infinitely; two exact zeros agree.
    """
    first, second = (np.asarray(x, dtype=np.float64).reshape(len(x), -1) for x in (a, b))
    if first.shape != second.shape:
        raise ValueError(f"shapes {first.shape} and {second.shape} cannot be compared")
    finite = _finite(first, second)
    size = np.where(finite, np.maximum(np.abs(first).max(axis=1), np.abs(second).max(axis=1)), 0.0)
    if terms is not None:
        size = np.maximum(size, terms)
    return _over(np.abs(first - second).max(axis=1), size, finite, floor)


def accelerations(mass: Array, a: Array, b: Array, *, floor: float = FLOOR) -> Array:
    """Differences of accelerations in the mass matrix's norm √(δᵀMδ) over that of the accelerations, shape (B,).

    mass: (B, n, n) positive definite; a, b: (B, n). Radians and metres are weighed by the energy they carry.
    """
    finite = _finite(a, b)
    size = np.where(finite, np.maximum(_norm(mass, a), _norm(mass, b)), 0.0)
    return _over(_norm(mass, a - b), size, finite, floor)


def forces(mass: Array, a: Array, b: Array, *, floor: float = FLOOR) -> Array:
    """Differences of generalized forces in the norm √(δᵀM⁻¹δ) over that of the forces, shape (B,).

    mass: (B, n, n) positive definite; a, b: (B, n). The norm is that of the accelerations the forces would cause.
    """
    finite = _finite(a, b)
    inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
    size = np.where(finite, np.maximum(_norm(inverse, a), _norm(inverse, b)), 0.0)
    return _over(_norm(inverse, a - b), size, finite, floor)


def mass_matrices(a: Array, b: Array) -> Array:
    """Largest difference of the entries (i, j) over √(M_ii M_jj), shape (B,); entries of any unit count alike.

    a, b: (B, n, n) with positive diagonals.
    """
    return np.asarray(entries(a, b).reshape(len(a), -1).max(axis=1))


def entries(a: Array, b: Array) -> Array:
    """Differences of the mass matrices' entries (i, j) over √(M_ii M_jj), shape (B, n, n)."""
    own = np.sqrt(np.abs(np.diagonal(a, axis1=1, axis2=2)))
    apart = np.abs(a - b) / (own[:, :, None] * own[:, None, :])
    return np.where(np.isfinite(apart), apart, np.inf)


def _finite(a: Array, b: Array) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1), dtype=np.bool_)


def _norm(matrix: Array, vectors: Array) -> Array:
    return np.sqrt(np.maximum(np.einsum("bi,bij,bj->b", vectors, matrix, vectors), 0.0))


def _over(difference: Array, size: Array, finite: NDArray[np.bool_], floor: float) -> Array:
    scale = np.maximum(size, floor * size.max(initial=0.0))
    share = np.where(difference == 0.0, 0.0, difference / np.where(scale > 0.0, scale, 1.0))
    return np.where(finite, share, np.inf)
