"""Accelerations of eight copies of a tree at once: articulated-body elimination of modes and of free joints, held joints kept.

The recursion is the U D Uᵀ elimination of the generalized inertia matrix in its O(n) form (the DeNOC forward
dynamics). A tree is a list of nodes. A *joint* node is a body, re-framed so that the joint's axis is z and, along a first
child, a constant turn about x leads from one body to the next. A flexible link adds a *beam* node, fixed to the
link's body, with axes (f, h, n) and the modes as its coordinates, and *section* nodes on it, one where each child rides and
one at the tip for the payload. Spatial vectors are (angular, linear) about the node's origin in the node's axes.
A joint that dry friction holds is not eliminated: its row stays in the articulated inertia, its acceleration is zero,
and the force that holds it is what is left of its equation.

Beams bend in one plane: a point is at (x - ½ bᵀ H b) f + (s·b) h, a section there is turned about n by s'·b.

Everything lies in one flat array a group of eight lanes, lane-contiguous; an offset below counts such vectors.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.joint_laws import laws as law
from harness.denoc.simd.vector import (
    add_run,
    address_of,
    call_at,
    choose,
    in_place,
    inner,
    load,
    load_run,
    magnitude,
    sine_cosine,
    spread,
    square_root,
    store,
    store_run,
)

# Kinds of node, and the columns of the integer table that describes one.
# (ABSENT: a section that carries nothing in any lane of the group, skipped.)
REVOLUTE, PRISMATIC, BEAM, SECTION, ABSENT = 0, 1, 2, 3, 4
# ROW, HEAD: where in a parameter row a section's values begin, and those of its beam.
# SIGN: 0, or, where all moves in one plane (``lanes.planar``), ±1, which way a node's axis points from it.
PARENT, KIND, PREFIX, COORDINATE, MODES, TABLE, POINTS, WORK, ROW, HEAD, SIGN = range(11)
COLUMNS = 11

# One node's constants, in vectors of eight lanes.
R, ALPHA, DELTA, GAMMA, MASS, FIRST, SECOND = 0, 3, 5, 7, 9, 10, 13
CONSTANTS = 19
# In motion in a plane: a slide's or a beam's direction, the way a beam bends; R, MASS, FIRST and SECOND as above, in the plane.
PLANE_F, PLANE_H = 3, 5

# One node's workspace (COLUMN: of a section node, its bias acceleration).
OMEGA, VELOCITY, TURN, ANGULAR, MIXED, LINEAR, BIAS, COLUMN, FORCE, INVERSE, ACCELERATION = (
    0, 3, 6, 8, 14, 23, 29, 35, 41, 42, 43,
)  # fmt: skip
BODY = 49

# One coordinate's state and results; a mode uses Q, QD, QDD and TAU only.
Q, QD, QDD, TAU, DIRECTION, FREE, CONTACT, ANCHOR, GRIP, REACTION, HOLD, LIMIT, TAU_SLOPE, REACTION_START, SLIPS = (
    range(15)
)
# Which way soft friction slips where a step begins, and where it ends.
SLIPS_START, SLIPS_END = 15, 16
JOINT = 17

# What the group shares: time, start of the effort's segment, base acceleration parameters, scratch.
# (SHAKE: gravity x, y, z, angular frequency, phase, amplitude along x, y, z)
TIME, TAU_TIME, SHAKE, SCRATCH = 0, 1, 2, 10
GROUP = 12


def beam_table_size(m: int, points: int) -> int:
    """Constants of a beam node: stiffness K and damping C (m, m), then points."""
    return 2 * m * m + points * point_size(m)


def point_size(m: int) -> int:
    """Values of a mass point: 1, x, s (m), H (m, m), each times the root of the mass there."""
    return 2 + m + m * m


def section_table_size(m: int) -> int:
    """Constants of a section node: x, s (m), slope (m), H (m, m)."""
    return 1 + 2 * m + m * m


def beam_work_size(m: int) -> int:
    """Workspace of a beam node: coupling N (m, 6), modal inertia A (m, m), modal bias (m)."""
    return 7 * m + m * m


def section_work_size(m: int) -> int:
    """Workspace of a section node: -(H b)_k (m)."""
    return m


@in_place
def turn_forward(c: Any, s: Any, x: Any, y: Any) -> Any:
    """Coordinates of a vector after the axes turned by an angle of cosine c and sine s (parent to child)."""
    return c * x + s * y, c * y - s * x


@in_place
def turn_symmetric(c: Any, s: Any, xx: Any, yy: Any, zz: Any, xy: Any, xz: Any, yz: Any) -> Any:
    """A symmetric tensor turned back about z (child to parent)."""
    # The trace stays, so that five multiplications are enough for three elements.
    h = s * (xx - yy) + c * (xy + xy)
    return xx - s * h, yy + s * h, zz, c * h - xy, c * xz - s * yz, s * xz + c * yz


@in_place
def turn_general(
    c: Any, s: Any, xx: Any, xy: Any, xz: Any, yx: Any, yy: Any, yz: Any, zx: Any, zy: Any, zz: Any
) -> Any:
    """A general tensor turned back about z (child to parent)."""
    axx = c * xx - s * yx
    axy = c * xy - s * yy
    axz = c * xz - s * yz
    ayx = s * xx + c * yx
    ayy = s * xy + c * yy
    ayz = s * xz + c * yz
    return (
        c * axx - s * axy,
        s * axx + c * axy,
        axz,
        c * ayx - s * ayy,
        s * ayx + c * ayy,
        ayz,
        c * zx - s * zy,
        s * zx + c * zy,
        zz,
    )


@in_place
def shift_tensors(
    x: Any, y: Any, z: Any,
    axx: Any, ayy: Any, azz: Any, axy: Any, axz: Any, ayz: Any,
    bxx: Any, bxy: Any, bxz: Any, byx: Any, byy: Any, byz: Any, bzx: Any, bzy: Any, bzz: Any,
    mxx: Any, myy: Any, mzz: Any, mxy: Any, mxz: Any, myz: Any,
) -> Any:  # fmt: skip
    """Angular and mixed parts of an articulated inertia, taken about a point that lies at −(x, y, z).

    B' = B + T M and A' = A − B T + T B'ᵀ with T v = (x, y, z) × v.
    """
    cxx = bxx + (y * mxz - z * mxy)
    cxy = bxy + (y * myz - z * myy)
    cxz = bxz + (y * mzz - z * myz)
    cyx = byx + (z * mxx - x * mxz)
    cyy = byy + (z * mxy - x * myz)
    cyz = byz + (z * mxz - x * mzz)
    czx = bzx + (x * mxy - y * mxx)
    czy = bzy + (x * myy - y * mxy)
    czz = bzz + (x * myz - y * mxz)
    return (
        axx + (y * bxz - z * bxy) + (y * cxz - z * cxy),
        ayy + (z * byx - x * byz) + (z * cyx - x * cyz),
        azz + (x * bzy - y * bzx) + (x * czy - y * czx),
        axy + (z * bxx - x * bxz) + (y * cyz - z * cyy),
        axz + (x * bxy - y * bxx) + (y * czz - z * czy),
        ayz + (x * byy - y * byx) + (z * czx - x * czz),
        cxx, cxy, cxz, cyx, cyy, cyz, czx, czy, czz,
    )  # fmt: skip


@inner
def _beam_outward(tree: Any, beams: Any, ws: Any, n: int, i: int) -> None:
    """Inertia, coupling and bias of a beam node's mass points at its velocity and bending."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    e = (tree[i, TABLE] + 2 * m * m) * 8
    work = tree[i, WORK] * 8
    first = tree[i, COORDINATE] * JOINT * 8
    zero = spread(0.0)
    for k in range(7 * m + m * m):
        store(ws, work + k * 8, zero)
    wx, wy, wz = load_run(ws, b + OMEGA * 8, 3)
    vx, vy, vz = load_run(ws, b + VELOCITY * 8, 3)
    # Classical acceleration of the origin is the spatial one and ω × v.
    ax = wy * vz - wz * vy
    ay = wz * vx - wx * vz
    az = wx * vy - wy * vx
    mass, hx, hy, xx, yy, xy = zero, zero, zero, zero, zero, zero
    px, py, pz, fx, fy, fz = zero, zero, zero, zero, zero, zero
    size = (2 + m + m * m) * 8
    modal = work + 6 * m * 8
    bias = modal + m * m * 8
    for p in range(tree[i, POINTS]):
        at = e + p * size
        one, x = load_run(beams, at, 2)
        y, xd, yd, xdd = zero, zero, zero, zero
        for k in range(m):
            q = load(ws, first + (k * JOINT + Q) * 8)
            qd = load(ws, first + (k * JOINT + QD) * 8)
            s = load(beams, at + (2 + k) * 8)
            hb, hd = zero, zero
            for l in range(m):
                h = load(beams, at + (2 + m + k * m + l) * 8)
                hb = hb + h * load(ws, first + (l * JOINT + Q) * 8)
                hd = hd + h * load(ws, first + (l * JOINT + QD) * 8)
            x = x - 0.5 * (hb * q)
            xd = xd - hb * qd
            xdd = xdd - hd * qd
            y = y + s * q
            yd = yd + s * qd
            # The x part of the partial velocity of mode k waits in the coupling's place for linear z, which has none.
            store(ws, work + (6 * k + 5) * 8, -hb)
        mass = mass + one * one
        hx = hx + one * x
        hy = hy + one * y
        xx = xx + x * x
        yy = yy + y * y
        xy = xy + x * y
        # ω × (ω × r + 2 ṙ) + bias of r̈, r = (x, y, 0)
        tx = -wz * y + (xd + xd)
        ty = wz * x + (yd + yd)
        tz = wx * y - wy * x
        cx = one * ax + (wy * tz - wz * ty) + xdd
        cy = one * ay + (wz * tx - wx * tz)
        cz = one * az + (wx * ty - wy * tx)
        fx = fx + one * cx
        fy = fy + one * cy
        fz = fz + one * cz
        px = px + y * cz
        py = py - x * cz
        pz = pz + (x * cy - y * cx)
        for k in range(m):
            dx = load(ws, work + (6 * k + 5) * 8)
            dy = load(beams, at + (2 + k) * 8)
            c = work + 6 * k * 8
            add_run(ws, c + 16, ((x * dy - y * dx), one * dx, one * dy))
            store(ws, bias + k * 8, load(ws, bias + k * 8) + (dx * cx + dy * cy))
            for l in range(k + 1):
                ex = load(ws, work + (6 * l + 5) * 8)
                ey = load(beams, at + (2 + l) * 8)
                a = modal + (k * m + l) * 8
                store(ws, a, load(ws, a) + (dx * ex + dy * ey))
    for k in range(m):
        store(ws, work + (6 * k + 5) * 8, zero)
    _fill(ws, b, mass, hx, hy, zero, yy, xx, xx + yy, -xy, zero, zero, px, py, pz, fx, fy, fz)


