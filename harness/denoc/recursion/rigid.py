"""Recursions for trees of rigid links, O(n), without allocation.

The DeNOC form N_dᵀ N_lᵀ M N_l N_d q̈ + … = τ is solved by eliminating one joint after the other from the tips to the
base (U D Uᵀ). Twists and wrenches are in base axes at each body's own origin, accelerations are true accelerations of
the origin (so linear velocities never enter).

Arguments everywhere: n bodies; ``d`` packed rows (n + 1, WIDTH) and ``t`` integers (n + 1, COLUMNS) as in ``rows``.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.compiling.compiled import compiled, inlined, internal
from harness.denoc.recursion.rows import (
    ACCELERATION,
    ARMATURE,
    BIAS,
    COLUMN,
    DAMPING,
    DRIVE,
    EXTERNAL,
    FORCE,
    INERTIA,
    KIND,
    MASS,
    MOMENT,
    OFFSET,
    PARENT,
    PIVOT,
    PLACE,
    POSITION,
    REACH,
    REST,
    REVOLUTE,
    SPIN,
    STIFFNESS,
    TURN,
    VELOCITY,
    B,
    J,
    M,
)
from harness.denoc.recursion.trig import sincos

Rows = Any  # float64 (n + 1, WIDTH)
Topology = Any  # int64 (n + 1, COLUMNS)
Vector = Any
Matrix = Any


Six = tuple[float, float, float, float, float, float]
Nine = tuple[float, float, float, float, float, float, float, float, float]


@inlined
def orient(d: Rows, t: Topology, i: int, q: float) -> Six:
    """Rotation R and reach r of body i from its parent's, to its row; returns r and the joint's axis z."""
    p = t[i, PARENT]
    a0, a1, a2 = d[p, TURN], d[p, TURN + 1], d[p, TURN + 2]
    a3, a4, a5 = d[p, TURN + 3], d[p, TURN + 4], d[p, TURN + 5]
    a6, a7, a8 = d[p, TURN + 6], d[p, TURN + 7], d[p, TURN + 8]
    return orient_on(d, t, i, q, (a0, a1, a2, a3, a4, a5, a6, a7, a8))


@inlined
def orient_on(d: Rows, t: Topology, i: int, q: float, carrier: Nine) -> Six:
    """As ``orient``, on a carrier of that rotation, by rows; r from where the joint's offset is counted."""
    a0, a1, a2, a3, a4, a5, a6, a7, a8 = carrier
    x, y, z = d[i, OFFSET], d[i, OFFSET + 1], d[i, OFFSET + 2]
    rx = a0 * x + a1 * y + a2 * z
    ry = a3 * x + a4 * y + a5 * z
    rz = a6 * x + a7 * y + a8 * z
    e0, e1, e2 = d[i, PLACE], d[i, PLACE + 1], d[i, PLACE + 2]
    e3, e4, e5 = d[i, PLACE + 3], d[i, PLACE + 4], d[i, PLACE + 5]
    e6, e7, e8 = d[i, PLACE + 6], d[i, PLACE + 7], d[i, PLACE + 8]
    b0 = a0 * e0 + a1 * e3 + a2 * e6
    b1 = a0 * e1 + a1 * e4 + a2 * e7
    zx = a0 * e2 + a1 * e5 + a2 * e8
    b3 = a3 * e0 + a4 * e3 + a5 * e6
    b4 = a3 * e1 + a4 * e4 + a5 * e7
    zy = a3 * e2 + a4 * e5 + a5 * e8
    b6 = a6 * e0 + a7 * e3 + a8 * e6
    b7 = a6 * e1 + a7 * e4 + a8 * e7
    zz = a6 * e2 + a7 * e5 + a8 * e8
    if t[i, KIND] == REVOLUTE:
        s, c = sincos(q)
        b0, b1 = b0 * c + b1 * s, b1 * c - b0 * s
        b3, b4 = b3 * c + b4 * s, b4 * c - b3 * s
        b6, b7 = b6 * c + b7 * s, b7 * c - b6 * s
    else:
        rx, ry, rz = rx + zx * q, ry + zy * q, rz + zz * q
    d[i, TURN], d[i, TURN + 1], d[i, TURN + 2] = b0, b1, zx
    d[i, TURN + 3], d[i, TURN + 4], d[i, TURN + 5] = b3, b4, zy
    d[i, TURN + 6], d[i, TURN + 7], d[i, TURN + 8] = b6, b7, zz
    d[i, REACH], d[i, REACH + 1], d[i, REACH + 2] = rx, ry, rz
    return rx, ry, rz, zx, zy, zz


