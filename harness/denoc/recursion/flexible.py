"""Recursions for trees of rigid and flexible links, O(n m³), without allocation.

A flexible link's twist is extended by its modal rates, its block of the inertia from 6×6 to (6 + m)×(6 + m):

    [J B Nω; Bᵀ M Nv; Nωᵀ Nvᵀ A],   N = [Nω; Nv] the coupling of hub and modes, A the modal inertia,

and what hangs on a section enters through that section's partial twists (Ψ_k, D_k). Elimination takes the modes first
(Cholesky of A), then the joint. Kinematics, of which everything here is the exact consequence:

    point of the beam   ρ = (x - ½ bᵀ H b) f + (s·b) h + (s₂·b) n           partial velocity d_k = s_k h + s₂_k n - (H b)_k f
    section's rotation  about n by s'·b, then about -h by s₂'·b, then about f by the twist

Arguments everywhere: ``bodies``; rows ``d`` and integers ``t`` as in ``rows``; ``e`` packed beams as in ``elastic``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.compiling.compiled import compiled, inlined, internal
from harness.denoc.recursion.dynamics_call import call
from harness.denoc.recursion.elastic import AXES, HAS_TIP_INERTIA, HEAD, POLAR, TIP_INERTIA
from harness.denoc.recursion.rigid import add_shifted_inertia, add_shifted_wrench, orient_on, turn_inertia
from harness.denoc.recursion.rigid import place as place_rigidly
from harness.denoc.recursion.rows import (
    ACCELERATION,
    ARMATURE,
    BEAM,
    BIAS,
    COLUMN,
    DAMPING,
    DRIVE,
    EXTENDED,
    FIRST,
    FIXED,
    FORCE,
    KIND,
    MODES,
    PARENT,
    PIVOT,
    POINTS,
    POSITION,
    PRISMATIC,
    REACH,
    REST,
    REVOLUTE,
    SPIN,
    STATION,
    STIFFNESS,
    TURN,
    VELOCITY,
    B,
    J,
    M,
)
from harness.denoc.recursion.trig import sincos

Rows = Any  # float64 (bodies + 1, WIDTH)
Topology = Any  # int64 (bodies + 1, COLUMNS)
Beams = Any  # float64 (size,)
Vector = Any
Matrix = Any
Triple = tuple[float, float, float]


@internal
def cross(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> Triple:
    """The vector product a × b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@internal
def tilt(e: Beams, at: int, m: int, b: Vector, bd: Vector, first: int) -> tuple[float, ...]:
    """Angles ψ1, ψ2, φ of a section and their rates, from its constants at ``at``."""
    one, two, twist = 0.0, 0.0, 0.0
    one_rate, two_rate, twist_rate = 0.0, 0.0, 0.0
    k0 = at + 1 + 2 * m + m * m
    for k in range(m):
        one += e[k0 + k] * b[first + k]
        two += e[k0 + m + k] * b[first + k]
        twist += e[k0 + 2 * m + k] * b[first + k]
        one_rate += e[k0 + k] * bd[first + k]
        two_rate += e[k0 + m + k] * bd[first + k]
        twist_rate += e[k0 + 2 * m + k] * bd[first + k]
    return one, two, twist, one_rate, two_rate, twist_rate


@internal
def bent_place(
    e: Beams, at: int, m: int, b: Vector, bd: Vector, first: int, hb: int
) -> tuple[float, float, float, float, float, float, float]:
    """Place (a, u, w) of a section or point along f, h, n, its rate, and the bias of ä; (H b)_k is left at ``hb``."""
    stretch, rate, bias = 0.0, 0.0, 0.0
    u, w, ud, wd = 0.0, 0.0, 0.0, 0.0
    h = at + 1 + 2 * m
    for k in range(m):
        hbk, hdk = 0.0, 0.0
        for l in range(m):
            hbk += e[h + k * m + l] * b[first + l]
            hdk += e[h + k * m + l] * bd[first + l]
        e[hb + k] = hbk
        stretch += hbk * b[first + k]
        rate += hbk * bd[first + k]
        bias += hdk * bd[first + k]
        u += e[at + 1 + k] * b[first + k]
        w += e[at + 1 + m + k] * b[first + k]
        ud += e[at + 1 + k] * bd[first + k]
        wd += e[at + 1 + m + k] * bd[first + k]
    return e[at] - 0.5 * stretch, u, w, -rate, ud, wd, -bias


@internal
def beam_axes(d: Rows, e: Beams, i: int, beam: int) -> tuple[float, ...]:
    """f, h and n of body i's beam in base axes."""
    hub = d[i, TURN : TURN + 9]
    axes = e[beam + AXES : beam + AXES + 9]
    fx = hub[0] * axes[0] + hub[1] * axes[3] + hub[2] * axes[6]
    fy = hub[3] * axes[0] + hub[4] * axes[3] + hub[5] * axes[6]
    fz = hub[6] * axes[0] + hub[7] * axes[3] + hub[8] * axes[6]
    hx = hub[0] * axes[1] + hub[1] * axes[4] + hub[2] * axes[7]
    hy = hub[3] * axes[1] + hub[4] * axes[4] + hub[5] * axes[7]
    hz = hub[6] * axes[1] + hub[7] * axes[4] + hub[8] * axes[7]
    nx, ny, nz = cross(fx, fy, fz, hx, hy, hz)
    return fx, fy, fz, hx, hy, hz, nx, ny, nz


