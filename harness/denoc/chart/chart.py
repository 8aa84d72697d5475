"""A model's positions and velocities over those of the lowered tree: what ``Denoc`` hands over and takes back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.chart.tables import tables
from harness.denoc.recursion.binding import (
    BARE,
    COORDINATES,
    FORWARD,
    INNER,
    INVERSE,
    NUMBERS,
    PLACES,
    POSITIONS,
    RATES,
    RECURSION,
    SETTLE,
)
from harness.denoc.recursion.tree import Array, Integers, Tree
from harness.errors import InputError, UnsupportedError
from harness.system import System
from harness.system.lowering import Lowered

Words = NDArray[np.int64]

# A quaternion shorter than this says nothing about a rotation.
_SHORTEST = 1e-9


@dataclass(frozen=True, eq=False)
class Chart:
    """Tables and headers of a model whose joints were lowered.

    headers: of the lowered tree, passive forces counted and not; held here because the chart's own headers point at them.
    """

    lowered: Lowered
    places: Integers
    numbers: Array
    headers: tuple[Words, Words]

    def local(self, header: int, q: Array) -> Array:
        """Lowered positions of q (nq,), shape (m,); the lowered tree is recentred there."""
        from harness.denoc.chart.kernels import recentred

        local = np.empty(len(self.lowered.take))
        recentred(header, q, local)
        return local

    def refuse_zero(self, Q: Array) -> None:
        """Raise InputError naming the joint where a row of Q (B, nq) holds a quaternion of no length."""
        for at, coordinate in self.lowered.balls:
            # A tenth of the time that ``norm`` takes for many short rows.
            squares = np.einsum("ij,ij->i", Q[:, at : at + 4], Q[:, at : at + 4])
            if (squares < _SHORTEST**2).any():
                joint = self.lowered.system.coordinate_names[coordinate].rpartition(".")[0]
                row = f"row {int(np.argmin(squares))}: " if len(Q) > 1 else ""
                raise InputError(
                    f"{row}the quaternion of joint {joint!r}, q[{at}] to q[{at + 3}], has length zero",
                    mend="give w, x, y, z; no rotation is 1, 0, 0, 0",
                )

    def rates(self, v: Array) -> Array:
        """Lowered rates of velocities v, (nv,) to (m,)."""
        return v if self.lowered.independent else self.lowered.rates @ v

    def gathered(self, forces: Array) -> Array:
        """Generalized forces of lowered ones, (m,) to (nv,)."""
        return forces if self.lowered.independent else self.lowered.rates.T @ forces

    def both_sides(self, matrix: Array) -> Array:
        """A matrix of the velocities from one of the lowered rates, (m, m) to (nv, nv)."""
        return matrix if self.lowered.independent else self.lowered.rates.T @ matrix @ self.lowered.rates

    def product_matrix(self, w: Array) -> Array:
        """The matrix E' whose product with lowered rates w (m,) is what accelerations have beyond those of angles, (m, m)."""
        found = np.zeros((len(w), len(w)))
        for _, c in self.lowered.balls:
            found[c, c + 1], found[c + 1, c], found[c + 2, c] = w[c + 2], -w[c + 2], w[c + 1]
        return found


def make_chart(system: System, lowered: Lowered, tree: Tree, inner: Words) -> tuple[Chart, Words, Words]:
    """The chart, and its headers with passive forces counted and not, for the header of the lowered tree."""
    if tree.beams and not lowered.independent:
        raise UnsupportedError(
            "a mimicking or helical joint beside a flexible link is not supported yet",
            mend="take the mimic out, or make the link rigid",
            source=system.source,
        )
    places, numbers = tables(system, lowered, tree)
    bare = inner.copy()
    bare[BARE] = 1
    chart = Chart(lowered, places, numbers, (inner, bare))
    return chart, _header(system, chart, inner), _header(system, chart, bare)


def _header(system: System, chart: Chart, inner: Words) -> Words:
    from harness.denoc.chart import address

    header = inner.copy()
    header[COORDINATES], header[POSITIONS], header[INNER] = system.nv, system.nq, inner.ctypes.data
    header[PLACES], header[NUMBERS] = chart.places.ctypes.data, chart.numbers.ctypes.data
    header[FORWARD], header[INVERSE] = _dynamics(chart)
    header[RECURSION] = header[FORWARD]
    if system.nq != system.nv:
        header[RATES], header[SETTLE] = address.state_addresses()
    return header


def _dynamics(chart: Chart) -> tuple[Any, Any]:
    if chart.lowered.independent:
        from harness.denoc.chart import address

        return address.addresses()
    from harness.denoc.chart import coupled_address

    return coupled_address.addresses()