@inlined
def place(d: Rows, t: Topology, i: int, q: float, v: float) -> None:
    """Rotation R, reach r, spin ω and velocity-product acceleration of body i from its parent's."""
    p = t[i, PARENT]
    wx, wy, wz = d[p, SPIN], d[p, SPIN + 1], d[p, SPIN + 2]
    rx, ry, rz, zx, zy, zz = orient(d, t, i, q)
    if t[i, KIND] == REVOLUTE:
        # ω_p × (ω_p × r), and ω_p × z q̇ for the rotation.
        hx, hy, hz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
        ux, uy, uz = zx * v, zy * v, zz * v
        d[i, BIAS] = wy * uz - wz * uy
        d[i, BIAS + 1] = wz * ux - wx * uz
        d[i, BIAS + 2] = wx * uy - wy * ux
        d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2] = wx + ux, wy + uy, wz + uz
    else:
        # ω_p × (ω_p × r + 2 z q̇): centrifugal and Coriolis acceleration of the slide.
        hx = wy * rz - wz * ry + 2.0 * v * zx
        hy = wz * rx - wx * rz + 2.0 * v * zy
        hz = wx * ry - wy * rx + 2.0 * v * zz
        d[i, BIAS], d[i, BIAS + 1], d[i, BIAS + 2] = 0.0, 0.0, 0.0
        d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2] = wx, wy, wz
    d[i, BIAS + 3] = wy * hz - wz * hy
    d[i, BIAS + 4] = wz * hx - wx * hz
    d[i, BIAS + 5] = wx * hy - wy * hx


@inlined
def turn_moments(d: Rows, i: int) -> tuple[float, float, float]:
    """The rigid body's own inertia about its origin, in base axes, to J; returns its first moment in base axes."""
    r0, r1, r2 = d[i, TURN], d[i, TURN + 1], d[i, TURN + 2]
    r3, r4, r5 = d[i, TURN + 3], d[i, TURN + 4], d[i, TURN + 5]
    r6, r7, r8 = d[i, TURN + 6], d[i, TURN + 7], d[i, TURN + 8]
    x, y, z = d[i, MOMENT], d[i, MOMENT + 1], d[i, MOMENT + 2]
    cx = r0 * x + r1 * y + r2 * z
    cy = r3 * x + r4 * y + r5 * z
    cz = r6 * x + r7 * y + r8 * z
    k0, k1, k2 = d[i, INERTIA], d[i, INERTIA + 1], d[i, INERTIA + 2]
    k3, k4, k5 = d[i, INERTIA + 3], d[i, INERTIA + 4], d[i, INERTIA + 5]
    b0, b1, b2 = r0 * k0 + r1 * k1 + r2 * k2, r0 * k1 + r1 * k3 + r2 * k4, r0 * k2 + r1 * k4 + r2 * k5
    b3, b4, b5 = r3 * k0 + r4 * k1 + r5 * k2, r3 * k1 + r4 * k3 + r5 * k4, r3 * k2 + r4 * k4 + r5 * k5
    b6, b7, b8 = r6 * k0 + r7 * k1 + r8 * k2, r6 * k1 + r7 * k3 + r8 * k4, r6 * k2 + r7 * k4 + r8 * k5
    j0 = b0 * r0 + b1 * r1 + b2 * r2
    j1 = b0 * r3 + b1 * r4 + b2 * r5
    j2 = b0 * r6 + b1 * r7 + b2 * r8
    j3 = b3 * r3 + b4 * r4 + b5 * r5
    j4 = b3 * r6 + b4 * r7 + b5 * r8
    j5 = b6 * r6 + b7 * r7 + b8 * r8
    d[i, J], d[i, J + 1], d[i, J + 2], d[i, J + 3], d[i, J + 4], d[i, J + 5] = j0, j1, j2, j3, j4, j5
    return cx, cy, cz