@internal
def ride_on_section(d: Rows, t: Topology, e: Beams, i: int, q: Vector, qd: Vector) -> None:
    """Pose, spin and velocity-product acceleration of body i whose joint sits on a section of its flexible parent."""
    p = t[i, PARENT]
    at = t[i, STATION]
    m = t[p, MODES]
    first = t[p, FIRST] + (1 if t[p, KIND] != FIXED else 0)
    scratch = t[p, EXTENDED] + m * m + 14 * m
    axes = e[t[p, BEAM] + AXES : t[p, BEAM] + AXES + 9]
    fx, fy, fz, hx, hy, hz, nx, ny, nz = beam_axes(d, e, p, t[p, BEAM])
    a, u, w, ad, ud, wd, add = bent_place(e, at, m, q, qd, first, scratch)
    one, two, twist, one_rate, two_rate, twist_rate = tilt(e, at, m, q, qd, first)
    s1, c1 = sincos(one)
    s2, c2 = sincos(two)
    s3, c3 = sincos(twist)
    # Axes the section turns about: n; then -h turned by ψ1; then f turned by ψ1 and ψ2, which is the section's own f.
    ax2, ay2, az2 = fx * s1 - hx * c1, fy * s1 - hy * c1, fz * s1 - hz * c1
    gx, gy, gz = fx * c1 + hx * s1, fy * c1 + hy * s1, fz * c1 + hz * s1
    ax3, ay3, az3 = gx * c2 + nx * s2, gy * c2 + ny * s2, gz * c2 + nz * s2
    # The section's n before twist is n c2 - g s2; twist mixes it with its h = -axis 2.
    kx, ky, kz = nx * c2 - gx * s2, ny * c2 - gy * s2, nz * c2 - gz * s2
    vx, vy, vz = -ax2 * c3 + kx * s3, -ay2 * c3 + ky * s3, -az2 * c3 + kz * s3
    kx, ky, kz = kx * c3 + ax2 * s3, ky * c3 + ay2 * s3, kz * c3 + az2 * s3
    # Rotation of the section: its f, h, n in base axes times (f, h, n in body axes)ᵀ.
    r0, r1, r2 = (
        ax3 * axes[0] + vx * axes[1] + kx * axes[2],
        ax3 * axes[3] + vx * axes[4] + kx * axes[5],
        ax3 * axes[6] + vx * axes[7] + kx * axes[8],
    )
    r3, r4, r5 = (
        ay3 * axes[0] + vy * axes[1] + ky * axes[2],
        ay3 * axes[3] + vy * axes[4] + ky * axes[5],
        ay3 * axes[6] + vy * axes[7] + ky * axes[8],
    )
    r6, r7, r8 = (
        az3 * axes[0] + vz * axes[1] + kz * axes[2],
        az3 * axes[3] + vz * axes[4] + kz * axes[5],
        az3 * axes[6] + vz * axes[7] + kz * axes[8],
    )
    # Spins after each elementary rotation, and the angular acceleration that velocities alone make.
    wx, wy, wz = d[p, SPIN], d[p, SPIN + 1], d[p, SPIN + 2]
    bx, by, bz = cross(wx, wy, wz, nx * one_rate, ny * one_rate, nz * one_rate)
    ox, oy, oz = wx + nx * one_rate, wy + ny * one_rate, wz + nz * one_rate
    tx, ty, tz = cross(ox, oy, oz, ax2 * two_rate, ay2 * two_rate, az2 * two_rate)
    bx, by, bz = bx + tx, by + ty, bz + tz
    ox, oy, oz = ox + ax2 * two_rate, oy + ay2 * two_rate, oz + az2 * two_rate
    tx, ty, tz = cross(ox, oy, oz, ax3 * twist_rate, ay3 * twist_rate, az3 * twist_rate)
    bx, by, bz = bx + tx, by + ty, bz + tz
    ox, oy, oz = ox + ax3 * twist_rate, oy + ay3 * twist_rate, oz + az3 * twist_rate
    # The joint on the turned section; a welded one stands at zero.
    own = t[i, FIRST]
    moves = t[i, KIND] != FIXED
    angle, rate = (q[own], qd[own]) if moves else (0.0, 0.0)
    px, py, pz, z0, z1, z2 = orient_on(d, t, i, angle, (r0, r1, r2, r3, r4, r5, r6, r7, r8))
    slide = rate if t[i, KIND] == PRISMATIC else 0.0
    spin = rate if t[i, KIND] == REVOLUTE else 0.0
    # Section's point against the hub: ρ, its rate in the hub's axes, and ω×(ω×ρ + 2 ρ̇) + f ä.
    qx, qy, qz = fx * a + hx * u + nx * w, fy * a + hy * u + ny * w, fz * a + hz * u + nz * w
    ex, ey, ez = fx * ad + hx * ud + nx * wd, fy * ad + hy * ud + ny * wd, fz * ad + hz * ud + nz * wd
    tx, ty, tz = cross(wx, wy, wz, qx, qy, qz)
    tx, ty, tz = cross(wx, wy, wz, tx + 2.0 * ex, ty + 2.0 * ey, tz + 2.0 * ez)
    lx, ly, lz = tx + fx * add, ty + fy * add, tz + fz * add
    tx, ty, tz = cross(bx, by, bz, px, py, pz)
    lx, ly, lz = lx + tx, ly + ty, lz + tz
    tx, ty, tz = cross(ox, oy, oz, px, py, pz)
    tx, ty, tz = cross(ox, oy, oz, tx + 2.0 * slide * z0, ty + 2.0 * slide * z1, tz + 2.0 * slide * z2)
    d[i, BIAS + 3], d[i, BIAS + 4], d[i, BIAS + 5] = lx + tx, ly + ty, lz + tz
    tx, ty, tz = cross(ox, oy, oz, z0 * spin, z1 * spin, z2 * spin)
    d[i, BIAS], d[i, BIAS + 1], d[i, BIAS + 2] = bx + tx, by + ty, bz + tz
    d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2] = ox + z0 * spin, oy + z1 * spin, oz + z2 * spin
    d[i, REACH], d[i, REACH + 1], d[i, REACH + 2] = qx + px, qy + py, qz + pz
    # Partial twists of the joint's point in each mode.
    out = at + 1 + 5 * m + m * m
    k0 = at + 1 + 2 * m + m * m
    for k in range(m):
        o1, o2, o3 = e[k0 + k], e[k0 + m + k], e[k0 + 2 * m + k]
        tx = nx * o1 + ax2 * o2 + ax3 * o3
        ty = ny * o1 + ay2 * o2 + ay3 * o3
        tz = nz * o1 + az2 * o2 + az3 * o3
        vx, vy, vz = cross(tx, ty, tz, px, py, pz)
        s1, s2, s3 = e[at + 1 + k], e[at + 1 + m + k], -e[scratch + k]
        e[out + 6 * k], e[out + 6 * k + 1], e[out + 6 * k + 2] = tx, ty, tz
        e[out + 6 * k + 3] = vx + fx * s3 + hx * s1 + nx * s2
        e[out + 6 * k + 4] = vy + fy * s3 + hy * s1 + ny * s2
        e[out + 6 * k + 5] = vz + fz * s3 + hz * s1 + nz * s2


@internal
def place(d: Rows, t: Topology, e: Beams, i: int, q: Vector, qd: Vector) -> None:
    """Pose, spin and velocity-product acceleration of body i from its parent's."""
    if t[i, STATION] >= 0:
        ride_on_section(d, t, e, i, q, qd)
    else:
        own = t[i, FIRST]
        moves = t[i, KIND] != FIXED
        place_rigidly(d, t, i, q[own] if moves else 0.0, qd[own] if moves else 0.0)


