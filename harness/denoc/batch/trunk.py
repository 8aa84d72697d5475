"""What floats freely and carries all else, as one body of six degrees: its motion before a sweep, its acceleration after.

The tree is the lowered one (``system.lowering``), whose first five bodies have no mass: only what stands on the sixth, the
trunk, is swept. Between the sweeps its articulated inertia I and bias p give the acceleration, I a = w − p, by six
eliminations without pivots: I is positive definite.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.chart.kernels import rotation
from harness.denoc.lanes.spatial import turn_forward
from harness.denoc.simd.vector import gather, in_place, load_run, scatter, store_run

BODIES = 6  # of the lowered tree, of which the last is the trunk
# Of the trunk: gravity in the axes that it moves in (3), cosine and sine of the turn about z from its link's axes to those of its
# body, its joint's damping.
GRAVITY, LINK, RESISTING = 0, 3, 5
NUMBERS = 6


@in_place
def motion(base: int, n: int, trunk: Any, ws: Any, at: int, q: Any, qd: Any) -> Any:
    """Spin and velocity of eight trunks in their bodies' axes; the rotations to these are kept in the workspace at ``at``.

    base: where the first row of the velocities begins, n numbers each; those of the positions are longer by one.
    """
    place = base // n * (n + 1) + 3
    turn = rotation(
        gather(q, place, n + 1), gather(q, place + 1, n + 1), gather(q, place + 2, n + 1), gather(q, place + 3, n + 1)
    )
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = turn
    c, s = trunk[LINK], trunk[LINK + 1]
    e00, e10 = turn_forward(c, s, r00, r01)
    e01, e11 = turn_forward(c, s, r10, r11)
    e02, e12 = turn_forward(c, s, r20, r21)
    store_run(ws, at, (e00, e01, e02, e10, e11, e12, r02, r12, r22))
    x, y, z = gather(qd, base, n), gather(qd, base + 1, n), gather(qd, base + 2, n)
    wx, wy = turn_forward(c, s, gather(qd, base + 3, n), gather(qd, base + 4, n))
    return (
        wx, wy, gather(qd, base + 5, n),
        e00 * x + e01 * y + e02 * z, e10 * x + e11 * y + e12 * z, r02 * x + r12 * y + r22 * z,
    )  # fmt: skip


@in_place
def wrench(base: int, n: int, trunk: Any, ws: Any, at: int, tau: Any, twist: Any) -> Any:
    """Moment and force on eight trunks in their bodies' axes, what their joints resist counted."""
    wx, wy, wz, vx, vy, vz = twist
    e00, e01, e02, e10, e11, e12, e20, e21, e22 = load_run(ws, at, 9)
    x, y, z = gather(tau, base, n), gather(tau, base + 1, n), gather(tau, base + 2, n)
    nx, ny = turn_forward(trunk[LINK], trunk[LINK + 1], gather(tau, base + 3, n), gather(tau, base + 4, n))
    d = trunk[RESISTING]
    return (
        nx - d * wx, ny - d * wy, gather(tau, base + 5, n) - d * wz,
        e00 * x + e01 * y + e02 * z - d * vx, e10 * x + e11 * y + e12 * z - d * vy, e20 * x + e21 * y + e22 * z - d * vz,
    )  # fmt: skip


