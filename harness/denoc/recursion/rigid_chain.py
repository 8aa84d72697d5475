"""Accelerations of a short chain of rigid links from its generalized inertia matrix, all bodies at once, one a lane.

A recursion waits for one body after the other. Here all twists and wrenches are in base axes and about one point, the first
joint's origin, where the block lower triangular N_l is made of ones: what it sums from the base outwards, and N_lᵀ from
the tip inwards, takes three additions of moved lanes, and so does the product of the joints' rotations. Then
I = N_dᵀ N_lᵀ M N_l N_d is solved for the accelerations, from the tip to the base.

Moments about one point grow with the distance from it. Where that would cost digits (``fits``), where a joint has turned
through more than ``FARTHEST`` and where a joint moves no inertia, the recursion of ``rigid`` has its turn.

Lanes count the bodies from the tip; those behind the base hold none.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.compiling.compiled import internal
from harness.denoc.recursion.rows import (
    ACCELERATION,
    ARMATURE,
    DAMPING,
    INERTIA,
    KIND,
    MASS,
    MOMENT,
    OFFSET,
    PARENT,
    PLACE,
    REST,
    REVOLUTE,
    STIFFNESS,
)
from harness.denoc.recursion.tree import Tree
from harness.denoc.simd.shuffle import first_lane, moved_outward, spread_lane, summed_inward, summed_outward
from harness.denoc.simd.vector import LANES, aligned, in_place, load, load_run, sine_cosine, spread, store

Array = NDArray[np.float64]

#: Bodies of the chains that gain by it.
FEWEST, MOST = 4, LANES
#: What the carried mass times the square of the chain's length may be of a body's own inertia about its joint: so many times the
#: rounding error of an acceleration.
FARTHEST_OUT = 1e5
#: Of a joint's angle [rad].
FARTHEST = 1e4
#: Status besides 0: not for here.
DECLINED = 1

# Vectors of the table: constants, in the order of a body's row, then room for the state and the result.
_PLACE, _OFFSET, _MASS, _ARMATURE, _DAMPING, _STIFFNESS, _REST = 0, 9, 12, 22, 23, 24, 25
_BASE, _POSITION, _RATE, _EFFORT, _RESULT = 26, 27, 28, 29, 30
SIZE = 31 * LANES


def fits(tree: Tree) -> bool:
    """Whether a mechanism is a chain of few revolute joints, and compact enough for moments about one point."""
    n = tree.bodies
    topology, rows = tree.topology[1:], tree.rows[1:]
    if not FEWEST <= n <= MOST or n != tree.n or tree.beams:
        return False
    if (topology[:, KIND] != REVOLUTE).any() or (topology[:, PARENT] != np.arange(n)).any():
        return False
    mass, moment = rows[:, MASS], np.linalg.norm(rows[:, MOMENT : MOMENT + 3], axis=1)
    arms = np.linalg.norm(rows[1:, OFFSET : OFFSET + 3], axis=1).sum()
    length = arms + np.max(moment / np.maximum(mass, 1e-300), initial=0.0, where=mass > 0.0)
    carried = np.cumsum(mass[::-1])[::-1]
    own = rows[:, INERTIA + 5] + rows[:, ARMATURE]
    return bool((carried * length**2 <= FARTHEST_OUT * own).all())


def pack(tree: Tree) -> Array:
    """The table of a chain, beginning where a cache line does."""
    table = aligned(SIZE)
    table[:] = 0.0
    vectors, n = table.reshape(-1, LANES), tree.bodies
    # Behind the base nothing turns.
    vectors[[_PLACE, _PLACE + 4, _PLACE + 8]] = 1.0
    columns = [*range(PLACE, PLACE + 9), *range(OFFSET, OFFSET + 3), MASS, *range(MOMENT, MOMENT + 3)]
    columns += [*range(INERTIA, INERTIA + 6), ARMATURE, DAMPING, STIFFNESS, REST]
    vectors[: len(columns), :n] = tree.rows[:0:-1, columns].T
    # The point that everything is taken about.
    vectors[_OFFSET : _OFFSET + 3, n - 1] = 0.0
    # The base accelerates against gravity.
    vectors[_BASE, :3] = tree.rows[0, ACCELERATION + 3 : ACCELERATION + 6]
    return table


@in_place
def _cross(ax: Any, ay: Any, az: Any, bx: Any, by: Any, bz: Any) -> Any:
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@in_place
def _composed(parent: Any, own: Any) -> Any:
    """A frame (rotation, origin) given in another one, in the axes that the other is given in."""
    r0, r1, r2, r3, r4, r5, r6, r7, r8, x, y, z = parent
    a0, a1, a2, a3, a4, a5, a6, a7, a8, u, v, w = own
    return (
        r0 * a0 + r1 * a3 + r2 * a6, r0 * a1 + r1 * a4 + r2 * a7, r0 * a2 + r1 * a5 + r2 * a8,
        r3 * a0 + r4 * a3 + r5 * a6, r3 * a1 + r4 * a4 + r5 * a7, r3 * a2 + r4 * a5 + r5 * a8,
        r6 * a0 + r7 * a3 + r8 * a6, r6 * a1 + r7 * a4 + r8 * a7, r6 * a2 + r7 * a5 + r8 * a8,
        x + (r0 * u + r1 * v + r2 * w), y + (r3 * u + r4 * v + r5 * w), z + (r6 * u + r7 * v + r8 * w),
    )  # fmt: skip


@in_place
def _momentum(body: Any, twist: Any) -> Any:
    """Wrench M t of a rigid (or composite) body: m, first moments, second moments xx xy xz yy yz zz."""
    m, gx, gy, gz, jxx, jxy, jxz, jyy, jyz, jzz = body
    wx, wy, wz, vx, vy, vz = twist
    return (
        (jxx * wx + jxy * wy + jxz * wz) + (gy * vz - gz * vy),
        (jxy * wx + jyy * wy + jyz * wz) + (gz * vx - gx * vz),
        (jxz * wx + jyz * wy + jzz * wz) + (gx * vy - gy * vx),
        m * vx - (gy * wz - gz * wy),
        m * vy - (gz * wx - gx * wz),
        m * vz - (gx * wy - gy * wx),
    )


@in_place
def _product(motion: Any, wrench: Any) -> Any:
    """Work of a wrench on a motion."""
    tx, ty, tz, sx, sy, sz = motion
    nx, ny, nz, fx, fy, fz = wrench
    return (tx * nx + ty * ny + tz * nz) + (sx * fx + sy * fy + sz * fz)


@in_place
def _frames(table: Any, position: Any) -> Any:
    """Every body's axes in base axes (9) and its origin from the first one's (3)."""
    c0, c1, c2, c3, c4, c5, c6, c7, c8, x, y, z = load_run(table, _PLACE * 8, 12)
    s, c = sine_cosine(position)
    frames = (c0 * c + c1 * s, c1 * c - c0 * s, c2, c3 * c + c4 * s, c4 * c - c3 * s, c5,
              c6 * c + c7 * s, c7 * c - c6 * s, c8, x, y, z)  # fmt: skip
    one, none = spread(1.0), spread(0.0)
    base = (one, none, none, none, one, none, none, none, one, none, none, none)
    frames = _composed(moved_outward(frames, base, 1), frames)
    frames = _composed(moved_outward(frames, base, 2), frames)
    return _composed(moved_outward(frames, base, 4), frames)


@in_place
def _bodies(table: Any, frames: Any) -> Any:
    """Every body's mass, first and second moments in base axes about the common point."""
    r0, r1, r2, r3, r4, r5, r6, r7, r8, x, y, z = frames
    m, px, py, pz, i0, i1, i2, i3, i4, i5 = load_run(table, _MASS * 8, 10)
    cx, cy, cz = r0 * px + r1 * py + r2 * pz, r3 * px + r4 * py + r5 * pz, r6 * px + r7 * py + r8 * pz
    k0, k1, k2 = r0 * i0 + r1 * i1 + r2 * i2, r0 * i1 + r1 * i3 + r2 * i4, r0 * i2 + r1 * i4 + r2 * i5
    k3, k4, k5 = r3 * i0 + r4 * i1 + r5 * i2, r3 * i1 + r4 * i3 + r5 * i4, r3 * i2 + r4 * i4 + r5 * i5
    k6, k7, k8 = r6 * i0 + r7 * i1 + r8 * i2, r6 * i1 + r7 * i3 + r8 * i4, r6 * i2 + r7 * i4 + r8 * i5
    gx, gy, gz = cx + m * x, cy + m * y, cz + m * z
    along = x * (cx + gx) + y * (cy + gy) + z * (cz + gz)
    return (
        m, gx, gy, gz,
        (k0 * r0 + k1 * r1 + k2 * r2) + (along - x * (cx + gx)),
        (k0 * r3 + k1 * r4 + k2 * r5) - (x * cy + gx * y),
        (k0 * r6 + k1 * r7 + k2 * r8) - (x * cz + gx * z),
        (k3 * r3 + k4 * r4 + k5 * r5) + (along - y * (cy + gy)),
        (k3 * r6 + k4 * r7 + k5 * r8) - (y * cz + gy * z),
        (k6 * r6 + k7 * r7 + k8 * r8) + (along - z * (cz + gz)),
    )  # fmt: skip