@internal
def bend(d: Rows, t: Topology, e: Beams, i: int, b: Vector, bd: Vector) -> None:
    """Add the beam's inertia and bias to the body's row, and fill the coupling N, modal inertia A and modal bias.

    Worked in the beam's axes (f, h, n), then turned to base axes.
    """
    m = t[i, MODES]
    first = t[i, FIRST] + (1 if t[i, KIND] != FIXED else 0)
    beam = t[i, BEAM]
    n_at = t[i, EXTENDED]
    a_at = n_at + 6 * m
    p_at = a_at + m * m
    hb = n_at + m * m + 14 * m
    fx, fy, fz, hx, hy, hz, nx, ny, nz = beam_axes(d, e, i, beam)
    wx, wy, wz = d[i, SPIN], d[i, SPIN + 1], d[i, SPIN + 2]
    w1, w2, w3 = wx * fx + wy * fy + wz * fz, wx * hx + wy * hy + wz * hz, wx * nx + wy * ny + wz * nz
    for k in range(6 * m + m * m + m):
        e[n_at + k] = 0.0
    mass, c1, c2, c3 = 0.0, 0.0, 0.0, 0.0
    j11, j12, j13, j22, j23, j33 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    m1, m2, m3, g1, g2, g3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = 2 + 2 * m + m * m
    at = beam + HEAD + 3 * m * m + m + 1 + 5 * m + m * m
    for _ in range(t[i, POINTS]):
        one = e[at]
        a, u, w, ad, ud, wd, add = bent_place(e, at + 1, m, b, bd, first, hb)
        mass += one * one
        c1, c2, c3 = c1 + one * a, c2 + one * u, c3 + one * w
        j11, j22, j33 = j11 + u * u + w * w, j22 + a * a + w * w, j33 + a * a + u * u
        j12, j13, j23 = j12 - a * u, j13 - a * w, j23 - u * w
        t1, t2, t3 = cross(w1, w2, w3, a, u, w)
        t1, t2, t3 = cross(w1, w2, w3, t1 + 2.0 * ad, t2 + 2.0 * ud, t3 + 2.0 * wd)
        t1 += add
        g1, g2, g3 = g1 + one * t1, g2 + one * t2, g3 + one * t3
        l1, l2, l3 = cross(a, u, w, t1, t2, t3)
        m1, m2, m3 = m1 + l1, m2 + l2, m3 + l3
        for k in range(m):
            v1, v2, v3 = -e[hb + k], e[at + 2 + k], e[at + 2 + m + k]
            l1, l2, l3 = cross(a, u, w, v1, v2, v3)
            e[n_at + 6 * k] += l1
            e[n_at + 6 * k + 1] += l2
            e[n_at + 6 * k + 2] += l3
            e[n_at + 6 * k + 3] += one * v1
            e[n_at + 6 * k + 4] += one * v2
            e[n_at + 6 * k + 5] += one * v3
            e[p_at + k] += v1 * t1 + v2 * t2 + v3 * t3
            for l in range(k + 1):
                e[a_at + k * m + l] += v1 * -e[hb + l] + v2 * e[at + 2 + l] + v3 * e[at + 2 + m + l]
        at += size
    # Discs of twist: their spin about f is ω·f + φ̇.
    polar = e[beam + POLAR]
    if polar > 0.0:
        moment = beam + HEAD + 2 * m * m
        spin = polar * w1
        for k in range(m):
            spin += e[moment + k] * bd[first + k]
            e[n_at + 6 * k] += e[moment + k]
            for l in range(k + 1):
                e[a_at + k * m + l] += e[moment + m + k * m + l]
        j11 += polar
        m2, m3 = m2 + spin * w3, m3 - spin * w2
    if e[beam + HAS_TIP_INERTIA] != 0.0:
        j11, j12, j13, j22, j23, j33, m1, m2, m3 = _tip_inertia(
            e, i, t, b, bd, (w1, w2, w3), (j11, j12, j13, j22, j23, j33), (m1, m2, m3)
        )
    # To base axes: G = [f h n].
    q11, q12, q13 = fx * j11 + hx * j12 + nx * j13, fx * j12 + hx * j22 + nx * j23, fx * j13 + hx * j23 + nx * j33
    q21, q22, q23 = fy * j11 + hy * j12 + ny * j13, fy * j12 + hy * j22 + ny * j23, fy * j13 + hy * j23 + ny * j33
    q31, q32, q33 = fz * j11 + hz * j12 + nz * j13, fz * j12 + hz * j22 + nz * j23, fz * j13 + hz * j23 + nz * j33
    d[i, J] += q11 * fx + q12 * hx + q13 * nx
    d[i, J + 1] += q11 * fy + q12 * hy + q13 * ny
    d[i, J + 2] += q11 * fz + q12 * hz + q13 * nz
    d[i, J + 3] += q21 * fy + q22 * hy + q23 * ny
    d[i, J + 4] += q21 * fz + q22 * hz + q23 * nz
    d[i, J + 5] += q31 * fz + q32 * hz + q33 * nz
    cx, cy, cz = fx * c1 + hx * c2 + nx * c3, fy * c1 + hy * c2 + ny * c3, fz * c1 + hz * c2 + nz * c3
    d[i, B + 1] -= cz
    d[i, B + 2] += cy
    d[i, B + 3] += cz
    d[i, B + 5] -= cx
    d[i, B + 6] -= cy
    d[i, B + 7] += cx
    d[i, M] += mass
    d[i, M + 3] += mass
    d[i, M + 5] += mass
    d[i, FORCE] += fx * m1 + hx * m2 + nx * m3
    d[i, FORCE + 1] += fy * m1 + hy * m2 + ny * m3
    d[i, FORCE + 2] += fz * m1 + hz * m2 + nz * m3
    d[i, FORCE + 3] += fx * g1 + hx * g2 + nx * g3
    d[i, FORCE + 4] += fy * g1 + hy * g2 + ny * g3
    d[i, FORCE + 5] += fz * g1 + hz * g2 + nz * g3
    for k in range(m):
        for part in (0, 3):
            o = n_at + 6 * k + part
            t1, t2, t3 = e[o], e[o + 1], e[o + 2]
            e[o] = fx * t1 + hx * t2 + nx * t3
            e[o + 1] = fy * t1 + hy * t2 + ny * t3
            e[o + 2] = fz * t1 + hz * t2 + nz * t3
        for l in range(k):
            e[a_at + l * m + k] = e[a_at + k * m + l]