@in_place
def acceleration(angular: Any, mixed: Any, linear: Any, force: Any) -> Any:
    """I⁻¹ times a wrench (moment, force), by elimination of the force's rows first and of the moment's after them."""
    axx, ayy, azz, axy, axz, ayz = angular
    bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
    mxx, myy, mzz, mxy, mxz, myz = linear
    nx, ny, nz, fx, fy, fz = force
    # Unknowns x of the columns z, y, x of M, then z, y, x of A; d the inverse of a pivot, l what a row is less by.
    d6 = 1.0 / mzz
    l5, l4, l3, l2, l1 = myz * d6, mxz * d6, bzz * d6, byz * d6, bxz * d6
    mxx, mxy, myy = mxx - l4 * mxz, mxy - l4 * myz, myy - l5 * myz
    bxx, bxy = bxx - l1 * mxz, bxy - l1 * myz
    byx, byy = byx - l2 * mxz, byy - l2 * myz
    bzx, bzy = bzx - l3 * mxz, bzy - l3 * myz
    axx, axy, axz = axx - l1 * bxz, axy - l1 * byz, axz - l1 * bzz
    ayy, ayz, azz = ayy - l2 * byz, ayz - l2 * bzz, azz - l3 * bzz
    fx, fy, nx, ny, nz = fx - l4 * fz, fy - l5 * fz, nx - l1 * fz, ny - l2 * fz, nz - l3 * fz
    d5 = 1.0 / myy
    k4, k3, k2, k1 = mxy * d5, bzy * d5, byy * d5, bxy * d5
    mxx = mxx - k4 * mxy
    bxx, byx, bzx = bxx - k1 * mxy, byx - k2 * mxy, bzx - k3 * mxy
    axx, axy, axz = axx - k1 * bxy, axy - k1 * byy, axz - k1 * bzy
    ayy, ayz, azz = ayy - k2 * byy, ayz - k2 * bzy, azz - k3 * bzy
    fx, nx, ny, nz = fx - k4 * fy, nx - k1 * fy, ny - k2 * fy, nz - k3 * fy
    d4 = 1.0 / mxx
    j3, j2, j1 = bzx * d4, byx * d4, bxx * d4
    axx, axy, axz = axx - j1 * bxx, axy - j1 * byx, axz - j1 * bzx
    ayy, ayz, azz = ayy - j2 * byx, ayz - j2 * bzx, azz - j3 * bzx
    nx, ny, nz = nx - j1 * fx, ny - j2 * fx, nz - j3 * fx
    d3 = 1.0 / azz
    i2, i1 = ayz * d3, axz * d3
    axx, axy, ayy = axx - i1 * axz, axy - i1 * ayz, ayy - i2 * ayz
    nx, ny = nx - i1 * nz, ny - i2 * nz
    d2 = 1.0 / ayy
    h1 = axy * d2
    wx = (nx - h1 * ny) / (axx - h1 * axy)
    wy = ny * d2 - h1 * wx
    wz = nz * d3 - i2 * wy - i1 * wx
    vx = fx * d4 - j3 * wz - j2 * wy - j1 * wx
    vy = fy * d5 - k4 * vx - k3 * wz - k2 * wy - k1 * wx
    vz = fz * d6 - l5 * vy - l4 * vx - l3 * wz - l2 * wy - l1 * wx
    return wx, wy, wz, vx, vy, vz


@in_place
def write(base: int, n: int, trunk: Any, ws: Any, at: int, twist: Any, found: Any, out: Any) -> None:
    """Accelerations of the joint's velocities from those of the bodies less gravity, into the rows of ``out``."""
    wx, wy, wz, vx, vy, vz = twist
    ax, ay, az, x, y, z = found
    # Of a point that the body carries along, and not of the body's axes: ω × v.
    x, y, z = x + (wy * vz - wz * vy), y + (wz * vx - wx * vz), z + (wx * vy - wy * vx)
    e00, e01, e02, e10, e11, e12, e20, e21, e22 = load_run(ws, at, 9)
    scatter(out, base, n, e00 * x + e10 * y + e20 * z + trunk[GRAVITY])
    scatter(out, base + 1, n, e01 * x + e11 * y + e21 * z + trunk[GRAVITY + 1])
    scatter(out, base + 2, n, e02 * x + e12 * y + e22 * z + trunk[GRAVITY + 2])
    ax, ay = turn_forward(trunk[LINK], -trunk[LINK + 1], ax, ay)
    scatter(out, base + 3, n, ax)
    scatter(out, base + 4, n, ay)
    scatter(out, base + 5, n, az)