@in_place
def _fill(
    ws: Any, b: int, m: Any, hx: Any, hy: Any, hz: Any, ixx: Any, iyy: Any, izz: Any, ixy: Any, ixz: Any, iyz: Any,
    px: Any, py: Any, pz: Any, fx: Any, fy: Any, fz: Any,
) -> None:  # fmt: skip
    """Write a node's own inertia as its articulated inertia, and its bias wrench."""
    a = b + BIAS * 8
    store_run(ws, a, (px, py, pz, fx, fy, fz))
    a = b + ANGULAR * 8
    store_run(ws, a, (ixx, iyy, izz, ixy, ixz, iyz))
    zero = spread(0.0)
    a = b + MIXED * 8
    store_run(ws, a, (zero, -hz, hy, hz, zero, -hx, -hy, hx, zero))
    a = b + LINEAR * 8
    store_run(ws, a, (m, m, m, zero, zero, zero))


@in_place
def _outward(tree: Any, constants: Any, beams: Any, ws: Any, n: int) -> None:
    """Velocities of all nodes and their bias wrenches; articulated inertias start as the nodes' own."""
    for i in range(tree.shape[0]):
        b = (n * JOINT + GROUP + i * BODY) * 8
        k = i * CONSTANTS * 8
        kind = tree[i, KIND]
        if kind == ABSENT:
            continue
        parent = tree[i, PARENT]
        j = tree[i, COORDINATE] * JOINT * 8
        c, s = load_run(constants, k + DELTA * 8, 2)
        zero = spread(0.0)
        qd, spin, xd, yd, xdd = zero, zero, zero, zero, zero
        q = zero
        if kind <= PRISMATIC:
            q = load(ws, j + Q * 8)
            qd = load(ws, j + QD * 8)
        if kind == REVOLUTE:
            sq, cq = sine_cosine(q)
            c, s = cq * c - sq * s, sq * c + cq * s
        if kind == SECTION:
            # Where the section is and how it is turned, from the beam's modes.
            m = tree[i, MODES]
            e = tree[i, TABLE] * 8
            work = tree[i, WORK] * 8
            x = load(beams, e)
            y, turn = zero, zero
            for f in range(m):
                qf = load(ws, j + (f * JOINT + Q) * 8)
                qdf = load(ws, j + (f * JOINT + QD) * 8)
                hb, hd = zero, zero
                for l in range(m):
                    h = load(beams, e + (1 + 2 * m + f * m + l) * 8)
                    hb = hb + h * load(ws, j + (l * JOINT + Q) * 8)
                    hd = hd + h * load(ws, j + (l * JOINT + QD) * 8)
                x = x - 0.5 * (hb * qf)
                xd = xd - hb * qdf
                xdd = xdd - hd * qdf
                y = y + load(beams, e + (1 + f) * 8) * qf
                yd = yd + load(beams, e + (1 + f) * 8) * qdf
                turn = turn + load(beams, e + (1 + m + f) * 8) * qf
                spin = spin + load(beams, e + (1 + m + f) * 8) * qdf
                store(ws, work + f * 8, -hb)
            store_run(constants, k + R * 8, (x, y))
            s, c = sine_cosine(turn)
        store_run(ws, b + TURN * 8, (c, s))
        if parent >= 0:
            p = (n * JOINT + GROUP + parent * BODY) * 8
            wx, wy, wz = load_run(ws, p + OMEGA * 8, 3)
            vx, vy, vz = load_run(ws, p + VELOCITY * 8, 3)
            if tree[i, PREFIX] != 0:
                cg, sg = load_run(constants, k + GAMMA * 8, 2)
                wx, wy = turn_forward(cg, sg, wx, wy)
                vx, vy = turn_forward(cg, sg, vx, vy)
            rx, ry, rz = load_run(constants, k + R * 8, 3)
            vx = vx + (wy * rz - wz * ry)
            vy = vy + (wz * rx - wx * rz)
            vz = vz + (wx * ry - wy * rx)
            ca, sa = load_run(constants, k + ALPHA * 8, 2)
            wy, wz = turn_forward(ca, sa, wy, wz)
            vy, vz = turn_forward(ca, sa, vy, vz)
            wx, wy = turn_forward(c, s, wx, wy)
            vx, vy = turn_forward(c, s, vx, vy)
        else:
            wx, wy, wz, vx, vy, vz = zero, zero, zero, zero, zero, zero
        if kind == REVOLUTE:
            wz = wz + qd
        elif kind == PRISMATIC:
            vx = vx + wy * q
            vy = vy - wx * q
            vz = vz + qd
        elif kind == SECTION:
            xd, yd = turn_forward(c, s, xd, yd)
            xdd, ydd = turn_forward(c, s, xdd, zero)
            wz = wz + spin
            vx = vx + xd
            vy = vy + yd
            # Bias acceleration: velocity × relative velocity, and the change of the latter in the section's axes.
            a = b + COLUMN * 8
            store_run(
                ws,
                a,
                (
                    wy * spin,
                    -wx * spin,
                    zero,
                    vy * spin - wz * yd + xdd + spin * yd,
                    wz * xd - vx * spin + ydd - spin * xd,
                    wx * yd - wy * xd,
                ),
            )
        store_run(ws, b + OMEGA * 8, (wx, wy, wz))
        store_run(ws, b + VELOCITY * 8, (vx, vy, vz))
        if kind == BEAM:
            _beam_outward(tree, beams, ws, n, i)
            continue
        m = load(constants, k + MASS * 8)
        hx, hy, hz = load_run(constants, k + FIRST * 8, 3)
        ixx, iyy, izz, ixy, ixz, iyz = load_run(constants, k + SECOND * 8, 6)
        nx = ixx * wx + ixy * wy + ixz * wz + (hy * vz - hz * vy)
        ny = ixy * wx + iyy * wy + iyz * wz + (hz * vx - hx * vz)
        nz = ixz * wx + iyz * wy + izz * wz + (hx * vy - hy * vx)
        fx = m * vx + (wy * hz - wz * hy)
        fy = m * vy + (wz * hx - wx * hz)
        fz = m * vz + (wx * hy - wy * hx)
        _fill(
            ws, b, m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz,
            (wy * nz - wz * ny) + (vy * fz - vz * fy),
            (wz * nx - wx * nz) + (vz * fx - vx * fz),
            (wx * ny - wy * nx) + (vx * fy - vy * fx),
            wy * fz - wz * fy,
            wz * fx - wx * fz,
            wx * fy - wy * fx,
        )  # fmt: skip