@inlined
def turn_inertia(d: Rows, i: int) -> None:
    """The rigid body's own inertia in base axes, and its bias wrench ω×Jω, ω×(ω×mc) less the external wrench."""
    cx, cy, cz = turn_moments(d, i)
    j0, j1, j2, j3, j4, j5 = d[i, J], d[i, J + 1], d[i, J + 2], d[i, J + 3], d[i, J + 4], d[i, J + 5]
    d[i, B], d[i, B + 1], d[i, B + 2] = 0.0, -cz, cy
    d[i, B + 3], d[i, B + 4], d[i, B + 5] = cz, 0.0, -cx
    d[i, B + 6], d[i, B + 7], d[i, B + 8] = -cy, cx, 0.0
    m = d[i, MASS]
    d[i, M], d[i, M + 1], d[i, M + 2], d[i, M + 3], d[i, M + 4], d[i, M + 5] = m, 0.0, 0.0, m, 0.0, m
    wx, wy, wz = d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2]
    hx, hy, hz = j0 * wx + j1 * wy + j2 * wz, j1 * wx + j3 * wy + j4 * wz, j2 * wx + j4 * wy + j5 * wz
    d[i, FORCE] = wy * hz - wz * hy - d[i, EXTERNAL]
    d[i, FORCE + 1] = wz * hx - wx * hz - d[i, EXTERNAL + 1]
    d[i, FORCE + 2] = wx * hy - wy * hx - d[i, EXTERNAL + 2]
    hx, hy, hz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
    d[i, FORCE + 3] = wy * hz - wz * hy - d[i, EXTERNAL + 3]
    d[i, FORCE + 4] = wz * hx - wx * hz - d[i, EXTERNAL + 4]
    d[i, FORCE + 5] = wx * hy - wy * hx - d[i, EXTERNAL + 5]


@inlined
def add_shifted_inertia(
    d: Rows,
    p: int,
    rx: float,
    ry: float,
    rz: float,
    j: tuple[float, float, float, float, float, float],
    b: tuple[float, float, float, float, float, float, float, float, float],
    m: tuple[float, float, float, float, float, float],
) -> None:
    """Add a 6×6 inertia [J B; Bᵀ M], taken at distance r from body p's origin, to body p's."""
    j0, j1, j2, j3, j4, j5 = j
    b0, b1, b2, b3, b4, b5, b6, b7, b8 = b
    m0, m1, m2, m3, m4, m5 = m
    # B' = B + [r] M;  J' = J - B [r] + [r] B'ᵀ.
    c0, c1, c2 = b0 - rz * m1 + ry * m2, b1 - rz * m3 + ry * m4, b2 - rz * m4 + ry * m5
    c3, c4, c5 = b3 + rz * m0 - rx * m2, b4 + rz * m1 - rx * m4, b5 + rz * m2 - rx * m5
    c6, c7, c8 = b6 - ry * m0 + rx * m1, b7 - ry * m1 + rx * m3, b8 - ry * m2 + rx * m4
    d[p, J] += j0 - (b1 * rz - b2 * ry) + (ry * c2 - rz * c1)
    d[p, J + 1] += j1 - (b2 * rx - b0 * rz) + (ry * c5 - rz * c4)
    d[p, J + 2] += j2 - (b0 * ry - b1 * rx) + (ry * c8 - rz * c7)
    d[p, J + 3] += j3 - (b5 * rx - b3 * rz) + (rz * c3 - rx * c5)
    d[p, J + 4] += j4 - (b3 * ry - b4 * rx) + (rz * c6 - rx * c8)
    d[p, J + 5] += j5 - (b6 * ry - b7 * rx) + (rx * c7 - ry * c6)
    d[p, B] += c0
    d[p, B + 1] += c1
    d[p, B + 2] += c2
    d[p, B + 3] += c3
    d[p, B + 4] += c4
    d[p, B + 5] += c5
    d[p, B + 6] += c6
    d[p, B + 7] += c7
    d[p, B + 8] += c8
    d[p, M] += m0
    d[p, M + 1] += m1
    d[p, M + 2] += m2
    d[p, M + 3] += m3
    d[p, M + 4] += m4
    d[p, M + 5] += m5


@inlined
def add_shifted_wrench(
    d: Rows, p: int, rx: float, ry: float, rz: float, nx: float, ny: float, nz: float, fx: float, fy: float, fz: float
) -> None:
    """Add a wrench, moment and force at distance r from body p's origin, to body p's."""
    d[p, FORCE] += nx + ry * fz - rz * fy
    d[p, FORCE + 1] += ny + rz * fx - rx * fz
    d[p, FORCE + 2] += nz + rx * fy - ry * fx
    d[p, FORCE + 3] += fx
    d[p, FORCE + 4] += fy
    d[p, FORCE + 5] += fz