@internal
def _tip_inertia(
    e: Beams,
    i: int,
    t: Topology,
    b: Vector,
    bd: Vector,
    spin: Triple,
    inertia: tuple[float, float, float, float, float, float],
    moment: Triple,
) -> tuple[float, ...]:
    """Rotary inertia of the payload, which turns with the tip's section; all in the beam's axes."""
    m = t[i, MODES]
    first = t[i, FIRST] + (1 if t[i, KIND] != FIXED else 0)
    beam = t[i, BEAM]
    n_at = t[i, EXTENDED]
    a_at = n_at + 6 * m
    p_at = a_at + m * m
    tip = beam + HEAD + 3 * m * m + m
    k0 = tip + 1 + 2 * m + m * m
    one, two, twist, one_rate, two_rate, twist_rate = tilt(e, tip, m, b, bd, first)
    s1, c1 = sincos(one)
    s2, c2 = sincos(two)
    s3, c3 = sincos(twist)
    # Columns of the section's rotation in (f, h, n); axes of rotation are n, -h' = (s1, -c1, 0), and the section's f.
    f1, f2, f3 = c1 * c2, s1 * c2, s2
    k1, k2, k3 = -c1 * s2, -s1 * s2, c2
    h1, h2, h3 = -s1 * c3 + k1 * s3, c1 * c3 + k2 * s3, k3 * s3
    k1, k2, k3 = k1 * c3 + s1 * s3, k2 * c3 - c1 * s3, k3 * c3
    q = e[beam + TIP_INERTIA : beam + TIP_INERTIA + 9]
    a11, a12, a13 = (
        f1 * q[0] + h1 * q[3] + k1 * q[6],
        f1 * q[1] + h1 * q[4] + k1 * q[7],
        f1 * q[2] + h1 * q[5] + k1 * q[8],
    )
    a21, a22, a23 = (
        f2 * q[0] + h2 * q[3] + k2 * q[6],
        f2 * q[1] + h2 * q[4] + k2 * q[7],
        f2 * q[2] + h2 * q[5] + k2 * q[8],
    )
    a31, a32, a33 = (
        f3 * q[0] + h3 * q[3] + k3 * q[6],
        f3 * q[1] + h3 * q[4] + k3 * q[7],
        f3 * q[2] + h3 * q[5] + k3 * q[8],
    )
    i11, i12, i13 = a11 * f1 + a12 * h1 + a13 * k1, a11 * f2 + a12 * h2 + a13 * k2, a11 * f3 + a12 * h3 + a13 * k3
    i22, i23 = a21 * f2 + a22 * h2 + a23 * k2, a21 * f3 + a22 * h3 + a23 * k3
    i33 = a31 * f3 + a32 * h3 + a33 * k3
    w1, w2, w3 = spin
    b1, b2, b3 = cross(w1, w2, w3, 0.0, 0.0, one_rate)
    w3 += one_rate
    t1, t2, t3 = cross(w1, w2, w3, s1 * two_rate, -c1 * two_rate, 0.0)
    b1, b2, b3 = b1 + t1, b2 + t2, b3 + t3
    w1, w2 = w1 + s1 * two_rate, w2 - c1 * two_rate
    t1, t2, t3 = cross(w1, w2, w3, f1 * twist_rate, f2 * twist_rate, f3 * twist_rate)
    b1, b2, b3 = b1 + t1, b2 + t2, b3 + t3
    w1, w2, w3 = w1 + f1 * twist_rate, w2 + f2 * twist_rate, w3 + f3 * twist_rate
    t1, t2, t3 = cross(
        w1, w2, w3, i11 * w1 + i12 * w2 + i13 * w3, i12 * w1 + i22 * w2 + i23 * w3, i13 * w1 + i23 * w2 + i33 * w3
    )
    t1 += i11 * b1 + i12 * b2 + i13 * b3
    t2 += i12 * b1 + i22 * b2 + i23 * b3
    t3 += i13 * b1 + i23 * b2 + i33 * b3
    for k in range(m):
        o1, o2, o3 = e[k0 + k], e[k0 + m + k], e[k0 + 2 * m + k]
        p1, p2, p3 = s1 * o2 + f1 * o3, -c1 * o2 + f2 * o3, o1 + f3 * o3
        l1, l2, l3 = i11 * p1 + i12 * p2 + i13 * p3, i12 * p1 + i22 * p2 + i23 * p3, i13 * p1 + i23 * p2 + i33 * p3
        e[n_at + 6 * k] += l1
        e[n_at + 6 * k + 1] += l2
        e[n_at + 6 * k + 2] += l3
        e[p_at + k] += p1 * t1 + p2 * t2 + p3 * t3
        for l in range(k + 1):
            o1, o2, o3 = e[k0 + l], e[k0 + m + l], e[k0 + 2 * m + l]
            e[a_at + k * m + l] += l1 * (s1 * o2 + f1 * o3) + l2 * (-c1 * o2 + f2 * o3) + l3 * (o1 + f3 * o3)
    j11, j12, j13, j22, j23, j33 = inertia
    return (
        j11 + i11,
        j12 + i12,
        j13 + i13,
        j22 + i22,
        j23 + i23,
        j33 + i33,
        moment[0] + t1,
        moment[1] + t2,
        moment[2] + t3,
    )


@internal
def outward(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector) -> None:
    """Pose, inertia and bias of every body, from the base outwards."""
    for i in range(1, bodies + 1):
        place(d, t, e, i, q, qd)
        turn_inertia(d, i)
        if t[i, MODES] > 0:
            bend(d, t, e, i, q, qd)


@internal
def forward_dynamics(
    bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector, tau: Vector, qdd: Vector
) -> int:
    """Accelerations by articulated-body elimination, modes before joints; 0, or the row of the outermost body with D <= 0."""
    singular = 0
    outward(bodies, d, t, e, q, qd)
    for i in range(bodies, 0, -1):
        m = t[i, MODES]
        own = t[i, FIRST]
        # The outermost: what divides by nothing makes everything further in no number.
        if m > 0 and not eliminate_modes(d, t, e, i, q, qd, tau) and singular == 0:
            singular = i
        if t[i, KIND] != FIXED:
            u = tau[own] - d[i, DAMPING] * qd[own] - d[i, STIFFNESS] * (q[own] - d[i, REST])
            if not eliminate_joint(d, t, i, u) and singular == 0:
                singular = i
        if t[i, PARENT] > 0:
            hand_on(d, t, e, i)
    for i in range(1, bodies + 1):
        accelerate(d, t, e, i, qdd)
        own = t[i, FIRST]
        if t[i, KIND] != FIXED:
            a = d[i, DRIVE]
            for k in range(6):
                a -= d[i, COLUMN + k] * d[i, ACCELERATION + k]
            a *= d[i, PIVOT]
            qdd[own] = a
            accelerate_joint(d, t, i, a)
            own += 1
        m = t[i, MODES]
        x_at = t[i, EXTENDED] + 7 * m + m * m
        for k in range(m):
            a = e[x_at + 6 * m + k]
            for c in range(6):
                a -= e[x_at + 6 * k + c] * d[i, ACCELERATION + c]
            qdd[own + k] = a
    return singular