@in_place
def _inertial_wrenches(bodies: Any, twists: Any, accelerations: Any) -> Any:
    """M ṫ + W M t: what it takes to move every body as it moves when no joint accelerates."""
    wx, wy, wz, vx, vy, vz = twists
    nx, ny, nz, fx, fy, fz = _momentum(bodies, twists)
    ax, ay, az, bx, by, bz = _momentum(bodies, accelerations)
    return (
        ax + (wy * nz - wz * ny) + (vy * fz - vz * fy),
        ay + (wz * nx - wx * nz) + (vz * fx - vx * fz),
        az + (wx * ny - wy * nx) + (vx * fy - vy * fx),
        bx + (wy * fz - wz * fy),
        by + (wz * fx - wx * fz),
        bz + (wx * fy - wy * fx),
    )


@internal
def forward_dynamics(n: int, table: Any, q: Any, qd: Any, tau: Any, qdd: Any) -> int:
    """Accelerations of a chain; 0, or DECLINED with nothing written.

    table: from ``pack``, written to.
    """
    for i in range(n):
        if not -FARTHEST < q[i] < FARTHEST:
            return DECLINED
        lane = n - 1 - i
        table[_POSITION * 8 + lane], table[_RATE * 8 + lane], table[_EFFORT * 8 + lane] = q[i], qd[i], tau[i]
    position, rate = load(table, _POSITION * 8), load(table, _RATE * 8)
    frames = _frames(table, position)
    # The joints' unit twists, N_d.
    zx, zy, zz = frames[2], frames[5], frames[8]
    lx, ly, lz = _cross(frames[9], frames[10], frames[11], zx, zy, zz)
    motion = (zx, zy, zz, lx, ly, lz)
    own = (zx * rate, zy * rate, zz * rate, lx * rate, ly * rate, lz * rate)
    twists = summed_outward(own)
    # Ṅ_d q̇: the axes turn with the bodies.
    ax, ay, az = _cross(twists[0], twists[1], twists[2], own[0], own[1], own[2])
    bx, by, bz = _cross(twists[0], twists[1], twists[2], own[3], own[4], own[5])
    cx, cy, cz = _cross(twists[3], twists[4], twists[5], own[0], own[1], own[2])
    ax, ay, az, bx, by, bz = summed_outward((ax, ay, az, bx + cx, by + cy, bz + cz))
    up = _BASE * 8
    rates = (ax, ay, az, bx + spread(table[up]), by + spread(table[up + 1]), bz + spread(table[up + 2]))
    bodies = _bodies(table, frames)
    wrenches = summed_inward(_inertial_wrenches(bodies, twists, rates))
    passive = load(table, _DAMPING * 8) * rate + load(table, _STIFFNESS * 8) * (position - load(table, _REST * 8))
    drive = load(table, _EFFORT * 8) - passive - _product(motion, wrenches)
    # Wrench that the composite body needs for a unit acceleration of its joint; row k: the inertia matrix's, from lane k on.
    heavy = _momentum(summed_inward(bodies), motion)
    r0 = _product(motion, spread_lane(heavy, 0))
    r1 = _product(motion, spread_lane(heavy, 1))
    r2 = _product(motion, spread_lane(heavy, 2))
    r3 = _product(motion, spread_lane(heavy, 3))
    r4 = _product(motion, spread_lane(heavy, 4))
    r5 = _product(motion, spread_lane(heavy, 5))
    r6 = _product(motion, spread_lane(heavy, 6))
    r7 = _product(motion, spread_lane(heavy, 7))
    # Gauss and Jordan's elimination of the outermost joint left. What is eliminated leaves at lane 0 and comes in at lane 7 as
    # what the others' accelerations add to its own, so that the last step ends with the accelerations.
    for i in range(n):
        pivot = first_lane(r0) + table[_ARMATURE * 8 + i]
        if not pivot > 0.0:
            return DECLINED
        inverse = 1.0 / pivot
        each = spread(inverse)
        row = r0 * each
        force = first_lane(drive)
        drive = moved_outward(drive - row * spread(force), spread(force * inverse), 1)
        s1, s2, s3 = spread_lane(r0, 1), spread_lane(r0, 2), spread_lane(r0, 3)
        s4, s5, s6, s7 = spread_lane(r0, 4), spread_lane(r0, 5), spread_lane(r0, 6), spread_lane(r0, 7)
        # The next pivot waits for the division alone: its product is ready by then.
        r0 = moved_outward(r1 - (s1 * r0) * each, s1 * each, 1)
        r1 = moved_outward(r2 - s2 * row, s2 * each, 1)
        r2 = moved_outward(r3 - s3 * row, s3 * each, 1)
        r3 = moved_outward(r4 - s4 * row, s4 * each, 1)
        r4 = moved_outward(r5 - s5 * row, s5 * each, 1)
        r5 = moved_outward(r6 - s6 * row, s6 * each, 1)
        r6 = moved_outward(r7 - s7 * row, s7 * each, 1)
    store(table, _RESULT * 8, drive)
    for i in range(n):
        qdd[i] = table[_RESULT * 8 + LANES - 1 - i]
    return 0