@internal
def forward_dynamics(n: int, d: Rows, t: Topology, q: Vector, qd: Vector, tau: Vector, qdd: Vector) -> int:
    """Accelerations by the articulated-body recursion; 0, or the row of the outermost body with D <= 0."""
    singular = 0
    for i in range(1, n + 1):
        place(d, t, i, q[i - 1], qd[i - 1])
        turn_inertia(d, i)
    for i in range(n, 0, -1):
        p = t[i, PARENT]
        j0, j1, j2, j3, j4, j5 = d[i, J], d[i, J + 1], d[i, J + 2], d[i, J + 3], d[i, J + 4], d[i, J + 5]
        b0, b1, b2 = d[i, B], d[i, B + 1], d[i, B + 2]
        b3, b4, b5 = d[i, B + 3], d[i, B + 4], d[i, B + 5]
        b6, b7, b8 = d[i, B + 6], d[i, B + 7], d[i, B + 8]
        m0, m1, m2, m3, m4, m5 = d[i, M], d[i, M + 1], d[i, M + 2], d[i, M + 3], d[i, M + 4], d[i, M + 5]
        nx, ny, nz = d[i, FORCE], d[i, FORCE + 1], d[i, FORCE + 2]
        fx, fy, fz = d[i, FORCE + 3], d[i, FORCE + 4], d[i, FORCE + 5]
        zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
        u = tau[i - 1] - d[i, DAMPING] * qd[i - 1] - d[i, STIFFNESS] * (q[i - 1] - d[i, REST])
        if t[i, KIND] == REVOLUTE:
            u0, u1, u2 = j0 * zx + j1 * zy + j2 * zz, j1 * zx + j3 * zy + j4 * zz, j2 * zx + j4 * zy + j5 * zz
            u3, u4, u5 = b0 * zx + b3 * zy + b6 * zz, b1 * zx + b4 * zy + b7 * zz, b2 * zx + b5 * zy + b8 * zz
            pivot = u0 * zx + u1 * zy + u2 * zz + d[i, ARMATURE]
            u -= zx * nx + zy * ny + zz * nz
        else:
            u0, u1, u2 = b0 * zx + b1 * zy + b2 * zz, b3 * zx + b4 * zy + b5 * zz, b6 * zx + b7 * zy + b8 * zz
            u3, u4, u5 = m0 * zx + m1 * zy + m2 * zz, m1 * zx + m3 * zy + m4 * zz, m2 * zx + m4 * zy + m5 * zz
            pivot = u3 * zx + u4 * zy + u5 * zz + d[i, ARMATURE]
            u -= zx * fx + zy * fy + zz * fz
        # What divides by nothing makes everything further in no number: the outermost is the one.
        if singular == 0 and not pivot > 0.0:
            singular = i
        inverse = 1.0 / pivot
        d[i, COLUMN], d[i, COLUMN + 1], d[i, COLUMN + 2] = u0, u1, u2
        d[i, COLUMN + 3], d[i, COLUMN + 4], d[i, COLUMN + 5] = u3, u4, u5
        d[i, PIVOT], d[i, DRIVE] = inverse, u
        if p > 0:
            v0, v1, v2, v3, v4, v5 = u0 * inverse, u1 * inverse, u2 * inverse, u3 * inverse, u4 * inverse, u5 * inverse
            j0, j1, j2, j3, j4, j5 = j0 - v0 * u0, j1 - v0 * u1, j2 - v0 * u2, j3 - v1 * u1, j4 - v1 * u2, j5 - v2 * u2
            b0, b1, b2 = b0 - v0 * u3, b1 - v0 * u4, b2 - v0 * u5
            b3, b4, b5 = b3 - v1 * u3, b4 - v1 * u4, b5 - v1 * u5
            b6, b7, b8 = b6 - v2 * u3, b7 - v2 * u4, b8 - v2 * u5
            m0, m1, m2, m3, m4, m5 = m0 - v3 * u3, m1 - v3 * u4, m2 - v3 * u5, m3 - v4 * u4, m4 - v4 * u5, m5 - v5 * u5
            a0, a1, a2 = d[i, BIAS], d[i, BIAS + 1], d[i, BIAS + 2]
            a3, a4, a5 = d[i, BIAS + 3], d[i, BIAS + 4], d[i, BIAS + 5]
            nx += v0 * u + j0 * a0 + j1 * a1 + j2 * a2 + b0 * a3 + b1 * a4 + b2 * a5
            ny += v1 * u + j1 * a0 + j3 * a1 + j4 * a2 + b3 * a3 + b4 * a4 + b5 * a5
            nz += v2 * u + j2 * a0 + j4 * a1 + j5 * a2 + b6 * a3 + b7 * a4 + b8 * a5
            fx += v3 * u + b0 * a0 + b3 * a1 + b6 * a2 + m0 * a3 + m1 * a4 + m2 * a5
            fy += v4 * u + b1 * a0 + b4 * a1 + b7 * a2 + m1 * a3 + m3 * a4 + m4 * a5
            fz += v5 * u + b2 * a0 + b5 * a1 + b8 * a2 + m2 * a3 + m4 * a4 + m5 * a5
            rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
            add_shifted_inertia(
                d,
                p,
                rx,
                ry,
                rz,
                (j0, j1, j2, j3, j4, j5),
                (b0, b1, b2, b3, b4, b5, b6, b7, b8),
                (m0, m1, m2, m3, m4, m5),
            )
            add_shifted_wrench(d, p, rx, ry, rz, nx, ny, nz, fx, fy, fz)
    for i in range(1, n + 1):
        p = t[i, PARENT]
        wx, wy, wz, ax, ay, az = ride(d, i, p)
        a = d[i, PIVOT] * (
            d[i, DRIVE]
            - d[i, COLUMN] * wx
            - d[i, COLUMN + 1] * wy
            - d[i, COLUMN + 2] * wz
            - d[i, COLUMN + 3] * ax
            - d[i, COLUMN + 4] * ay
            - d[i, COLUMN + 5] * az
        )
        qdd[i - 1] = a
        wx, wy, wz, ax, ay, az = move_joint(d, t, i, a, wx, wy, wz, ax, ay, az)
        put_motion(d, i, ACCELERATION, wx, wy, wz, ax, ay, az)
    return singular