@internal
def eliminate_modes(d: Rows, t: Topology, e: Beams, i: int, q: Vector, qd: Vector, tau: Vector) -> bool:
    """Take the modal accelerations out of a body's inertia and bias; whether A was positive definite."""
    m = t[i, MODES]
    first = t[i, FIRST] + (1 if t[i, KIND] != FIXED else 0)
    n_at = t[i, EXTENDED]
    a_at = n_at + 6 * m
    p_at = a_at + m * m
    x_at = p_at + m
    y_at = x_at + 6 * m
    k_at = t[i, BEAM] + HEAD
    c_at = k_at + m * m
    sound = True
    for k in range(m):
        y = tau[first + k] - e[p_at + k]
        for l in range(m):
            y -= e[k_at + k * m + l] * q[first + l] + e[c_at + k * m + l] * qd[first + l]
        e[y_at + k] = y
        for c in range(6):
            e[x_at + 6 * k + c] = e[n_at + 6 * k + c]
    # Cholesky A = L Lᵀ in place (lower), then L⁻¹ [N y], by rows.
    for k in range(m):
        for l in range(k + 1):
            value = e[a_at + k * m + l]
            for c in range(l):
                value -= e[a_at + k * m + c] * e[a_at + l * m + c]
            if l < k:
                e[a_at + k * m + l] = value * e[a_at + l * m + l]
            else:
                if not value > 0.0:
                    sound = False
                # The diagonal holds its inverse.
                e[a_at + k * m + k] = 1.0 / np.sqrt(value)
        for c in range(6):
            value = e[x_at + 6 * k + c]
            for l in range(k):
                value -= e[a_at + k * m + l] * e[x_at + 6 * l + c]
            e[x_at + 6 * k + c] = value * e[a_at + k * m + k]
        value = e[y_at + k]
        for l in range(k):
            value -= e[a_at + k * m + l] * e[y_at + l]
        e[y_at + k] = value * e[a_at + k * m + k]
    # I - N A⁻¹ Nᵀ and p + N A⁻¹ y.
    for k in range(m):
        x0, x1, x2 = e[x_at + 6 * k], e[x_at + 6 * k + 1], e[x_at + 6 * k + 2]
        x3, x4, x5 = e[x_at + 6 * k + 3], e[x_at + 6 * k + 4], e[x_at + 6 * k + 5]
        y = e[y_at + k]
        subtract_square(d, i, x0, x1, x2, x3, x4, x5, 1.0)
        add_wrench(d, i, x0 * y, x1 * y, x2 * y, x3 * y, x4 * y, x5 * y)
    # Back substitution: A⁻¹ N and A⁻¹ y, for the way outwards.
    for k in range(m - 1, -1, -1):
        for c in range(6):
            value = e[x_at + 6 * k + c]
            for l in range(k + 1, m):
                value -= e[a_at + l * m + k] * e[x_at + 6 * l + c]
            e[x_at + 6 * k + c] = value * e[a_at + k * m + k]
        value = e[y_at + k]
        for l in range(k + 1, m):
            value -= e[a_at + l * m + k] * e[y_at + l]
        e[y_at + k] = value * e[a_at + k * m + k]
    return sound


@inlined
def add_wrench(d: Rows, i: int, w0: float, w1: float, w2: float, w3: float, w4: float, w5: float) -> None:
    """Add a wrench at body i's origin to its bias."""
    d[i, FORCE] += w0
    d[i, FORCE + 1] += w1
    d[i, FORCE + 2] += w2
    d[i, FORCE + 3] += w3
    d[i, FORCE + 4] += w4
    d[i, FORCE + 5] += w5


@internal
def subtract_square(
    d: Rows, i: int, u0: float, u1: float, u2: float, u3: float, u4: float, u5: float, scale: float
) -> None:
    """Subtract scale · u uᵀ from a body's inertia."""
    v0, v1, v2, v3, v4, v5 = u0 * scale, u1 * scale, u2 * scale, u3 * scale, u4 * scale, u5 * scale
    d[i, J] -= v0 * u0
    d[i, J + 1] -= v0 * u1
    d[i, J + 2] -= v0 * u2
    d[i, J + 3] -= v1 * u1
    d[i, J + 4] -= v1 * u2
    d[i, J + 5] -= v2 * u2
    d[i, B] -= v0 * u3
    d[i, B + 1] -= v0 * u4
    d[i, B + 2] -= v0 * u5
    d[i, B + 3] -= v1 * u3
    d[i, B + 4] -= v1 * u4
    d[i, B + 5] -= v1 * u5
    d[i, B + 6] -= v2 * u3
    d[i, B + 7] -= v2 * u4
    d[i, B + 8] -= v2 * u5
    d[i, M] -= v3 * u3
    d[i, M + 1] -= v3 * u4
    d[i, M + 2] -= v3 * u5
    d[i, M + 3] -= v4 * u4
    d[i, M + 4] -= v4 * u5
    d[i, M + 5] -= v5 * u5


@internal
def times_inertia(d: Rows, i: int, a: Vector, at: int) -> tuple[float, float, float, float, float, float]:
    """Wrench [J B; Bᵀ M] a for a six-vector that begins at a[at]."""
    a0, a1, a2, a3, a4, a5 = a[at], a[at + 1], a[at + 2], a[at + 3], a[at + 4], a[at + 5]
    return (
        d[i, J] * a0 + d[i, J + 1] * a1 + d[i, J + 2] * a2 + d[i, B] * a3 + d[i, B + 1] * a4 + d[i, B + 2] * a5,
        d[i, J + 1] * a0 + d[i, J + 3] * a1 + d[i, J + 4] * a2 + d[i, B + 3] * a3 + d[i, B + 4] * a4 + d[i, B + 5] * a5,
        d[i, J + 2] * a0 + d[i, J + 4] * a1 + d[i, J + 5] * a2 + d[i, B + 6] * a3 + d[i, B + 7] * a4 + d[i, B + 8] * a5,
        d[i, B] * a0 + d[i, B + 3] * a1 + d[i, B + 6] * a2 + d[i, M] * a3 + d[i, M + 1] * a4 + d[i, M + 2] * a5,
        d[i, B + 1] * a0 + d[i, B + 4] * a1 + d[i, B + 7] * a2 + d[i, M + 1] * a3 + d[i, M + 3] * a4 + d[i, M + 4] * a5,
        d[i, B + 2] * a0 + d[i, B + 5] * a1 + d[i, B + 8] * a2 + d[i, M + 2] * a3 + d[i, M + 4] * a4 + d[i, M + 5] * a5,
    )