@inner
def _eliminate_modes(tree: Any, beams: Any, ws: Any, n: int, i: int) -> None:
    """Take a beam's modes out of its articulated inertia and bias; leaves L, L⁻¹ Nᵀ and L⁻¹ y of A = L Lᵀ."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    e = tree[i, TABLE] * 8
    work = tree[i, WORK] * 8
    modal = work + 6 * m * 8
    bias = modal + m * m * 8
    first = tree[i, COORDINATE] * JOINT * 8
    group = n * JOINT * 8
    late = load(ws, group + TIME * 8) - load(ws, group + TAU_TIME * 8)
    for k in range(m):
        c = first + k * JOINT * 8
        y = load(ws, c + TAU * 8) + load(ws, c + TAU_SLOPE * 8) * late - load(ws, bias + k * 8)
        for l in range(m):
            y = y - load(beams, e + (k * m + l) * 8) * load(ws, first + (l * JOINT + Q) * 8)
            y = y - load(beams, e + (m * m + k * m + l) * 8) * load(ws, first + (l * JOINT + QD) * 8)
        # Row k of L, and forward substitution of y and of the row of Nᵀ.
        for l in range(k + 1):
            value = load(ws, modal + (k * m + l) * 8)
            for r in range(l):
                value = value - load(ws, modal + (k * m + r) * 8) * load(ws, modal + (l * m + r) * 8)
            if l < k:
                store(ws, modal + (k * m + l) * 8, value / load(ws, modal + (l * m + l) * 8))
            else:
                store(ws, modal + (k * m + k) * 8, square_root(value))
        inverse = 1.0 / load(ws, modal + (k * m + k) * 8)
        for r in range(k):
            y = y - load(ws, modal + (k * m + r) * 8) * load(ws, bias + r * 8)
        y = y * inverse
        store(ws, bias + k * 8, y)
        for d in range(6):
            value = load(ws, work + (6 * k + d) * 8)
            for r in range(k):
                value = value - load(ws, modal + (k * m + r) * 8) * load(ws, work + (6 * r + d) * 8)
            store(ws, work + (6 * k + d) * 8, value * inverse)
        n1, n2, n3, n4, n5, n6 = load_run(ws, work + 6 * k * 8, 6)
        a = b + ANGULAR * 8
        add_run(
            ws,
            a,
            (
                -(n1 * n1),
                -(n2 * n2),
                -(n3 * n3),
                -(n1 * n2),
                -(n1 * n3),
                -(n2 * n3),
            ),
        )
        a = b + MIXED * 8
        add_run(
            ws,
            a,
            (
                -(n1 * n4),
                -(n1 * n5),
                -(n1 * n6),
                -(n2 * n4),
                -(n2 * n5),
                -(n2 * n6),
                -(n3 * n4),
                -(n3 * n5),
                -(n3 * n6),
            ),
        )
        a = b + LINEAR * 8
        add_run(
            ws,
            a,
            (
                -(n4 * n4),
                -(n5 * n5),
                -(n6 * n6),
                -(n4 * n5),
                -(n4 * n6),
                -(n5 * n6),
            ),
        )
        for d in range(6):
            a = b + (BIAS + d) * 8
            store(ws, a, load(ws, a) + load(ws, work + (6 * k + d) * 8) * y)


@inner
def _accelerate_modes(tree: Any, ws: Any, n: int, i: int) -> None:
    """Modal accelerations L⁻ᵀ (L⁻¹ y − L⁻¹ Nᵀ a) from the beam node's acceleration a."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    work = tree[i, WORK] * 8
    modal = work + 6 * m * 8
    bias = modal + m * m * 8
    first = tree[i, COORDINATE] * JOINT * 8
    for k in range(m - 1, -1, -1):
        value = load(ws, bias + k * 8)
        for d in range(6):
            value = value - load(ws, work + (6 * k + d) * 8) * load(ws, b + (ACCELERATION + d) * 8)
        for r in range(k + 1, m):
            value = value - load(ws, modal + (r * m + k) * 8) * load(ws, first + (r * JOINT + QDD) * 8)
        store(ws, first + (k * JOINT + QDD) * 8, value / load(ws, modal + (k * m + k) * 8))