@inlined
def ride(d: Rows, i: int, p: int) -> tuple[float, float, float, float, float, float]:
    """Angular and linear acceleration body i would have without its joint's own: the parent's, shifted, plus bias."""
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    wx, wy, wz = d[p, ACCELERATION], d[p, ACCELERATION + 1], d[p, ACCELERATION + 2]
    ax = d[p, ACCELERATION + 3] + d[i, BIAS + 3] + (wy * rz - wz * ry)
    ay = d[p, ACCELERATION + 4] + d[i, BIAS + 4] + (wz * rx - wx * rz)
    az = d[p, ACCELERATION + 5] + d[i, BIAS + 5] + (wx * ry - wy * rx)
    return wx + d[i, BIAS], wy + d[i, BIAS + 1], wz + d[i, BIAS + 2], ax, ay, az


@inlined
def move_joint(
    d: Rows, t: Topology, i: int, a: float, wx: float, wy: float, wz: float, vx: float, vy: float, vz: float
) -> Six:
    """A motion of body i, angular and linear, with its joint's own on top, which moves by a."""
    zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
    if t[i, KIND] == REVOLUTE:
        wx, wy, wz = wx + zx * a, wy + zy * a, wz + zz * a
    else:
        vx, vy, vz = vx + zx * a, vy + zy * a, vz + zz * a
    return wx, wy, wz, vx, vy, vz


@inlined
def put_motion(d: Rows, i: int, at: int, wx: float, wy: float, wz: float, vx: float, vy: float, vz: float) -> None:
    """Write a motion, angular and linear, to body i's row."""
    d[i, at], d[i, at + 1], d[i, at + 2] = wx, wy, wz
    d[i, at + 3], d[i, at + 4], d[i, at + 5] = vx, vy, vz


@internal
def inverse_dynamics(n: int, d: Rows, t: Topology, q: Vector, qd: Vector, qdd: Vector, tau: Vector) -> None:
    """Generalized forces without passive ones: twists outwards, wrenches inwards (Newton-Euler, N_dᵀ N_lᵀ w)."""
    for i in range(1, n + 1):
        p = t[i, PARENT]
        place(d, t, i, q[i - 1], qd[i - 1])
        turn_inertia(d, i)
        wx, wy, wz, ax, ay, az = ride(d, i, p)
        a = qdd[i - 1]
        wx, wy, wz, ax, ay, az = move_joint(d, t, i, a, wx, wy, wz, ax, ay, az)
        put_motion(d, i, ACCELERATION, wx, wy, wz, ax, ay, az)
        # J α + mc × a, and m a + α × mc; B = [mc].
        cx, cy, cz, m = d[i, B + 7], d[i, B + 2], d[i, B + 3], d[i, M]
        d[i, FORCE] += d[i, J] * wx + d[i, J + 1] * wy + d[i, J + 2] * wz + cy * az - cz * ay
        d[i, FORCE + 1] += d[i, J + 1] * wx + d[i, J + 3] * wy + d[i, J + 4] * wz + cz * ax - cx * az
        d[i, FORCE + 2] += d[i, J + 2] * wx + d[i, J + 4] * wy + d[i, J + 5] * wz + cx * ay - cy * ax
        d[i, FORCE + 3] += m * ax + wy * cz - wz * cy
        d[i, FORCE + 4] += m * ay + wz * cx - wx * cz
        d[i, FORCE + 5] += m * az + wx * cy - wy * cx
    for i in range(n, 0, -1):
        p = t[i, PARENT]
        zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
        fx, fy, fz = d[i, FORCE + 3], d[i, FORCE + 4], d[i, FORCE + 5]
        if t[i, KIND] == REVOLUTE:
            along = zx * d[i, FORCE] + zy * d[i, FORCE + 1] + zz * d[i, FORCE + 2]
        else:
            along = zx * fx + zy * fy + zz * fz
        tau[i - 1] = along + d[i, ARMATURE] * qdd[i - 1]
        rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
        add_shifted_wrench(d, p, rx, ry, rz, d[i, FORCE], d[i, FORCE + 1], d[i, FORCE + 2], fx, fy, fz)