@internal
def eliminate_joint(d: Rows, t: Topology, i: int, u: float) -> bool:
    """U, D and u of the joint, taken out of the body's inertia and bias; whether D was positive."""
    zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
    if t[i, KIND] == REVOLUTE:
        u0 = d[i, J] * zx + d[i, J + 1] * zy + d[i, J + 2] * zz
        u1 = d[i, J + 1] * zx + d[i, J + 3] * zy + d[i, J + 4] * zz
        u2 = d[i, J + 2] * zx + d[i, J + 4] * zy + d[i, J + 5] * zz
        u3 = d[i, B] * zx + d[i, B + 3] * zy + d[i, B + 6] * zz
        u4 = d[i, B + 1] * zx + d[i, B + 4] * zy + d[i, B + 7] * zz
        u5 = d[i, B + 2] * zx + d[i, B + 5] * zy + d[i, B + 8] * zz
        pivot = u0 * zx + u1 * zy + u2 * zz + d[i, ARMATURE]
        u -= zx * d[i, FORCE] + zy * d[i, FORCE + 1] + zz * d[i, FORCE + 2]
    else:
        u0 = d[i, B] * zx + d[i, B + 1] * zy + d[i, B + 2] * zz
        u1 = d[i, B + 3] * zx + d[i, B + 4] * zy + d[i, B + 5] * zz
        u2 = d[i, B + 6] * zx + d[i, B + 7] * zy + d[i, B + 8] * zz
        u3 = d[i, M] * zx + d[i, M + 1] * zy + d[i, M + 2] * zz
        u4 = d[i, M + 1] * zx + d[i, M + 3] * zy + d[i, M + 4] * zz
        u5 = d[i, M + 2] * zx + d[i, M + 4] * zy + d[i, M + 5] * zz
        pivot = u3 * zx + u4 * zy + u5 * zz + d[i, ARMATURE]
        u -= zx * d[i, FORCE + 3] + zy * d[i, FORCE + 4] + zz * d[i, FORCE + 5]
    inverse = 1.0 / pivot
    d[i, COLUMN], d[i, COLUMN + 1], d[i, COLUMN + 2] = u0, u1, u2
    d[i, COLUMN + 3], d[i, COLUMN + 4], d[i, COLUMN + 5] = u3, u4, u5
    d[i, PIVOT], d[i, DRIVE] = inverse, u
    subtract_square(d, i, u0, u1, u2, u3, u4, u5, inverse)
    scale = u * inverse
    add_wrench(d, i, u0 * scale, u1 * scale, u2 * scale, u3 * scale, u4 * scale, u5 * scale)
    return pivot > 0.0


@internal
def hand_on_inertia(d: Rows, t: Topology, e: Beams, i: int) -> None:
    """Add body i's inertia to its parent's, and to the parent's modes if it rides on a section."""
    p = t[i, PARENT]
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    add_shifted_inertia(
        d,
        p,
        rx,
        ry,
        rz,
        (d[i, J], d[i, J + 1], d[i, J + 2], d[i, J + 3], d[i, J + 4], d[i, J + 5]),
        (
            d[i, B],
            d[i, B + 1],
            d[i, B + 2],
            d[i, B + 3],
            d[i, B + 4],
            d[i, B + 5],
            d[i, B + 6],
            d[i, B + 7],
            d[i, B + 8],
        ),
        (d[i, M], d[i, M + 1], d[i, M + 2], d[i, M + 3], d[i, M + 4], d[i, M + 5]),
    )
    if t[i, STATION] >= 0:
        m = t[p, MODES]
        partial = t[i, STATION] + 1 + 5 * m + m * m
        n_at = t[p, EXTENDED]
        a_at = n_at + 6 * m
        for k in range(m):
            w0, w1, w2, w3, w4, w5 = times_inertia(d, i, e, partial + 6 * k)
            for l in range(m):
                o = partial + 6 * l
                e[a_at + k * m + l] += (
                    w0 * e[o] + w1 * e[o + 1] + w2 * e[o + 2] + w3 * e[o + 3] + w4 * e[o + 4] + w5 * e[o + 5]
                )
            o = n_at + 6 * k
            e[o] += w0 + ry * w5 - rz * w4
            e[o + 1] += w1 + rz * w3 - rx * w5
            e[o + 2] += w2 + rx * w4 - ry * w3
            e[o + 3] += w3
            e[o + 4] += w4
            e[o + 5] += w5


@internal
def hand_on_wrench(
    d: Rows, t: Topology, e: Beams, i: int, w0: float, w1: float, w2: float, w3: float, w4: float, w5: float
) -> None:
    """Add a wrench at body i's origin to its parent's bias, and to the parent's modal bias if it rides on a section."""
    p = t[i, PARENT]
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    add_shifted_wrench(d, p, rx, ry, rz, w0, w1, w2, w3, w4, w5)
    if t[i, STATION] >= 0:
        m = t[p, MODES]
        p_at = t[p, EXTENDED] + 6 * m + m * m
        for k in range(m):
            o = t[i, STATION] + 1 + 5 * m + m * m + 6 * k
            e[p_at + k] += w0 * e[o] + w1 * e[o + 1] + w2 * e[o + 2] + w3 * e[o + 3] + w4 * e[o + 4] + w5 * e[o + 5]


@internal
def hand_on(d: Rows, t: Topology, e: Beams, i: int) -> None:
    """Add body i's articulated inertia and bias to its parent's."""
    w0, w1, w2, w3, w4, w5 = times_inertia(d, i, d[i], BIAS)
    hand_on_wrench(
        d,
        t,
        e,
        i,
        d[i, FORCE] + w0,
        d[i, FORCE + 1] + w1,
        d[i, FORCE + 2] + w2,
        d[i, FORCE + 3] + w3,
        d[i, FORCE + 4] + w4,
        d[i, FORCE + 5] + w5,
    )
    hand_on_inertia(d, t, e, i)


@internal
def accelerate(d: Rows, t: Topology, e: Beams, i: int, qdd: Vector) -> None:
    """Acceleration body i would have without its joint's own; the parent's modal accelerations are in ``qdd``."""
    p = t[i, PARENT]
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    wx, wy, wz = d[p, ACCELERATION], d[p, ACCELERATION + 1], d[p, ACCELERATION + 2]
    d[i, ACCELERATION] = wx + d[i, BIAS]
    d[i, ACCELERATION + 1] = wy + d[i, BIAS + 1]
    d[i, ACCELERATION + 2] = wz + d[i, BIAS + 2]
    d[i, ACCELERATION + 3] = d[p, ACCELERATION + 3] + d[i, BIAS + 3] + (wy * rz - wz * ry)
    d[i, ACCELERATION + 4] = d[p, ACCELERATION + 4] + d[i, BIAS + 4] + (wz * rx - wx * rz)
    d[i, ACCELERATION + 5] = d[p, ACCELERATION + 5] + d[i, BIAS + 5] + (wx * ry - wy * rx)
    if t[i, STATION] >= 0:
        m = t[p, MODES]
        first = t[p, FIRST] + (1 if t[p, KIND] != FIXED else 0)
        for k in range(m):
            o = t[i, STATION] + 1 + 5 * m + m * m + 6 * k
            for c in range(6):
                d[i, ACCELERATION + c] += e[o + c] * qdd[first + k]