@inner
def user_forces(laws: Any, ws: Any, user: int, time: int, j: int, start: int) -> Any:
    """The user's own law, called lane by lane; eight forces in the scratch vector.

    Behind its four parameters stands the effort that is applied at the joint, which a drive keeps within its range.
    """
    scratch = time + (SCRATCH - TIME) * 8
    for lane in range(8):
        first = start + lane
        scale = laws[first + law.USER_SCALE * 8]
        value = 0.0
        if scale != 0.0 and user != 0:
            for p in range(4):
                ws[scratch + 8 + p] = laws[first + (law.USER_1 + p) * 8]
            late = ws[time + lane] - ws[time + (TAU_TIME - TIME) * 8 + lane]
            ws[scratch + 12] = ws[j + TAU * 8 + lane] + ws[j + TAU_SLOPE * 8 + lane] * late
            value = scale * call_at(
                user, ws[j + Q * 8 + lane], ws[j + QD * 8 + lane], ws[time + lane], address_of(ws, scratch + 8)
            )
        ws[scratch + lane] = value


@in_place
def _inward(tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, user: int) -> None:
    """Eliminate the modes and the free joints from the tips to the base."""
    group = n * JOINT * 8
    for i in range(tree.shape[0] - 1, -1, -1):
        b = (n * JOINT + GROUP + i * BODY) * 8
        k = i * CONSTANTS * 8
        kind = tree[i, KIND]
        if kind == ABSENT:
            continue
        parent = tree[i, PARENT]
        own = tree[i, COORDINATE]
        j = own * JOINT * 8
        l = own * law.WIDTH * 8
        if kind == BEAM:
            _eliminate_modes(tree, beams, ws, n, i)
            if parent < 0:
                continue
        q = spread(0.0)
        force = q
        qd = q
        if kind <= PRISMATIC:
            q = load(ws, j + Q * 8)
            qd = load(ws, j + QD * 8)
            force = load(ws, j + TAU * 8) + load(ws, j + TAU_SLOPE * 8) * (
                load(ws, group + TIME * 8) - load(ws, group + TAU_TIME * 8)
            )
            direction = load(ws, j + DIRECTION * 8)
            force = force + law.passive_force(
                laws,
                l,
                flags[own],
                q,
                qd,
                direction,
                load(ws, j + CONTACT * 8),
                load(ws, j + ANCHOR * 8),
                load(ws, j + GRIP * 8),
                load(ws, j + REACTION * 8),
                load(ws, j + SLIPS * 8),
            )
            if flags[own] & law.HAS_USER:
                user_forces(laws, ws, user, group + TIME * 8, j, l)
                force = force + load(ws, group + SCRATCH * 8)
        a = b + ANGULAR * 8
        axx, ayy, azz, axy, axz, ayz = load_run(ws, a, 6)
        a = b + MIXED * 8
        bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = load_run(ws, a, 9)
        a = b + LINEAR * 8
        mxx, myy, mzz, mxy, mxz, myz = load_run(ws, a, 6)
        a = b + BIAS * 8
        px, py, pz, fx, fy, fz = load_run(ws, a, 6)
        if kind <= PRISMATIC:
            armature = law.axis_inertia(laws, l, flags[own], load(ws, j + SLIPS * 8), load(ws, j + CONTACT * 8))
            free = load(ws, j + FREE * 8)
            if kind == REVOLUTE:
                u1, u2, u3, u4, u5, u6 = axz, ayz, azz, bzx, bzy, bzz
                inverse = free / (azz + armature)
                force = force - pz
            else:
                u1, u2, u3, u4, u5, u6 = bxz, byz, bzz, mxz, myz, mzz
                inverse = free / (mzz + armature)
                force = force - fz
            a = b + COLUMN * 8
            store_run(ws, a, (u1, u2, u3, u4, u5, u6))
            store(ws, b + FORCE * 8, force)
            store(ws, b + INVERSE * 8, inverse)
            if parent < 0:
                continue
            k1 = u1 * inverse
            k2 = u2 * inverse
            k3 = u3 * inverse
            k4 = u4 * inverse
            k5 = u5 * inverse
            k6 = u6 * inverse
            axx = axx - k1 * u1
            ayy = ayy - k2 * u2
            azz = azz - k3 * u3
            axy = axy - k1 * u2
            axz = axz - k1 * u3
            ayz = ayz - k2 * u3
            bxx = bxx - k1 * u4
            bxy = bxy - k1 * u5
            bxz = bxz - k1 * u6
            byx = byx - k2 * u4
            byy = byy - k2 * u5
            byz = byz - k2 * u6
            bzx = bzx - k3 * u4
            bzy = bzy - k3 * u5
            bzz = bzz - k3 * u6
            mxx = mxx - k4 * u4
            myy = myy - k5 * u5
            mzz = mzz - k6 * u6
            mxy = mxy - k4 * u5
            mxz = mxz - k4 * u6
            myz = myz - k5 * u6
            # Bias acceleration of the joint: velocity × axis · rate.
            wx, wy = load_run(ws, b + OMEGA * 8, 2)
            if kind == REVOLUTE:
                vx, vy = load_run(ws, b + VELOCITY * 8, 2)
                c1, c2, c4, c5 = wy * qd, -wx * qd, vy * qd, -vx * qd
                px = px + axx * c1 + axy * c2
                py = py + axy * c1 + ayy * c2
                pz = pz + axz * c1 + ayz * c2
                fx = fx + bxx * c1 + byx * c2
                fy = fy + bxy * c1 + byy * c2
                fz = fz + bxz * c1 + byz * c2
            else:
                c4, c5 = wy * qd, -wx * qd
            px = px + bxx * c4 + bxy * c5 + k1 * force
            py = py + byx * c4 + byy * c5 + k2 * force
            pz = pz + bzx * c4 + bzy * c5 + k3 * force
            fx = fx + mxx * c4 + mxy * c5 + k4 * force
            fy = fy + mxy * c4 + myy * c5 + k5 * force
            fz = fz + mxz * c4 + myz * c5 + k6 * force
        elif kind == SECTION:
            c1, c2 = load_run(ws, b + COLUMN * 8, 2)
            c4, c5, c6 = load_run(ws, b + COLUMN * 8 + 24, 3)
            px = px + axx * c1 + axy * c2 + bxx * c4 + bxy * c5 + bxz * c6
            py = py + axy * c1 + ayy * c2 + byx * c4 + byy * c5 + byz * c6
            pz = pz + axz * c1 + ayz * c2 + bzx * c4 + bzy * c5 + bzz * c6
            fx = fx + bxx * c1 + byx * c2 + mxx * c4 + mxy * c5 + mxz * c6
            fy = fy + bxy * c1 + byy * c2 + mxy * c4 + myy * c5 + myz * c6
            fz = fz + bxz * c1 + byz * c2 + mxz * c4 + myz * c5 + mzz * c6
        if kind == PRISMATIC:
            zero = spread(0.0)
            (axx, ayy, azz, axy, axz, ayz, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz) = shift_tensors(
                zero, zero, q,
                axx, ayy, azz, axy, axz, ayz, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz,
                mxx, myy, mzz, mxy, mxz, myz,
            )  # fmt: skip
            px = px - q * fy
            py = py + q * fx
        c, s = load_run(ws, b + TURN * 8, 2)
        axx, ayy, azz, axy, axz, ayz = turn_symmetric(c, s, axx, ayy, azz, axy, axz, ayz)
        mxx, myy, mzz, mxy, mxz, myz = turn_symmetric(c, s, mxx, myy, mzz, mxy, mxz, myz)
        bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = turn_general(c, s, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz)
        px, py = c * px - s * py, s * px + c * py
        fx, fy = c * fx - s * fy, s * fx + c * fy
        if kind == SECTION:
            # What hangs on the section drives the modes through the section's partial twists (0, 0, s'; -H b, s, 0).
            m = tree[i, MODES]
            e = tree[i, TABLE] * 8
            own_work = tree[i, WORK] * 8
            work = tree[parent, WORK] * 8
            rx, ry = load_run(constants, k + R * 8, 2)
            for f in range(m):
                dx = load(ws, own_work + f * 8)
                dy = load(beams, e + (1 + f) * 8)
                dt = load(beams, e + (1 + m + f) * 8)
                g4 = bzx * dt + mxx * dx + mxy * dy
                g5 = bzy * dt + mxy * dx + myy * dy
                g6 = bzz * dt + mxz * dx + myz * dy
                g3 = azz * dt + bzx * dx + bzy * dy
                a = work + 6 * f * 8
                add_run(
                    ws,
                    a,
                    (
                        (axz * dt + bxx * dx + bxy * dy) + ry * g6,
                        (ayz * dt + byx * dx + byy * dy) - rx * g6,
                        g3 + (rx * g5 - ry * g4),
                        g4,
                        g5,
                        g6,
                    ),
                )
                for o in range(f + 1):
                    ex = load(ws, own_work + o * 8)
                    ey = load(beams, e + (1 + o) * 8)
                    et = load(beams, e + (1 + m + o) * 8)
                    a = work + (6 * m + f * m + o) * 8
                    store(ws, a, load(ws, a) + (et * g3 + ex * g4 + ey * g5))
                a = work + (6 * m + m * m + f) * 8
                store(ws, a, load(ws, a) + (dt * pz + dx * fx + dy * fy))
        else:
            # About x: the same formulas with the axes in the order y, z, x.
            c, s = load_run(constants, k + ALPHA * 8, 2)
            ayy, azz, axx, ayz, axy, axz = turn_symmetric(c, s, ayy, azz, axx, ayz, axy, axz)
            myy, mzz, mxx, myz, mxy, mxz = turn_symmetric(c, s, myy, mzz, mxx, myz, mxy, mxz)
            byy, byz, byx, bzy, bzz, bzx, bxy, bxz, bxx = turn_general(
                c, s, byy, byz, byx, bzy, bzz, bzx, bxy, bxz, bxx
            )
            py, pz = c * py - s * pz, s * py + c * pz
            fy, fz = c * fy - s * fz, s * fy + c * fz
        rx, ry, rz = load_run(constants, k + R * 8, 3)
        (axx, ayy, azz, axy, axz, ayz, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz) = shift_tensors(
            rx, ry, rz,
            axx, ayy, azz, axy, axz, ayz, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz,
            mxx, myy, mzz, mxy, mxz, myz,
        )  # fmt: skip
        px = px + (ry * fz - rz * fy)
        py = py + (rz * fx - rx * fz)
        pz = pz + (rx * fy - ry * fx)
        if tree[i, PREFIX] != 0:
            c, s = load_run(constants, k + GAMMA * 8, 2)
            axx, ayy, azz, axy, axz, ayz = turn_symmetric(c, s, axx, ayy, azz, axy, axz, ayz)
            mxx, myy, mzz, mxy, mxz, myz = turn_symmetric(c, s, mxx, myy, mzz, mxy, mxz, myz)
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = turn_general(
                c, s, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz
            )
            px, py = c * px - s * py, s * px + c * py
            fx, fy = c * fx - s * fy, s * fx + c * fy
        p = (n * JOINT + GROUP + parent * BODY) * 8
        a = p + ANGULAR * 8
        add_run(ws, a, (axx, ayy, azz, axy, axz, ayz))
        a = p + MIXED * 8
        add_run(ws, a, (bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz))
        a = p + LINEAR * 8
        add_run(ws, a, (mxx, myy, mzz, mxy, mxz, myz))
        a = p + BIAS * 8
        add_run(ws, a, (px, py, pz, fx, fy, fz))


