"""Generalized inertia matrix of a tree of rigid links from composite bodies: I_ij = p_iᵀ M̃_i A_ij p_j for every ancestor j of i.

Rows are as in ``rigid``. Bodies that follow one another without branching are taken in runs of eight. Within a run, the
wrench that a joint's unit acceleration needs is carried from body to body. To the runs further in it is carried from run to
run, to the origin of the last body there, and there multiplied with the motions that the run's eight joints give that origin,
eight at a time. No arm is longer than the distance between the two joints, so that nothing grows with the distance from the
base.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.compiling.compiled import allocating, compiled, internal
from harness.denoc.recursion.rigid import Matrix, Rows, Topology, Vector, orient, turn_moments
from harness.denoc.recursion.rows import ARMATURE, KIND, MASS, PARENT, REACH, REVOLUTE, RUN, SLOT, TURN, B, J, M
from harness.denoc.simd.vector import load, store, vectors

# One run's motions (angular, linear; 6 × 8 numbers), and the way to it from the body that it hangs on (3).
WAY = 48
RUN_SIZE = 56
# Behind the runs: wrenches of one run's joints (6 × 8), and a row of results.
WRENCHES, RESULTS, SCRATCH = 0, 48, 56


@allocating
def mass_matrix(n: int, d: Rows, t: Topology, q: Vector, mass: Matrix) -> None:
    """The generalized inertia matrix at q, to ``mass`` (n, n)."""
    straight = True
    for i in range(1, n + 1):
        orient(d, t, i, q[i - 1])
        cx, cy, cz = turn_moments(d, i)
        d[i, B + 7], d[i, B + 2], d[i, B + 3], d[i, M] = cx, cy, cz, d[i, MASS]
        if t[i, PARENT] != i - 1:
            straight = False
    for i in range(n, 0, -1):
        p = t[i, PARENT]
        if p > 0:
            # A composite body is a rigid one: ten numbers, of which B holds the first moment and M the mass.
            rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
            m, cx, cy, cz = d[i, M], d[i, B + 7], d[i, B + 2], d[i, B + 3]
            gx, gy, gz = cx + m * rx, cy + m * ry, cz + m * rz
            along = rx * (cx + gx) + ry * (cy + gy) + rz * (cz + gz)
            d[p, J] += d[i, J] + along - rx * (cx + gx)
            d[p, J + 1] += d[i, J + 1] - rx * cy - gx * ry
            d[p, J + 2] += d[i, J + 2] - rx * cz - gx * rz
            d[p, J + 3] += d[i, J + 3] + along - ry * (cy + gy)
            d[p, J + 4] += d[i, J + 4] - ry * cz - gy * rz
            d[p, J + 5] += d[i, J + 5] + along - rz * (cz + gz)
            d[p, B + 7] += gx
            d[p, B + 2] += gy
            d[p, B + 3] += gz
            d[p, M] += m
    if not straight:
        for i in range(n):
            for k in range(n):
                mass[i, k] = 0.0
    runs = t[n, SLOT] + 1
    # A single run needs no room.
    room = vectors(runs * (RUN_SIZE // 8) + SCRATCH // 8) if runs > 1 else d[0]
    scratch = runs * RUN_SIZE
    first = 1
    while first <= n:
        last = first
        while last < n and t[last + 1, RUN] == first:
            last += 1
        _within_run(d, t, first, last, mass, room, scratch, runs > 1)
        if runs > 1:
            _motions(d, t, first, last, room)
            if t[first, PARENT] > 0:
                _with_runs_before(t, first, last, mass, room, scratch)
        first = last + 1


@internal
def _within_run(
    d: Rows, t: Topology, first: int, last: int, mass: Matrix, room: Vector, scratch: int, more: bool
) -> None:
    """Elements of pairs of one run; wrenches about the origin of the body that the run hangs on, to the scratch."""
    for i in range(first, last + 1):
        zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
        m, cx, cy, cz = d[i, M], d[i, B + 7], d[i, B + 2], d[i, B + 3]
        if t[i, KIND] == REVOLUTE:
            nx = d[i, J] * zx + d[i, J + 1] * zy + d[i, J + 2] * zz
            ny = d[i, J + 1] * zx + d[i, J + 3] * zy + d[i, J + 4] * zz
            nz = d[i, J + 2] * zx + d[i, J + 4] * zy + d[i, J + 5] * zz
            fx, fy, fz = zy * cz - zz * cy, zz * cx - zx * cz, zx * cy - zy * cx
            mass[i - 1, i - 1] = zx * nx + zy * ny + zz * nz + d[i, ARMATURE]
        else:
            nx, ny, nz = cy * zz - cz * zy, cz * zx - cx * zz, cx * zy - cy * zx
            fx, fy, fz = m * zx, m * zy, m * zz
            mass[i - 1, i - 1] = m + d[i, ARMATURE]
        for k in range(i, first - 1, -1):
            rx, ry, rz = d[k, REACH], d[k, REACH + 1], d[k, REACH + 2]
            nx, ny, nz = nx + ry * fz - rz * fy, ny + rz * fx - rx * fz, nz + rx * fy - ry * fx
            if k > first:
                j = k - 1
                zx, zy, zz = d[j, TURN + 2], d[j, TURN + 5], d[j, TURN + 8]
                turns = t[j, KIND] == REVOLUTE
                along = zx * nx + zy * ny + zz * nz if turns else zx * fx + zy * fy + zz * fz
                mass[i - 1, j - 1] = along
                mass[j - 1, i - 1] = along
        if more:
            at = scratch + WRENCHES + i - first
            room[at], room[at + 8], room[at + 16] = nx, ny, nz
            room[at + 24], room[at + 32], room[at + 40] = fx, fy, fz


@internal
def _motions(d: Rows, t: Topology, first: int, last: int, room: Vector) -> None:
    """What unit rates of a run's joints give the origin of its last body, and the way to there, to the run's room."""
    slot = t[first, SLOT] * RUN_SIZE
    x, y, z = 0.0, 0.0, 0.0
    for j in range(last, first - 1, -1):
        at = slot + j - first
        zx, zy, zz = d[j, TURN + 2], d[j, TURN + 5], d[j, TURN + 8]
        if t[j, KIND] == REVOLUTE:
            room[at], room[at + 8], room[at + 16] = zx, zy, zz
            room[at + 24], room[at + 32], room[at + 40] = zy * z - zz * y, zz * x - zx * z, zx * y - zy * x
        else:
            room[at], room[at + 8], room[at + 16] = 0.0, 0.0, 0.0
            room[at + 24], room[at + 32], room[at + 40] = zx, zy, zz
        x, y, z = x + d[j, REACH], y + d[j, REACH + 1], z + d[j, REACH + 2]
    room[slot + WAY], room[slot + WAY + 1], room[slot + WAY + 2] = x, y, z


@internal
def _with_runs_before(t: Topology, first: int, last: int, mass: Matrix, room: Vector, scratch: int) -> None:
    """Elements of one run's joints with the joints of all runs that it hangs on."""
    width = last - first + 1
    hs = scratch + WRENCHES
    h0, h1, h2 = load(room, hs), load(room, hs + 8), load(room, hs + 16)
    h3, h4, h5 = load(room, hs + 24), load(room, hs + 32), load(room, hs + 40)
    end = t[first, PARENT]
    while end > 0:
        # A run is left at its last body: where it branches it ends.
        begin = t[end, RUN]
        slot = t[end, SLOT] * RUN_SIZE
        count = end - begin + 1
        s0, s1, s2 = load(room, slot), load(room, slot + 8), load(room, slot + 16)
        s3, s4, s5 = load(room, slot + 24), load(room, slot + 32), load(room, slot + 40)
        for i in range(width):
            a = hs + i
            row = s0 * room[a] + s1 * room[a + 8] + s2 * room[a + 16]
            row = row + s3 * room[a + 24] + s4 * room[a + 32] + s5 * room[a + 40]
            _put(mass, first - 1 + i, begin - 1, count, row, room, scratch + RESULTS)
        for j in range(count):
            a = slot + j
            row = h0 * room[a] + h1 * room[a + 8] + h2 * room[a + 16]
            row = row + h3 * room[a + 24] + h4 * room[a + 32] + h5 * room[a + 40]
            _put(mass, begin - 1 + j, first - 1, width, row, room, scratch + RESULTS)
        x, y, z = room[slot + WAY], room[slot + WAY + 1], room[slot + WAY + 2]
        h0 = h0 + (h5 * y - h4 * z)
        h1 = h1 + (h3 * z - h5 * x)
        h2 = h2 + (h4 * x - h3 * y)
        store(room, hs, h0)
        store(room, hs + 8, h1)
        store(room, hs + 16, h2)
        end = t[begin, PARENT]


@internal
def _put(mass: Matrix, i: int, j: int, count: int, row: Any, room: Vector, results: int) -> None:
    """The first ``count`` of eight numbers, to ``mass`` from element i, j on."""
    if count == 8:
        store(mass, i * mass.shape[1] + j, row)
    else:
        store(room, results, row)
        for k in range(count):
            mass[i, j + k] = room[results + k]


@compiled
def mass_matrix_rows(n: int, d: Rows, t: Topology, Q: Matrix, out: Any) -> None:
    """``mass_matrix`` for every row."""
    for k in range(len(Q)):
        mass_matrix(n, d, t, Q[k], out[k])