@inlined
def accelerate_joint(d: Rows, t: Topology, i: int, a: float) -> None:
    """Add the acceleration a of body i's joint to the body's."""
    o = ACCELERATION if t[i, KIND] == REVOLUTE else ACCELERATION + 3
    d[i, o] += d[i, TURN + 2] * a
    d[i, o + 1] += d[i, TURN + 5] * a
    d[i, o + 2] += d[i, TURN + 8] * a


@internal
def inverse_dynamics(
    bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector, qdd: Vector, tau: Vector
) -> None:
    """Generalized forces without passive ones."""
    outward(bodies, d, t, e, q, qd)
    for i in range(1, bodies + 1):
        accelerate(d, t, e, i, qdd)
        own = t[i, FIRST]
        if t[i, KIND] != FIXED:
            accelerate_joint(d, t, i, qdd[own])
            own += 1
        w0, w1, w2, w3, w4, w5 = times_inertia(d, i, d[i], ACCELERATION)
        add_wrench(d, i, w0, w1, w2, w3, w4, w5)
        m = t[i, MODES]
        n_at = t[i, EXTENDED]
        a_at = n_at + 6 * m
        p_at = a_at + m * m
        for k in range(m):
            b = qdd[own + k]
            value = 0.0
            for c in range(6):
                d[i, FORCE + c] += e[n_at + 6 * k + c] * b
                value += e[n_at + 6 * k + c] * d[i, ACCELERATION + c]
            for l in range(m):
                value += e[a_at + k * m + l] * qdd[own + l]
            e[p_at + k] += value
    for i in range(bodies, 0, -1):
        own = t[i, FIRST]
        if t[i, KIND] != FIXED:
            o = FORCE if t[i, KIND] == REVOLUTE else FORCE + 3
            along = d[i, TURN + 2] * d[i, o] + d[i, TURN + 5] * d[i, o + 1] + d[i, TURN + 8] * d[i, o + 2]
            tau[own] = along + d[i, ARMATURE] * qdd[own]
            own += 1
        m = t[i, MODES]
        p_at = t[i, EXTENDED] + 6 * m + m * m
        for k in range(m):
            tau[own + k] = e[p_at + k]
        if t[i, PARENT] > 0:
            hand_on_wrench(
                d,
                t,
                e,
                i,
                d[i, FORCE],
                d[i, FORCE + 1],
                d[i, FORCE + 2],
                d[i, FORCE + 3],
                d[i, FORCE + 4],
                d[i, FORCE + 5],
            )


@compiled
def subtract_passive(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector, out: Vector) -> None:
    """Take the passive forces from generalized forces: what is left has to be applied."""
    for i in range(1, bodies + 1):
        own = t[i, FIRST]
        if t[i, KIND] != FIXED:
            out[own] += d[i, DAMPING] * qd[own] + d[i, STIFFNESS] * (q[own] - d[i, REST])
            own += 1
        m = t[i, MODES]
        k_at = t[i, BEAM] + HEAD
        c_at = k_at + m * m
        for k in range(m):
            for l in range(m):
                out[own + k] += e[k_at + k * m + l] * q[own + l] + e[c_at + k * m + l] * qd[own + l]


@internal
def mass_matrix(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, mass: Matrix) -> None:
    """Generalized inertia matrix from composite bodies."""
    n = len(q)
    for i in range(n):
        for k in range(n):
            mass[i, k] = 0.0
    # Velocities have no part in it; positions stand in for them and are not read where it matters.
    outward(bodies, d, t, e, q, q)
    for i in range(bodies, 0, -1):
        if t[i, PARENT] > 0:
            hand_on_inertia(d, t, e, i)
    for i in range(1, bodies + 1):
        own = t[i, FIRST]
        m = t[i, MODES]
        n_at = t[i, EXTENDED]
        a_at = n_at + 6 * m
        first = own
        if t[i, KIND] != FIXED:
            # Joint column: composite inertia times axis.
            zx, zy, zz = d[i, TURN + 2], d[i, TURN + 5], d[i, TURN + 8]
            for c in range(6):
                d[i, COLUMN + c] = 0.0
            o = COLUMN if t[i, KIND] == REVOLUTE else COLUMN + 3
            d[i, o], d[i, o + 1], d[i, o + 2] = zx, zy, zz
            w0, w1, w2, w3, w4, w5 = times_inertia(d, i, d[i], COLUMN)
            along = zx * w0 + zy * w1 + zz * w2 if t[i, KIND] == REVOLUTE else zx * w3 + zy * w4 + zz * w5
            mass[own, own] = along + d[i, ARMATURE]
            first = own + 1
            for k in range(m):
                s = n_at + 6 * k + (0 if t[i, KIND] == REVOLUTE else 3)
                along = zx * e[s] + zy * e[s + 1] + zz * e[s + 2]
                mass[own, first + k] = along
                mass[first + k, own] = along
            _column_to_ancestors(d, t, e, i, own, w0, w1, w2, w3, w4, w5, mass)
        for k in range(m):
            for l in range(m):
                mass[first + k, first + l] = e[a_at + k * m + l]
            s = n_at + 6 * k
            _column_to_ancestors(d, t, e, i, first + k, e[s], e[s + 1], e[s + 2], e[s + 3], e[s + 4], e[s + 5], mass)


@internal
def _column_to_ancestors(
    d: Rows,
    t: Topology,
    e: Beams,
    i: int,
    column: int,
    nx: float,
    ny: float,
    nz: float,
    fx: float,
    fy: float,
    fz: float,
    mass: Matrix,
) -> None:
    """Elements of one column of the mass matrix for all ancestors' coordinates: the wrench shifted towards the base."""
    k = i
    while t[k, PARENT] > 0:
        p = t[k, PARENT]
        own = t[p, FIRST]
        first = own + (1 if t[p, KIND] != FIXED else 0)
        if t[k, STATION] >= 0:
            m = t[p, MODES]
            for l in range(m):
                o = t[k, STATION] + 1 + 5 * m + m * m + 6 * l
                value = nx * e[o] + ny * e[o + 1] + nz * e[o + 2] + fx * e[o + 3] + fy * e[o + 4] + fz * e[o + 5]
                mass[column, first + l] = value
                mass[first + l, column] = value
        rx, ry, rz = d[k, REACH], d[k, REACH + 1], d[k, REACH + 2]
        nx, ny, nz = nx + ry * fz - rz * fy, ny + rz * fx - rx * fz, nz + rx * fy - ry * fx
        if t[p, KIND] != FIXED:
            if t[p, KIND] == REVOLUTE:
                value = d[p, TURN + 2] * nx + d[p, TURN + 5] * ny + d[p, TURN + 8] * nz
            else:
                value = d[p, TURN + 2] * fx + d[p, TURN + 5] * fy + d[p, TURN + 8] * fz
            mass[column, own] = value
            mass[own, column] = value
        k = p