@internal
def advance_origin(d: Rows, t: Topology, i: int, v: float) -> None:
    """Position and velocity of body i's origin in base coordinates, once the body is placed."""
    p = t[i, PARENT]
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    wx, wy, wz = d[p, SPIN], d[p, SPIN + 1], d[p, SPIN + 2]
    slide = 0.0 if t[i, KIND] == REVOLUTE else v
    d[i, POSITION] = d[p, POSITION] + rx
    d[i, POSITION + 1] = d[p, POSITION + 1] + ry
    d[i, POSITION + 2] = d[p, POSITION + 2] + rz
    d[i, VELOCITY] = d[p, VELOCITY] + wy * rz - wz * ry + slide * d[i, TURN + 2]
    d[i, VELOCITY + 1] = d[p, VELOCITY + 1] + wz * rx - wx * rz + slide * d[i, TURN + 5]
    d[i, VELOCITY + 2] = d[p, VELOCITY + 2] + wx * ry - wy * rx + slide * d[i, TURN + 8]


@compiled
def momentum(n: int, d: Rows, t: Topology, q: Vector, qd: Vector, out: Vector) -> None:
    """out: angular (3) about the base's origin and linear (3) momentum."""
    lx, ly, lz, px, py, pz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(1, n + 1):
        place(d, t, i, q[i - 1], qd[i - 1])
        advance_origin(d, t, i, qd[i - 1])
        turn_inertia(d, i)
        m, cx, cy, cz = d[i, M], d[i, B + 7], d[i, B + 2], d[i, B + 3]
        x, y, z = d[i, POSITION], d[i, POSITION + 1], d[i, POSITION + 2]
        vx, vy, vz = d[i, VELOCITY], d[i, VELOCITY + 1], d[i, VELOCITY + 2]
        wx, wy, wz = d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2]
        fx, fy, fz = m * vx + wy * cz - wz * cy, m * vy + wz * cx - wx * cz, m * vz + wx * cy - wy * cx
        nx = d[i, J] * wx + d[i, J + 1] * wy + d[i, J + 2] * wz + cy * vz - cz * vy
        ny = d[i, J + 1] * wx + d[i, J + 3] * wy + d[i, J + 4] * wz + cz * vx - cx * vz
        nz = d[i, J + 2] * wx + d[i, J + 4] * wy + d[i, J + 5] * wz + cx * vy - cy * vx
        lx, ly, lz = lx + nx + y * fz - z * fy, ly + ny + z * fx - x * fz, lz + nz + x * fy - y * fx
        px, py, pz = px + fx, py + fy, pz + fz
    out[0], out[1], out[2], out[3], out[4], out[5] = lx, ly, lz, px, py, pz


@compiled
def locate(n: int, d: Rows, t: Topology, q: Vector, qd: Vector) -> None:
    """Pose, spin and velocity of every body into the rows."""
    for i in range(1, n + 1):
        place(d, t, i, q[i - 1], qd[i - 1])
        advance_origin(d, t, i, qd[i - 1])