@in_place
def in_any_lane(ws: Any, group: int, value: Any) -> float:
    """1 if a value is positive in any lane, else 0."""
    store(ws, group + SCRATCH * 8, value)
    found = 0.0
    for lane in range(8):
        if ws[group + SCRATCH * 8 + lane] > 0.0:
            found = 1.0
    return found


@in_place
def settled(laws: Any, ws: Any, group: int, l: int, update: Any, reaction: Any) -> Any:
    """A reaction's next value, and 1 if that changed in any lane whose friction depends on it."""
    change = magnitude(update - reaction) - 1e-13 * update
    # A settled lane keeps its value, so that its result does not depend on how long others iterate.
    update = choose(change, update, reaction)
    return update, in_any_lane(ws, group, choose(load(laws, l + law.MU_RADIUS * 8), change, -1.0))


@in_place
def still_slips(laws: Any, ws: Any, flags: int, group: int, l: int, j: int) -> float:
    """Renew which way soft dry friction slips; 1 if that changed in any lane."""
    slips = load(ws, j + SLIPS * 8)
    v, vdot, reaction = load(ws, j + QD * 8), load(ws, j + QDD * 8), load(ws, j + REACTION * 8)
    renewed = law.slipping(laws, l, flags, v, vdot, reaction, slips)
    store(ws, j + SLIPS * 8, renewed)
    return in_any_lane(ws, group, magnitude(renewed - slips))


