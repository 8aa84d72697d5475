"""A straight bar of 20-node bricks, assembled by hand: nodes, consistent mass and stiffness.

Serendipity shape functions and a 3 x 3 x 3 Gauss rule; T. J. R. Hughes, The Finite Element Method (2000), ch. 3.
Without Poisson's ratio a brick bends as an Euler-Bernoulli beam does, but for shear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix

from harness.engines.protocol import Array

# Corners, then the middles of the edges along x, y and z, in natural coordinates.
_CORNERS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
_EDGES = (
    [(0, y, z) for z in (-1, 1) for y in (-1, 1)]
    + [(x, 0, z) for z in (-1, 1) for x in (-1, 1)]
    + [(x, y, 0) for y in (-1, 1) for x in (-1, 1)]
)
_NATURAL = np.array(_CORNERS + _EDGES, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Bar:
    """A meshed bar along x from the origin, its section centred on the x axis.

    nodes: (N, 3) [m]; mass, stiffness: (3N, 3N), coordinates node by node; root, tip: node numbers of the end faces.
    """

    nodes: Array
    mass: csr_matrix
    stiffness: csr_matrix
    root: NDArray[np.intp]
    tip: NDArray[np.intp]


def bar(length: float, depth: float, width: float, density: float, modulus: float, elements: int) -> Bar:
    """A bar of ``elements`` bricks along x; depth along y, width along z [m]; Poisson's ratio is zero."""
    size = np.array([length / elements, depth, width])
    mass, stiffness = _brick(size, density, modulus)
    places: dict[tuple[int, int, int], int] = {}
    connectivity = np.empty((elements, 20), dtype=np.intp)
    for k in range(elements):
        for j, natural in enumerate(_NATURAL):
            # Half element lengths from the root, and ±1 across.
            key = (2 * k + 1 + int(natural[0]), int(natural[1]), int(natural[2]))
            connectivity[k, j] = places.setdefault(key, len(places))
    nodes = np.array(list(places), dtype=np.float64) * size / 2.0
    rows = (3 * connectivity[:, :, None] + np.arange(3)).reshape(elements, 60)
    row, column = np.repeat(rows, 60, axis=1).ravel(), np.tile(rows, (1, 60)).ravel()
    shape = (3 * len(nodes), 3 * len(nodes))

    def assembled(matrix: Array) -> csr_matrix:
        return coo_matrix((np.tile(matrix.ravel(), elements), (row, column)), shape=shape).tocsr()

    ends = [np.flatnonzero(np.abs(nodes[:, 0] - x) < 1e-9 * length) for x in (0.0, length)]
    return Bar(nodes, assembled(mass), assembled(stiffness), ends[0], ends[1])


def _brick(size: Array, density: float, modulus: float) -> tuple[Array, Array]:
    """Mass and stiffness of one box-shaped brick, (60, 60) each."""
    # Poisson's ratio zero: normal stresses are E ε, shear stresses E/2 γ.
    elasticity = modulus * np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    point, weight = np.polynomial.legendre.leggauss(3)
    volume = float(np.prod(size)) / 8.0
    mass, stiffness = np.zeros((60, 60)), np.zeros((60, 60))
    for x, wx in zip(point, weight, strict=True):
        for y, wy in zip(point, weight, strict=True):
            for z, wz in zip(point, weight, strict=True):
                value, gradient = _shape(np.array([x, y, z]))
                gradient = gradient * (2.0 / size)
                spread = np.kron(value, np.eye(3))
                strain = np.zeros((6, 60))
                for axis in range(3):
                    strain[axis, axis::3] = gradient[:, axis]
                for row, (a, b) in enumerate(((1, 2), (0, 2), (0, 1)), start=3):
                    strain[row, a::3] = gradient[:, b]
                    strain[row, b::3] = gradient[:, a]
                share = wx * wy * wz * volume
                mass += share * density * spread.T @ spread
                stiffness += share * strain.T @ elasticity @ strain
    return mass, stiffness


def _shape(at: Array) -> tuple[Array, Array]:
    """Shape functions (20,) and their gradients by the natural coordinates (20, 3)."""
    product = _NATURAL * at
    plus = 1.0 + product
    value, gradient = np.empty(20), np.empty((20, 3))
    corner = slice(0, 8)
    total = product[corner].sum(axis=1) - 2.0
    value[corner] = plus[corner].prod(axis=1) * total / 8.0
    for axis in range(3):
        others = plus[corner][:, [a for a in range(3) if a != axis]].prod(axis=1)
        gradient[corner, axis] = _NATURAL[corner, axis] * others * (total + plus[corner, axis]) / 8.0
    for j in range(8, 20):
        middle = int(np.flatnonzero(_NATURAL[j] == 0.0)[0])
        first, second = (a for a in range(3) if a != middle)
        bubble = 1.0 - at[middle] ** 2
        value[j] = bubble * plus[j, first] * plus[j, second] / 4.0
        gradient[j, middle] = -2.0 * at[middle] * plus[j, first] * plus[j, second] / 4.0
        gradient[j, first] = bubble * _NATURAL[j, first] * plus[j, second] / 4.0
        gradient[j, second] = bubble * plus[j, first] * _NATURAL[j, second] / 4.0
    return value, gradient