@compiled
def coriolis_matrix(n: int, d: Rows, t: Topology, q: Vector, qd: Vector, c: Matrix) -> None:
    """A matrix C with C q̇ the velocity forces and Ṁ - 2C skew; one sweep out and in for each column, O(n²).

    C = Σ_k J_kᵀ (M_k J̇_k + D_k J_k) over bodies k, J_k the twist's Jacobian at the body's origin in base axes and
    D_k = [[ω]I 0; -[ω×mc] 0], for which Ṁ_k - 2 D_k is skew and D_k t_k is the body's bias wrench.
    """
    for i in range(1, n + 1):
        place(d, t, i, q[i - 1], qd[i - 1])
        advance_origin(d, t, i, qd[i - 1])
        turn_inertia(d, i)
    for j in range(1, n + 1):
        for i in range(1, n + 1):
            p = t[i, PARENT]
            # Twist of this column in COLUMN, its rate of change in ACCELERATION; bodies before j do not move.
            if i < j or (i != j and d[p, PIVOT] == 0.0):
                d[i, PIVOT] = 0.0
                for k in range(6):
                    d[i, FORCE + k] = 0.0
                continue
            d[i, PIVOT] = 1.0
            zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
            ox, oy, oz = d[p, SPIN], d[p, SPIN + 1], d[p, SPIN + 2]
            if i == j:
                # z turns with the parent: its rate is ω_p × z.
                rate = oy * zz - oz * zy, oz * zx - ox * zz, ox * zy - oy * zx
                if t[i, KIND] == REVOLUTE:
                    tx, ty, tz, sx, sy, sz = zx, zy, zz, 0.0, 0.0, 0.0
                    ax, ay, az, bx, by, bz = rate[0], rate[1], rate[2], 0.0, 0.0, 0.0
                else:
                    tx, ty, tz, sx, sy, sz = 0.0, 0.0, 0.0, zx, zy, zz
                    ax, ay, az, bx, by, bz = 0.0, 0.0, 0.0, rate[0], rate[1], rate[2]
            else:
                rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
                ex = d[i, VELOCITY] - d[p, VELOCITY]
                ey = d[i, VELOCITY + 1] - d[p, VELOCITY + 1]
                ez = d[i, VELOCITY + 2] - d[p, VELOCITY + 2]
                tx, ty, tz = d[p, COLUMN], d[p, COLUMN + 1], d[p, COLUMN + 2]
                ax, ay, az = d[p, ACCELERATION], d[p, ACCELERATION + 1], d[p, ACCELERATION + 2]
                sx = d[p, COLUMN + 3] + ty * rz - tz * ry
                sy = d[p, COLUMN + 4] + tz * rx - tx * rz
                sz = d[p, COLUMN + 5] + tx * ry - ty * rx
                bx = d[p, ACCELERATION + 3] + ay * rz - az * ry + ty * ez - tz * ey
                by = d[p, ACCELERATION + 4] + az * rx - ax * rz + tz * ex - tx * ez
                bz = d[p, ACCELERATION + 5] + ax * ry - ay * rx + tx * ey - ty * ex
            d[i, COLUMN], d[i, COLUMN + 1], d[i, COLUMN + 2] = tx, ty, tz
            d[i, COLUMN + 3], d[i, COLUMN + 4], d[i, COLUMN + 5] = sx, sy, sz
            d[i, ACCELERATION], d[i, ACCELERATION + 1], d[i, ACCELERATION + 2] = ax, ay, az
            d[i, ACCELERATION + 3], d[i, ACCELERATION + 4], d[i, ACCELERATION + 5] = bx, by, bz
            m, cx, cy, cz = d[i, M], d[i, B + 7], d[i, B + 2], d[i, B + 3]
            wx, wy, wz = d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2]
            hx = d[i, J] * tx + d[i, J + 1] * ty + d[i, J + 2] * tz
            hy = d[i, J + 1] * tx + d[i, J + 3] * ty + d[i, J + 4] * tz
            hz = d[i, J + 2] * tx + d[i, J + 4] * ty + d[i, J + 5] * tz
            d[i, FORCE] = d[i, J] * ax + d[i, J + 1] * ay + d[i, J + 2] * az + cy * bz - cz * by + wy * hz - wz * hy
            d[i, FORCE + 1] = (
                d[i, J + 1] * ax + d[i, J + 3] * ay + d[i, J + 4] * az + cz * bx - cx * bz + wz * hx - wx * hz
            )
            d[i, FORCE + 2] = (
                d[i, J + 2] * ax + d[i, J + 4] * ay + d[i, J + 5] * az + cx * by - cy * bx + wx * hy - wy * hx
            )
            ux, uy, uz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
            d[i, FORCE + 3] = m * bx + ay * cz - az * cy + ty * uz - tz * uy
            d[i, FORCE + 4] = m * by + az * cx - ax * cz + tz * ux - tx * uz
            d[i, FORCE + 5] = m * bz + ax * cy - ay * cx + tx * uy - ty * ux
        for i in range(n, 0, -1):
            p = t[i, PARENT]
            fx, fy, fz = d[i, FORCE + 3], d[i, FORCE + 4], d[i, FORCE + 5]
            if t[i, KIND] == REVOLUTE:
                c[i - 1, j - 1] = (
                    d[i, TURN + 2] * d[i, FORCE] + d[i, TURN + 5] * d[i, FORCE + 1] + d[i, TURN + 8] * d[i, FORCE + 2]
                )
            else:
                c[i - 1, j - 1] = d[i, TURN + 2] * fx + d[i, TURN + 5] * fy + d[i, TURN + 8] * fz
            if p > 0:
                rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
                add_shifted_wrench(d, p, rx, ry, rz, d[i, FORCE], d[i, FORCE + 1], d[i, FORCE + 2], fx, fy, fz)