@in_place
def _outward_accelerations(
    tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, shaken: int
) -> float:
    """Accelerations of joints and modes, forces that hold the held joints, reactions across the axes.

    Returns 1 while a reaction changes, for the fixed point of load-dependent friction, or soft friction begins or ends to slip.
    """
    group = n * JOINT * 8
    unsettled = 0.0
    for i in range(tree.shape[0]):
        b = (n * JOINT + GROUP + i * BODY) * 8
        k = i * CONSTANTS * 8
        kind = tree[i, KIND]
        if kind == ABSENT:
            continue
        parent = tree[i, PARENT]
        own = tree[i, COORDINATE]
        j = own * JOINT * 8
        l = own * law.WIDTH * 8
        if parent >= 0:
            p = (n * JOINT + GROUP + parent * BODY) * 8
            a = p + ACCELERATION * 8
            wx, wy, wz, vx, vy, vz = load_run(ws, a, 6)
        else:
            # Gravity as an acceleration of the base; so is the shaking of the base itself.
            zero = spread(0.0)
            wx, wy, wz = zero, zero, zero
            g = group + SHAKE * 8
            vx = -load(ws, g)
            vy = -load(ws, g + 8)
            vz = -load(ws, g + 16)
            if shaken:
                phase = load(ws, g + 24) * load(ws, group + TIME * 8) + load(ws, g + 32)
                pulse, _ = sine_cosine(phase)
                vx = vx + load(ws, g + 40) * pulse
                vy = vy + load(ws, g + 48) * pulse
                vz = vz + load(ws, g + 56) * pulse
        if tree[i, PREFIX] != 0:
            c, s = load_run(constants, k + GAMMA * 8, 2)
            wx, wy = turn_forward(c, s, wx, wy)
            vx, vy = turn_forward(c, s, vx, vy)
        if parent >= 0:
            rx, ry, rz = load_run(constants, k + R * 8, 3)
            vx = vx + (wy * rz - wz * ry)
            vy = vy + (wz * rx - wx * rz)
            vz = vz + (wx * ry - wy * rx)
        c, s = load_run(constants, k + ALPHA * 8, 2)
        wy, wz = turn_forward(c, s, wy, wz)
        vy, vz = turn_forward(c, s, vy, vz)
        c, s = load_run(ws, b + TURN * 8, 2)
        wx, wy = turn_forward(c, s, wx, wy)
        vx, vy = turn_forward(c, s, vx, vy)
        if kind >= BEAM:
            if kind == SECTION:
                m = tree[i, MODES]
                e = tree[i, TABLE] * 8
                own_work = tree[i, WORK] * 8
                wx = wx + load(ws, b + COLUMN * 8)
                wy = wy + load(ws, b + COLUMN * 8 + 8)
                x = spread(0.0)
                y = x
                for f in range(m):
                    qdd = load(ws, j + (f * JOINT + QDD) * 8)
                    x = x + load(ws, own_work + f * 8) * qdd
                    y = y + load(beams, e + (1 + f) * 8) * qdd
                    wz = wz + load(beams, e + (1 + m + f) * 8) * qdd
                x, y = turn_forward(c, s, x, y)
                vx = vx + x + load(ws, b + COLUMN * 8 + 24)
                vy = vy + y + load(ws, b + COLUMN * 8 + 32)
                vz = vz + load(ws, b + COLUMN * 8 + 40)
            a = b + ACCELERATION * 8
            store_run(ws, a, (wx, wy, wz, vx, vy, vz))
            if kind == BEAM:
                _accelerate_modes(tree, ws, n, i)
            continue
        q = load(ws, j + Q * 8)
        qd = load(ws, j + QD * 8)
        ox, oy = load_run(ws, b + OMEGA * 8, 2)
        if kind == REVOLUTE:
            wx = wx + oy * qd
            wy = wy - ox * qd
            vx = vx + load(ws, b + VELOCITY * 8 + 8) * qd
            vy = vy - load(ws, b + VELOCITY * 8) * qd
        else:
            vx = vx + wy * q + oy * qd
            vy = vy - wx * q - ox * qd
        a = b + COLUMN * 8
        push = (
            load(ws, a) * wx
            + load(ws, a + 8) * wy
            + load(ws, a + 16) * wz
            + load(ws, a + 24) * vx
            + load(ws, a + 32) * vy
            + load(ws, a + 40) * vz
        ) - load(ws, b + FORCE * 8)
        qdd = -load(ws, b + INVERSE * 8) * push
        store(ws, j + QDD * 8, qdd)
        if kind == REVOLUTE:
            wz = wz + qdd
        else:
            vz = vz + qdd
        a = b + ACCELERATION * 8
        store_run(ws, a, (wx, wy, wz, vx, vy, vz))
        if flags[own] & law.RUBS:
            reaction = load(ws, j + REACTION * 8)
            if flags[own] & law.HAS_LOAD:
                a = b + MIXED * 8
                m = b + LINEAR * 8
                fx = (
                    load(ws, a) * wx + load(ws, a + 24) * wy + load(ws, a + 48) * wz
                    + load(ws, m) * vx + load(ws, m + 24) * vy + load(ws, m + 32) * vz
                    + load(ws, b + BIAS * 8 + 24)
                )  # fmt: skip
                fy = (
                    load(ws, a + 8) * wx + load(ws, a + 32) * wy + load(ws, a + 56) * wz
                    + load(ws, m + 24) * vx + load(ws, m + 8) * vy + load(ws, m + 40) * vz
                    + load(ws, b + BIAS * 8 + 32)
                )  # fmt: skip
                reaction, changed = settled(laws, ws, group, l, square_root(fx * fx + fy * fy), reaction)
                unsettled = max(unsettled, changed)
                store(ws, j + REACTION * 8, reaction)
            store(ws, j + HOLD * 8, push)
            store(ws, j + LIMIT * 8, law.sticking_limit(laws, l, flags[own], reaction))
            if flags[own] & law.HAS_SOFT:
                unsettled = max(unsettled, still_slips(laws, ws, flags[own], group, l, j))
    return unsettled


@inner
def accelerations(
    tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, user: int, shaken: int, loaded: int
) -> None:
    """Accelerations of all lanes of a group from the state in the workspace, left there."""
    if loaded:
        for i in range(n):
            j = i * JOINT * 8
            store(ws, j + REACTION * 8, load(ws, j + REACTION_START * 8))
    for _ in range(60 if loaded else 1):
        _outward(tree, constants, beams, ws, n)
        _inward(tree, flags, constants, beams, laws, ws, n, user)
        if _outward_accelerations(tree, flags, constants, beams, laws, ws, n, shaken) == 0.0:
            break
