"""The dynamics of closed mechanisms as functions at an address, for ``recursion.dynamics_call``.

Names at module level are all they use: a compiled function that closes over another is never found in the cache again.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from typing import Any

from numba import cfunc

from harness.denoc.compiling.compiled import allocating
from harness.denoc.compiling.pipeline import Kernel
from harness.denoc.loops import columns, factors
from harness.denoc.loops import places as at_
from harness.denoc.loops.elimination import NOTHING, shortest
from harness.denoc.loops.places import numbers_of, places_of
from harness.denoc.loops.tables import (
    ACCELERATION,
    COLUMNS,
    CONDITIONS,
    KIND,
    NQ,
    SHIFT,
    VALUE,
    VELOCITY,
    N,
)
from harness.denoc.recursion.binding import (
    RATES,
    RECURSION,
    SETTLE,
    TREE,
    header_at,
    rows_of,
    topology_of,
    vector_at,
)
from harness.denoc.recursion.dynamics_call import SIGNATURE, call

# Positions are corrected until nothing is open by more, over the mechanism's size or in radians.
_SHUT = 1e-14
_CORRECTIONS = 6
# Next to a singular position a motion is lost to the conditions, and with it what they say of where it goes on: rounding ε of a
# position, s away from it, tilts what they hold by ε / s². Within this distance corrections leave that motion alone.
_NEARLY_SINGULAR = 1e-4


@functools.cache
def address() -> int:
    """Where the dynamics of closed mechanisms stand, all of them: what is compiled apart is compiled twice.

    (header, q, q̇, τ, q̈): forward dynamics. (header, q, q̇, 0, 0): closes positions and velocities again. (header, q, q̇, 0, out):
    value, rate and acceleration (joint accelerations zero) of all conditions, (c, 3), then their Jacobian, (c, n).
    """
    return int(_dynamics().address)


@functools.cache
def called() -> Callable[[int, int, int, int, int], int]:
    """The same for a call from Python."""
    return ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 5)(address())


@functools.cache
def _dynamics() -> Any:
    @cfunc(SIGNATURE, cache=True, pipeline_class=Kernel)
    def dynamics(model: int, q: int, qd: int, third: int, out: int) -> int:
        if out == 0:
            return close_again(model, q, qd)
        if third == 0:
            return describe(model, q, qd, out)
        return closed_forward(model, q, qd, third, out)

    return dynamics


@allocating
def closed_forward(model: int, q: int, qd: int, tau: int, qdd: int) -> int:
    """Accelerations with the constraint forces eliminated: the free ones, and the least change of them that the loops ask."""
    header = header_at(model)
    tree = header[TREE]
    places = places_of(header)
    x = numbers_of(header, places)
    n = places[N]
    d, t = rows_of(header), topology_of(header)
    position, velocity, out = vector_at(q, places[NQ]), vector_at(qd, n), vector_at(qdd, n)
    z = at_.vector(places, 5)
    if places[COLUMNS] == 0:
        status = call(header_at(tree)[RECURSION], tree, q, qd, tau, qdd)
        if status != 0:
            return status
        factors.at_state(places, x, d, t, position, velocity, out)
        factors.equations(places, x, d, t, ACCELERATION)
        shortest(places, x, z, NOTHING)
        factors.add(places, x, d, t, z, out)
        return 0
    status = columns.linearise(places, x, tree, d, t, q, qd, velocity, position)
    if status == 0:
        status = columns.factor(places, x)
    if status != 0:
        return status
    free = columns.accelerations(places, x, vector_at(tau, n))
    columns.equations(places, x, ACCELERATION, free)
    shortest(places, x, z, NOTHING)
    for i in range(n):
        out[i] = x[free + i]
    columns.add(places, x, z, out)
    return 0


@allocating
def close_again(model: int, q: int, qd: int) -> int:
    """Positions and velocities back to where the loops are closed, by the least change in the norm of the mass matrix."""
    header = header_at(model)
    tree = header[TREE]
    places = places_of(header)
    x = numbers_of(header, places)
    n = places[N]
    d, t = rows_of(header), topology_of(header)
    position, velocity = vector_at(q, places[NQ]), vector_at(qd, n)
    z, step = at_.vector(places, 5), at_.vector(places, 4)
    change = x[step : step + n]
    idle, made = x.ctypes.data + 8 * at_.vector(places, 0), x.ctypes.data + 8 * at_.vector(places, 2)
    inner = header_at(tree)
    for correction in range(_CORRECTIONS + 1):
        if places[COLUMNS] == 0:
            for i in range(n):
                x[at_.vector(places, 0) + i] = 0.0
            status = call(inner[RECURSION], tree, q, qd, idle, made)
            if status == 0:
                factors.at_state(places, x, d, t, position, velocity, change)
        else:
            status = columns.linearise(places, x, tree, d, t, q, qd, velocity, position)
            if status == 0:
                status = columns.factor(places, x)
        if status != 0:
            return status
        if correction == _CORRECTIONS or open_by(places, x) <= _SHUT:
            break
        _solve(places, x, d, t, VALUE, z, change)
        if inner[RATES] != 0:
            rate = at_.nq_vector(places)
            call(inner[RATES], tree, q, x.ctypes.data + 8 * step, 0, x.ctypes.data + 8 * rate)
            for i in range(places[NQ]):
                position[i] += x[rate + i]
            if inner[SETTLE] != 0:
                call(inner[SETTLE], tree, q, qd, 0, 0)
        else:
            for i in range(n):
                position[i] += change[i]
    _solve(places, x, d, t, VELOCITY, z, change)
    for i in range(n):
        # What dry friction holds stays held.
        if velocity[i] != 0.0 or abs(change[i]) > 1e-14:
            velocity[i] += change[i]
    if inner[SETTLE] != 0:
        call(inner[SETTLE], tree, q, qd, 0, 0)
    return 0


@allocating
def _solve(places: Any, x: Any, d: Any, t: Any, which: int, z: int, change: Any) -> None:
    """The least change that makes number ``which`` of all conditions' states zero."""
    for i in range(places[N]):
        change[i] = 0.0
    if places[COLUMNS] == 0:
        factors.equations(places, x, d, t, which)
        shortest(places, x, z, _NEARLY_SINGULAR)
        factors.add(places, x, d, t, z, change)
    else:
        columns.equations(places, x, which, -1)
        shortest(places, x, z, _NEARLY_SINGULAR)
        columns.add(places, x, z, change)


@allocating
def open_by(places: Any, x: Any) -> float:
    """The largest opening, shifts over the mechanism's size."""
    worst = 0.0
    for k in range(places[CONDITIONS]):
        unit = x[0] if places[at_.condition(places, k) + KIND] == SHIFT else 1.0
        worst = max(worst, abs(x[at_.state(places, k) + VALUE]) / unit)
    return worst


@allocating
def describe(model: int, q: int, qd: int, out: int) -> int:
    """Value, rate and acceleration (joint accelerations zero) of all conditions, and their Jacobian, one after the other."""
    header = header_at(model)
    places = places_of(header)
    x = numbers_of(header, places)
    n, c = places[N], places[CONDITIONS]
    d, t = rows_of(header), topology_of(header)
    velocity, position = vector_at(qd, n), vector_at(q, places[NQ])
    status = columns.linearise(places, x, header[TREE], d, t, q, qd, velocity, position)
    found = vector_at(out, c * (3 + n))
    row = at_.row(places, 0)
    for k in range(c):
        for i in range(3):
            found[3 * k + i] = x[at_.state(places, k) + i]
        columns.jacobian_row(places, x, k, row)
        for j in range(n):
            found[3 * c + k * n + j] = x[row + j]
    return status