@internal
def advance_origin(d: Rows, t: Topology, e: Beams, i: int, qd: Vector) -> None:
    """Position and velocity of body i's origin in base coordinates, once the body is placed."""
    p = t[i, PARENT]
    rx, ry, rz = d[i, REACH], d[i, REACH + 1], d[i, REACH + 2]
    vx, vy, vz = cross(d[p, SPIN], d[p, SPIN + 1], d[p, SPIN + 2], rx, ry, rz)
    if t[i, STATION] >= 0:
        m = t[p, MODES]
        first = t[p, FIRST] + (1 if t[p, KIND] != FIXED else 0)
        for k in range(m):
            o = t[i, STATION] + 1 + 5 * m + m * m + 6 * k
            vx += e[o + 3] * qd[first + k]
            vy += e[o + 4] * qd[first + k]
            vz += e[o + 5] * qd[first + k]
    if t[i, KIND] == PRISMATIC:
        slide = qd[t[i, FIRST]]
        vx, vy, vz = vx + slide * d[i, TURN + 2], vy + slide * d[i, TURN + 5], vz + slide * d[i, TURN + 8]
    d[i, POSITION] = d[p, POSITION] + rx
    d[i, POSITION + 1] = d[p, POSITION + 1] + ry
    d[i, POSITION + 2] = d[p, POSITION + 2] + rz
    d[i, VELOCITY] = d[p, VELOCITY] + vx
    d[i, VELOCITY + 1] = d[p, VELOCITY + 1] + vy
    d[i, VELOCITY + 2] = d[p, VELOCITY + 2] + vz


@compiled
def locate(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector) -> None:
    """Pose, spin and velocity of every body into the rows."""
    for i in range(1, bodies + 1):
        place(d, t, e, i, q, qd)
        advance_origin(d, t, e, i, qd)


@internal
def energy_and_momentum(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector, out: Vector) -> None:
    """out: kinetic, potential energy; angular (3) about the base's origin and linear (3) momentum."""
    kinetic, potential = 0.0, 0.0
    lx, ly, lz, px, py, pz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    gx, gy, gz = d[0, ACCELERATION + 3], d[0, ACCELERATION + 4], d[0, ACCELERATION + 5]
    for i in range(1, bodies + 1):
        place(d, t, e, i, q, qd)
        advance_origin(d, t, e, i, qd)
        turn_inertia(d, i)
        m = t[i, MODES]
        if m > 0:
            bend(d, t, e, i, q, qd)
        # Twist of the hub in COLUMN.
        for c in range(3):
            d[i, COLUMN + c] = d[i, SPIN + c]
            d[i, COLUMN + 3 + c] = d[i, VELOCITY + c]
        nx, ny, nz, fx, fy, fz = times_inertia(d, i, d[i], COLUMN)
        own = t[i, FIRST]
        if t[i, KIND] != FIXED:
            kinetic += 0.5 * d[i, ARMATURE] * qd[own] * qd[own]
            stretch = q[own] - d[i, REST]
            potential += 0.5 * d[i, STIFFNESS] * stretch * stretch
            own += 1
        n_at = t[i, EXTENDED]
        a_at = n_at + 6 * m
        k_at = t[i, BEAM] + HEAD
        for k in range(m):
            rate = qd[own + k]
            o = n_at + 6 * k
            nx, ny, nz = nx + e[o] * rate, ny + e[o + 1] * rate, nz + e[o + 2] * rate
            fx, fy, fz = fx + e[o + 3] * rate, fy + e[o + 4] * rate, fz + e[o + 5] * rate
            modal = 0.0
            for c in range(6):
                modal += e[o + c] * d[i, COLUMN + c]
            for l in range(m):
                modal += e[a_at + k * m + l] * qd[own + l]
                potential += 0.5 * e[k_at + k * m + l] * q[own + k] * q[own + l]
            kinetic += 0.5 * modal * rate
        kinetic += 0.5 * (
            d[i, SPIN] * nx
            + d[i, SPIN + 1] * ny
            + d[i, SPIN + 2] * nz
            + d[i, VELOCITY] * fx
            + d[i, VELOCITY + 1] * fy
            + d[i, VELOCITY + 2] * fz
        )
        mass, cx, cy, cz = d[i, M], d[i, B + 7], d[i, B + 2], d[i, B + 3]
        x, y, z = d[i, POSITION], d[i, POSITION + 1], d[i, POSITION + 2]
        potential += gx * (mass * x + cx) + gy * (mass * y + cy) + gz * (mass * z + cz)
        lx, ly, lz = lx + nx + y * fz - z * fy, ly + ny + z * fx - x * fz, lz + nz + x * fy - y * fx
        px, py, pz = px + fx, py + fy, pz + fz
    out[0], out[1] = kinetic, potential
    out[2], out[3], out[4], out[5], out[6], out[7] = lx, ly, lz, px, py, pz


@compiled
def mass_matrix_rows(bodies: int, d: Rows, t: Topology, e: Beams, Q: Matrix, out: Any) -> None:
    """``mass_matrix`` for every row."""
    for k in range(len(Q)):
        mass_matrix(bodies, d, t, e, Q[k], out[k])


@compiled
def energy_rows(bodies: int, d: Rows, t: Topology, e: Beams, Q: Matrix, Qd: Matrix, out: Matrix) -> None:
    """Kinetic and potential energy of every row; out (B, 2)."""
    both = np.empty(8)
    for k in range(len(Q)):
        energy_and_momentum(bodies, d, t, e, Q[k], Qd[k], both)
        out[k, 0], out[k, 1] = both[0], both[1]


@compiled
def momentum(bodies: int, d: Rows, t: Topology, e: Beams, q: Vector, qd: Vector, out: Vector) -> None:
    """out: angular (3) about the base's origin and linear (3) momentum."""
    both = np.empty(8)
    energy_and_momentum(bodies, d, t, e, q, qd, both)
    for k in range(6):
        out[k] = both[2 + k]


@compiled
def hub_rows(
    inverse: int, model: int, d: Rows, i: int, Q: Matrix, Qd: Matrix, Qdd: Matrix, scratch: Vector, out: Matrix
) -> None:
    """Rotation (9), spin (3) and acceleration less gravity (6) of body i in every row; out (B, 18).

    inverse: address of inverse dynamics, which leave all that in the rows d of the model.
    """
    for k in range(len(Q)):
        call(inverse, model, Q[k].ctypes.data, Qd[k].ctypes.data, Qdd[k].ctypes.data, scratch.ctypes.data)
        for c in range(9):
            out[k, c] = d[i, TURN + c]
        for c in range(3):
            out[k, 9 + c] = d[i, SPIN + c]
        for c in range(6):
            out[k, 12 + c] = d[i, ACCELERATION + c]
