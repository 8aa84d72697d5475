"""Loops over a rigid tree by the factors U D Uᵀ that its articulated-body recursion leaves behind: O(n) in the tree.

A condition is a wrench at each of two bodies. Swept inwards over their ancestors alone it gives a row of D^(-1/2) L⁻¹ Jᵀ, L being
the factor of the mass matrix M = L D Lᵀ: the inverse of the operational-space inertia at the cuts is this times its transpose.
What the conditions add to accelerations is swept outwards once.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.compiling.compiled import internal
from harness.denoc.loops import places as at_
from harness.denoc.loops.conditions import evaluate, place_frames, triple
from harness.denoc.loops.tables import CONDITIONS, COUPLED, FIRST, HEAD, KIND, OF, ORIGIN, SECOND, N
from harness.denoc.recursion.rigid import advance_origin, move_joint, put_motion
from harness.denoc.recursion.rows import COLUMN, FORCE, PARENT, PIVOT, POSITION, REACH, REVOLUTE, TURN
from harness.denoc.recursion.rows import KIND as JOINT
from harness.denoc.recursion.triples import cross, minus, plus

Places = Any
Numbers = Any
Rows = Any
Topology = Any
Vector = Any


@internal
def at_state(places: Places, x: Numbers, d: Rows, t: Topology, q: Vector, v: Vector, a: Vector) -> None:
    """The conditions where the forward dynamics of the tree have just been asked; a: their accelerations."""
    n = places[N]
    for i in range(1, n + 1):
        advance_origin(d, t, i, v[i - 1])
    place_frames(places, x, d)
    evaluate(places, x, q, v, a)


@internal
def equations(places: Places, x: Numbers, d: Rows, t: Topology, which: int) -> None:
    """Rows y_k and right-hand sides, the latter minus number ``which`` of each condition's state."""
    n = places[N]
    for k in range(places[CONDITIONS]):
        here, s, out = at_.condition(places, k), at_.state(places, k), at_.row(places, k)
        for i in range(n):
            x[out + i] = 0.0
        x[out + n] = -x[s + which]
        of = places[here + OF]
        if places[here + KIND] == COUPLED:
            coupled = at_.coupling(places, of)
            _force(x, d, t, places[coupled + 1] + 1, 1.0, out)
            if places[coupled + 3] >= 0:
                _force(x, d, t, places[coupled + 3] + 1, -x[s + FIRST], out)
            continue
        for side in range(2):
            weigh = s + (FIRST if side == 0 else SECOND)
            body, frame = places[HEAD + 2 * of + side], at_.moving(places, 2 * of + side)
            arm = minus(triple(x, frame + ORIGIN), triple(d[body], POSITION))
            force = triple(x, weigh + 3)
            _wrench(x, d, t, body, plus(triple(x, weigh), cross(arm, force)), force, out)


@internal
def _wrench(
    x: Numbers,
    d: Rows,
    t: Topology,
    body: int,
    moment: tuple[float, float, float],
    force: tuple[float, float, float],
    out: int,
) -> None:
    """Add what a wrench on a body, at its origin, gives to a row; swept inwards."""
    nx, ny, nz = moment
    fx, fy, fz = force
    i = body
    while i > 0:
        zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
        u = zx * nx + zy * ny + zz * nz if t[i, JOINT] == REVOLUTE else zx * fx + zy * fy + zz * fz
        x[out + i - 1] += u * np.sqrt(d[i, PIVOT])
        u *= d[i, PIVOT]
        nx, ny, nz = nx - d[i, COLUMN] * u, ny - d[i, COLUMN + 1] * u, nz - d[i, COLUMN + 2] * u
        fx, fy, fz = fx - d[i, COLUMN + 3] * u, fy - d[i, COLUMN + 4] * u, fz - d[i, COLUMN + 5] * u
        rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
        nx, ny, nz = nx + ry * fz - rz * fy, ny + rz * fx - rx * fz, nz + rx * fy - ry * fx
        i = t[i, PARENT]


@internal
def _force(x: Numbers, d: Rows, t: Topology, body: int, size: float, out: int) -> None:
    """Add what a generalized force at a body's joint gives to a row."""
    x[out + body - 1] += size * np.sqrt(d[body, PIVOT])
    u = -size * d[body, PIVOT]
    fx, fy, fz = d[body, COLUMN + 3] * u, d[body, COLUMN + 4] * u, d[body, COLUMN + 5] * u
    rx, ry, rz = d[body, REACH], d[body, REACH + 1], d[body, REACH + 2]
    nx = d[body, COLUMN] * u + ry * fz - rz * fy
    ny = d[body, COLUMN + 1] * u + rz * fx - rx * fz
    nz = d[body, COLUMN + 2] * u + rx * fy - ry * fx
    _wrench(x, d, t, t[body, PARENT], (nx, ny, nz), (fx, fy, fz), out)


@internal
def add(places: Places, x: Numbers, d: Rows, t: Topology, z: int, out: Vector) -> None:
    """Add the solution z at x[z:] to accelerations (or velocities, or a step of positions), swept outwards.

    Twists of the bodies stand in FORCE while this runs.
    """
    for k in range(6):
        d[0, FORCE + k] = 0.0
    for i in range(1, places[N] + 1):
        p = t[i, PARENT]
        rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
        wx, wy, wz = d[p, FORCE], d[p, FORCE + 1], d[p, FORCE + 2]
        ax = d[p, FORCE + 3] + wy * rz - wz * ry
        ay = d[p, FORCE + 4] + wz * rx - wx * rz
        az = d[p, FORCE + 5] + wx * ry - wy * rx
        along = d[i, COLUMN] * wx + d[i, COLUMN + 1] * wy + d[i, COLUMN + 2] * wz
        along += d[i, COLUMN + 3] * ax + d[i, COLUMN + 4] * ay + d[i, COLUMN + 5] * az
        change = np.sqrt(d[i, PIVOT]) * x[z + i - 1] - d[i, PIVOT] * along
        out[i - 1] += change
        wx, wy, wz, ax, ay, az = move_joint(d, t, i, change, wx, wy, wz, ax, ay, az)
        put_motion(d, i, FORCE, wx, wy, wz, ax, ay, az)
