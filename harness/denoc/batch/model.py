"""Forward and inverse dynamics and the mass matrix of one rigid system in many states, eight states at a time.

``BatchModel(system)`` is what ``Denoc`` uses for its methods over (B, n); it can be used on its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.denoc.batch import chain_mass as batch_mass
from harness.denoc.batch import dynamics as kernels
from harness.denoc.batch import tree_mass as batch_tree_mass
from harness.denoc.batch.results import apart, place_for
from harness.denoc.compiling import ahead
from harness.denoc.lanes import tree as nodes
from harness.denoc.lanes.model import LaneModel
from harness.denoc.lanes.threads import share
from harness.denoc.simd.vector import aligned
from harness.errors import InputError, UnsupportedError
from harness.system import System
from harness.system.lowering import one_degree

Array = NDArray[np.float64]

_EIGHT = 8


class BatchModel:
    """A rigid system compiled for many states at once.

    names: joints in the order of the columns; n: their number; serial: whether each link carries the next and no other.
    States are rows, shape (B, n), SI units; joint damping and springs act, dry friction does not.
    threads: threads to spread the states over; the result does not depend on it.
    Raises UnsupportedError for systems with flexible links.
    """

    def __init__(self, system: System, *, threads: int = 1) -> None:
        if system.flexible:
            raise UnsupportedError(f"{system.name}: batches of flexible links", mend="use System.rigid() or Denoc")
        # Of single states nothing holds loops and followers here.
        model = LaneModel(one_degree(system, "a computation of many states at once"))
        self.lanes = model
        self.names, self.n, self.threads = model.names, model.n, threads
        self._tree, self._accumulators = _integers(model)
        self._constants = _constants(model, model.row())
        self.serial = bool((self._tree[:, 0] == np.arange(-1, self.n - 1)).all())
        long = self.n >= batch_tree_mass.LONG and not self.serial
        self._places = batch_tree_mass.element_places(self._tree[:, 0] if long else ())
        # Workspaces that no call uses at present.
        self._rooms: list[Array] = []
        self._gravity = np.array(system.gravity, dtype=np.float64)
        self._masses = self._carried()

    def with_row(self, row: Array) -> BatchModel:
        """The same mechanism with other numbers: a parameter row of ``lanes``, shape (P,); what dissipates by dry laws is left out.

        Takes a twentieth of the time that compiling the system with these numbers would.
        """
        other = copy(self)
        other._constants = _constants(self.lanes, row)
        other._gravity = np.array(row[:3])
        other._masses = other._carried()
        return other

    @property
    def bodies(self) -> tuple[Any, Array]:
        """Integers and constants of the bodies, a row each, as ``batch.dynamics`` reads them."""
        return self._tree, self._constants.reshape(self.n, -1)

    def _carried(self) -> Array:
        """Mass of every body with what it carries [kg], shape (n,)."""
        masses = self._constants.reshape(self.n, -1)[:, 9].copy()
        for i in range(self.n - 1, -1, -1):
            parent = self._tree[i, 0]
            if parent >= 0:
                masses[parent] += masses[i]
        return masses

    def forward_dynamics(
        self, Q: ArrayLike, Qd: ArrayLike, Tau: ArrayLike | None = None, *, out: Array | None = None
    ) -> Array:
        """Accelerations, shape (B, n), under applied generalized forces Tau (none by default).

        out: where to write them, here and below: a writeable, C-contiguous array of float64 of the result's shape, which is
        returned. A new result of many states costs as much to make room for as to compute.
        """
        q, qd = self._states("Q", Q), self._states("Qd", Qd)
        tau = np.zeros_like(q) if Tau is None else self._states("Tau", Tau)
        return self._accelerations(kernels.forward_dynamics, self._gravity, out, q, qd, tau)

    def floating_dynamics(self, trunk: Array, Q: Array, Qd: Array, Tau: Array, out: Array) -> Array:
        """The same of what hangs on a trunk, the first six joints as one, positions (B, n + 1); trunk: as in ``batch.trunk``."""
        qd, tau = self._states("Qd", Qd), self._states("Tau", Tau)
        q = Q if Q.flags.writeable else Q.copy()
        return self._accelerations(kernels.floating_dynamics, trunk, out, q, qd, tau)

    def _accelerations(self, sweeps: Callable[..., None], own: Array, out: Array | None, *states: Array) -> Array:
        bodies = self.n * kernels.BODY * _EIGHT

        def kernel(first: int, last: int, tree: Any, c: Array, ws: Array, *others: Array) -> None:
            sweeps(first, last, tree, c, ws[:bodies], ws[bodies:], *others)

        size = bodies + max(1, self._accumulators) * kernels.ACCUMULATOR * _EIGHT
        return self._spread(kernel, size, own, (self.n,), out, *states)

    def inverse_dynamics(self, Q: ArrayLike, Qd: ArrayLike, Qdd: ArrayLike, *, out: Array | None = None) -> Array:
        """Generalized forces that make the accelerations Qdd, shape (B, n); out as in ``forward_dynamics``."""
        q, qd, qdd = self._states("Q", Q), self._states("Qd", Qd), self._states("Qdd", Qdd)
        size = self.n * kernels.BODY * _EIGHT
        return self._spread(kernels.inverse_dynamics, size, self._gravity, (self.n,), out, q, qd, qdd)

    def mass_matrix(self, Q: ArrayLike, *, out: Array | None = None) -> Array:
        """Generalized inertia matrices, armature included, shape (B, n, n); out as in ``forward_dynamics``."""
        q = self._states("Q", Q)
        each = (self.n, self.n)
        if self.serial and self.n >= batch_mass.SHORTEST:
            return self._spread(batch_mass.chain_mass_matrix, batch_mass.room(self.n), self._masses, each, out, q)

        def kernel(first: int, last: int, tree: Any, c: Array, ws: Array, *others: Array) -> None:
            batch_tree_mass.mass_matrix(first, last, tree, self._places, c, ws, *others)

        size = (self.n * (kernels.BODY + 1) + len(self._places) // 2) * _EIGHT
        return self._spread(kernel, size, self._masses, each, out, q)

    def _states(self, name: str, values: ArrayLike) -> Array:
        array = np.asarray(values, dtype=np.float64, order="C")
        if array.ndim != 2 or array.shape[1] != self.n:
            raise InputError(f"{name} has shape {array.shape}", mend=f"expected (B, {self.n})")
        # A read-only array would be another type to the compiler.
        return array if array.flags.writeable else array.copy()

    def _spread(
        self,
        kernel: Callable[..., None],
        size: int,
        own: Array,
        each: tuple[int, ...],
        out: Array | None,
        *arrays: Array,
    ) -> Array:
        """Run a kernel over all rows, eight at a time; the last eight may overlap those before.

        size: numbers in its workspace; own: what else of the model it needs; each: shape of the result of one row.
        """
        count = len(arrays[0])
        if any(len(array) != count for array in arrays[1:]):
            rows = ", ".join(str(len(a)) for a in arrays)
            raise InputError(f"arrays of {rows} rows", mend="give as many rows in each")
        result = place_for((count, *each), out)
        if count < _EIGHT:
            if count:
                padded = [np.concatenate([array, np.repeat(array[-1:], _EIGHT - count, axis=0)]) for array in arrays]
                result[:] = self._spread(kernel, size, own, each, None, *padded)[:count]
            return result
        flat = [own, *[apart(array, out).reshape(-1) for array in arrays], np.asarray(result).reshape(-1)]
        groups, rest = divmod(count, _EIGHT)
        threads = min(self.threads, groups)
        if threads <= 1:
            self._part(kernel, size, 0, groups * _EIGHT, flat)
        else:
            # Several pieces a thread, since other work may hold one of them up.
            edges = (np.linspace(0, groups, min(groups, 8 * threads) + 1).astype(int) * _EIGHT).tolist()
            part = partial(self._part, kernel, size, flat=flat)
            share(part, list(pairwise(edges)), threads)
        if rest:
            self._part(kernel, size, count - _EIGHT, count, flat)
        return result

    def _part(self, kernel: Callable[..., None], size: int, first: int, last: int, flat: Sequence[Array]) -> None:
        """Run a kernel over rows whose number is a multiple of eight, in a workspace that nobody else has meanwhile."""
        ws = self._workspace(size)
        kernel(first, last, self._tree, self._constants, ws, *flat)
        self._rooms.append(ws)

    def _workspace(self, size: int) -> Array:
        """Room for so many numbers that no other thread has: one that a call gave back, since fresh memory is slow at first."""
        try:
            room = self._rooms.pop()
        except IndexError:
            return aligned(size)
        return room if len(room) >= size else aligned(size)


def _constants(model: LaneModel, row: Array) -> Array:
    """Constants of the bodies by a parameter row."""
    from harness.denoc.joint_laws import laws
    from harness.denoc.lanes.rows import prepare_lane

    ahead.ready("lane_parameters")
    links, tree, sizes, axes, nominal, plane = model.tables
    n = model.n
    constants = np.zeros(len(tree) * nodes.CONSTANTS * 8)
    slots = np.zeros(n * laws.WIDTH * 8)
    prepare_lane(row, 0, links, tree, axes, nominal, plane, constants, np.zeros(8 * int(sizes[1])), slots, np.zeros(64))
    rows = np.zeros((n, kernels.CONSTANTS))
    rows[:, : nodes.CONSTANTS] = constants.reshape(n, nodes.CONSTANTS, 8)[:, :, 0]
    acting = slots.reshape(n, laws.WIDTH, 8)[:, :, 0]
    for column, slot in (
        (kernels.ARMATURE, laws.ARMATURE),
        (kernels.DAMPING, laws.DAMPING),
        (kernels.STIFFNESS, laws.STIFFNESS),
        (kernels.REST, laws.REST),
    ):
        rows[:, column] = acting[:, slot]
    return rows.reshape(-1)


def _integers(model: LaneModel) -> tuple[Any, int]:
    """Integers of the bodies, and the number of accumulators."""
    tree, n = model.tables[1], model.n
    integers = np.full((n, kernels.COLUMNS), -1, dtype=np.int64)
    integers[:, kernels.PARENT] = tree[:, nodes.PARENT]
    integers[:, kernels.PRISMATIC] = tree[:, nodes.KIND] == nodes.PRISMATIC
    integers[:, kernels.PREFIX] = tree[:, nodes.PREFIX]
    free: list[int] = []
    held: dict[int, int] = {}
    most = 0
    # In the order of the sweep inward: an accumulator is taken when first written and free again once read.
    for i in range(n - 1, -1, -1):
        if i in held:
            integers[i, kernels.TAKES] = held[i]
            free.append(held.pop(i))
        parent = int(tree[i, nodes.PARENT])
        if parent < 0:
            continue
        integers[i, kernels.OPENS] = parent not in held
        if parent not in held:
            if not free:
                free.append(most)
                most += 1
            held[parent] = free.pop()
        integers[i, kernels.GIVES] = held[parent]
    return integers, most