@compiled
def subtract_passive(n: int, d: Rows, t: Topology, q: Vector, qd: Vector, out: Vector) -> None:
    """Take the forces of joint dampers and springs from generalized forces: what is left has to be applied."""
    for i in range(n):
        out[i] += d[i + 1, DAMPING] * qd[i] + d[i + 1, STIFFNESS] * (q[i] - d[i + 1, REST])


@compiled
def energy_rows(n: int, d: Rows, t: Topology, Q: Matrix, Qd: Matrix, out: Matrix) -> None:
    """Kinetic and potential energy of every row; out (B, 2).

    In each body's own axes, where its inertia is constant: what is turned from body to body is spin and velocity (in COLUMN
    while this runs), the base's acceleration in place of gravity (in BIAS) and how high the origin is along it (in PIVOT).
    """
    for k in range(3):
        d[0, COLUMN + k], d[0, COLUMN + 3 + k] = 0.0, 0.0
        d[0, BIAS + k] = d[0, ACCELERATION + 3 + k]
    d[0, PIVOT] = 0.0
    for row in range(len(Q)):
        kinetic, potential = 0.0, 0.0
        for i in range(1, n + 1):
            p = t[i, PARENT]
            q, v = Q[row, i - 1], Qd[row, i - 1]
            rx, ry, rz = d[i, OFFSET], d[i, OFFSET + 1], d[i, OFFSET + 2]
            wx, wy, wz = d[p, COLUMN], d[p, COLUMN + 1], d[p, COLUMN + 2]
            gx, gy, gz = d[p, BIAS], d[p, BIAS + 1], d[p, BIAS + 2]
            height = d[p, PIVOT] + gx * rx + gy * ry + gz * rz
            vx = d[p, COLUMN + 3] + wy * rz - wz * ry
            vy = d[p, COLUMN + 4] + wz * rx - wx * rz
            vz = d[p, COLUMN + 5] + wx * ry - wy * rx
            sliding = t[i, KIND] != REVOLUTE
            s, c = (0.0, 1.0) if sliding else sincos(q)
            wx, wy, wz = _into_body(d, i, s, c, wx, wy, wz)
            vx, vy, vz = _into_body(d, i, s, c, vx, vy, vz)
            gx, gy, gz = _into_body(d, i, s, c, gx, gy, gz)
            if sliding:
                vx, vy, vz = vx + wy * q, vy - wx * q, vz + v
                height += gz * q
            else:
                wz += v
            d[i, COLUMN], d[i, COLUMN + 1], d[i, COLUMN + 2] = wx, wy, wz
            d[i, COLUMN + 3], d[i, COLUMN + 4], d[i, COLUMN + 5] = vx, vy, vz
            d[i, BIAS], d[i, BIAS + 1], d[i, BIAS + 2] = gx, gy, gz
            d[i, PIVOT] = height
            m, cx, cy, cz = d[i, MASS], d[i, MOMENT], d[i, MOMENT + 1], d[i, MOMENT + 2]
            k0, k1, k2 = d[i, INERTIA], d[i, INERTIA + 1], d[i, INERTIA + 2]
            k3, k4, k5 = d[i, INERTIA + 3], d[i, INERTIA + 4], d[i, INERTIA + 5]
            nx, ny, nz = k0 * wx + k1 * wy + k2 * wz, k1 * wx + k3 * wy + k4 * wz, k2 * wx + k4 * wy + k5 * wz
            # m v + 2 ω × mc: the first moment's share is in it twice, once as it acts on ω and once on v.
            fx = m * vx + 2.0 * (wy * cz - wz * cy)
            fy = m * vy + 2.0 * (wz * cx - wx * cz)
            fz = m * vz + 2.0 * (wx * cy - wy * cx)
            kinetic += wx * nx + wy * ny + wz * nz + vx * fx + vy * fy + vz * fz + d[i, ARMATURE] * v * v
            stretch = q - d[i, REST]
            potential += m * height + gx * cx + gy * cy + gz * cz + 0.5 * d[i, STIFFNESS] * stretch * stretch
        out[row, 0], out[row, 1] = 0.5 * kinetic, potential


@inlined
def _into_body(d: Rows, i: int, s: float, c: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """A vector in the axes of body i, from those of its parent; s, c: sine and cosine of the joint's angle."""
    u = d[i, PLACE] * x + d[i, PLACE + 3] * y + d[i, PLACE + 6] * z
    w = d[i, PLACE + 1] * x + d[i, PLACE + 4] * y + d[i, PLACE + 7] * z
    return u * c + w * s, w * c - u * s, d[i, PLACE + 2] * x + d[i, PLACE + 5] * y + d[i, PLACE + 8] * z
