"""Accelerations of eight copies of a tree at once: articulated-body elimination of modes and of free joints, held joints kept.

The recursion is the U D Uᵀ elimination of the generalized inertia matrix in its O(n) form (the DeNOC forward
dynamics). A tree is a list of nodes. A *joint* node is a body, re-framed so that the joint's axis is z and, along a first
child, a constant turn about x leads from one body to the next. A flexible link adds a *beam* node, fixed to the
link's body, with axes (f, h, n) and the modes as its coordinates, and *section* nodes on it, one where each child rides and
one at the tip for the payload. Spatial vectors are (angular, linear) about the node's origin in the node's axes.
A joint that dry friction holds is not eliminated: its row stays in the articulated inertia, its acceleration is zero,
and the force that holds it is what is left of its equation.

Beams bend in one plane: a point is at (x - ½ bᵀ H b) f + (s·b) h, a section there is turned about n by s'·b.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.nodes import (
    ABSENT,
    ACCELERATION,
    ALPHA,
    ANGULAR,
    BEAM,
    BIAS,
    BODY,
    COLUMN,
    CONSTANTS,
    CONTACT,
    COORDINATE,
    DELTA,
    FIRST,
    FORCE,
    FREE,
    GAMMA,
    GROUP,
    INVERSE,
    JOINT,
    KIND,
    LINEAR,
    MASS,
    MIXED,
    MODES,
    OMEGA,
    PARENT,
    POINTS,
    PREFIX,
    PRISMATIC,
    QD,
    QDD,
    REVOLUTE,
    SECOND,
    SECTION,
    SLIPS,
    TABLE,
    TURN,
    VELOCITY,
    WORK,
    Q,
    R,
    bent,
    bent_section,
    joint_force,
    modal_force,
    restart_reactions,
    rub,
    shaken_base,
)
from harness.denoc.lanes.spatial import (
    bias_wrench,
    shift_articulated,
    slide_articulated_back,
    turn_articulated,
    turn_articulated_about_x,
    turn_forward,
    turn_motion,
    without_joint,
)
from harness.denoc.simd.vector import (
    add_run,
    in_place,
    inner,
    load,
    load_run,
    sine_cosine,
    spread,
    square_root,
    store,
    store_run,
)


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
        # The axial parts wait in the coupling's place for linear z, which has none.
        x, y, xd, yd, xdd = bent(beams, ws, x, at + 16, at + (2 + m) * 8, m, first, work + 40, 6)
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
            x, y, xd, yd, xdd, turn, spin = bent_section(beams, ws, e, m, j, work)
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
            wx, wy, wz, vx, vy, vz = turn_motion(ca, sa, c, s, wx, wy, wz, vx, vy, vz)
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
        px, py, pz, fx, fy, fz = bias_wrench(m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz, wx, wy, wz, vx, vy, vz)
        _fill(ws, b, m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz, px, py, pz, fx, fy, fz)


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
    for k in range(m):
        y = modal_force(beams, ws, group, e, m, first, k, load(ws, bias + k * 8))
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
            force = joint_force(laws, ws, flags[own], user, group, l, j)
        angular = load_run(ws, b + ANGULAR * 8, 6)
        mixed = load_run(ws, b + MIXED * 8, 9)
        linear = load_run(ws, b + LINEAR * 8, 6)
        px, py, pz, fx, fy, fz = load_run(ws, b + BIAS * 8, 6)
        if kind <= PRISMATIC:
            armature = law.axis_inertia(laws, l, flags[own], load(ws, j + SLIPS * 8), load(ws, j + CONTACT * 8))
            free = load(ws, j + FREE * 8)
            axx, ayy, azz, axy, axz, ayz = angular
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
            mxx, myy, mzz, mxy, mxz, myz = linear
            if kind == REVOLUTE:
                column = (axz, ayz, azz, bzx, bzy, bzz)
                inverse = free / (azz + armature)
                force = force - pz
            else:
                column = (bxz, byz, bzz, mxz, myz, mzz)
                inverse = free / (mzz + armature)
                force = force - fz
            store_run(ws, b + COLUMN * 8, column)
            store(ws, b + FORCE * 8, force)
            store(ws, b + INVERSE * 8, inverse)
            if parent < 0:
                continue
            u1, u2, u3, u4, u5, u6 = column
            gain = (u1 * inverse, u2 * inverse, u3 * inverse, u4 * inverse, u5 * inverse, u6 * inverse)
            angular, mixed, linear = without_joint(gain, column, angular, mixed, linear)
            k1, k2, k3, k4, k5, k6 = gain
            axx, ayy, azz, axy, axz, ayz = angular
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
            mxx, myy, mzz, mxy, mxz, myz = linear
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
            axx, ayy, azz, axy, axz, ayz = angular
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
            mxx, myy, mzz, mxy, mxz, myz = linear
            c1, c2 = load_run(ws, b + COLUMN * 8, 2)
            c4, c5, c6 = load_run(ws, b + COLUMN * 8 + 24, 3)
            px = px + axx * c1 + axy * c2 + bxx * c4 + bxy * c5 + bxz * c6
            py = py + axy * c1 + ayy * c2 + byx * c4 + byy * c5 + byz * c6
            pz = pz + axz * c1 + ayz * c2 + bzx * c4 + bzy * c5 + bzz * c6
            fx = fx + bxx * c1 + byx * c2 + mxx * c4 + mxy * c5 + mxz * c6
            fy = fy + bxy * c1 + byy * c2 + mxy * c4 + myy * c5 + myz * c6
            fz = fz + bxz * c1 + byz * c2 + mxz * c4 + myz * c5 + mzz * c6
        bias = (px, py, pz, fx, fy, fz)
        if kind == PRISMATIC:
            angular, mixed, linear, bias = slide_articulated_back(q, angular, mixed, linear, bias)
        c, s = load_run(ws, b + TURN * 8, 2)
        angular, mixed, linear, bias = turn_articulated(c, s, angular, mixed, linear, bias)
        if kind == SECTION:
            # What hangs on the section drives the modes through the section's partial twists (0, 0, s'; -H b, s, 0).
            m = tree[i, MODES]
            e = tree[i, TABLE] * 8
            own_work = tree[i, WORK] * 8
            work = tree[parent, WORK] * 8
            rx, ry = load_run(constants, k + R * 8, 2)
            _, _, azz, _, axz, ayz = angular
            bxx, bxy, _, byx, byy, _, bzx, bzy, bzz = mixed
            mxx, myy, _, mxy, mxz, myz = linear
            _, _, pz, fx, fy, _ = bias
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
            c, s = load_run(constants, k + ALPHA * 8, 2)
            angular, mixed, linear, bias = turn_articulated_about_x(c, s, angular, mixed, linear, bias)
        rx, ry, rz = load_run(constants, k + R * 8, 3)
        angular, mixed, linear, bias = shift_articulated(rx, ry, rz, angular, mixed, linear, bias)
        if tree[i, PREFIX] != 0:
            c, s = load_run(constants, k + GAMMA * 8, 2)
            angular, mixed, linear, bias = turn_articulated(c, s, angular, mixed, linear, bias)
        p = (n * JOINT + GROUP + parent * BODY) * 8
        add_run(ws, p + ANGULAR * 8, angular)
        add_run(ws, p + MIXED * 8, mixed)
        add_run(ws, p + LINEAR * 8, linear)
        add_run(ws, p + BIAS * 8, bias)


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
            zero = spread(0.0)
            wx, wy, wz = zero, zero, zero
            vx, vy, vz = shaken_base(ws, group, shaken)
        if tree[i, PREFIX] != 0:
            c, s = load_run(constants, k + GAMMA * 8, 2)
            wx, wy = turn_forward(c, s, wx, wy)
            vx, vy = turn_forward(c, s, vx, vy)
        if parent >= 0:
            rx, ry, rz = load_run(constants, k + R * 8, 3)
            vx = vx + (wy * rz - wz * ry)
            vy = vy + (wz * rx - wx * rz)
            vz = vz + (wx * ry - wy * rx)
        ca, sa = load_run(constants, k + ALPHA * 8, 2)
        c, s = load_run(ws, b + TURN * 8, 2)
        wx, wy, wz, vx, vy, vz = turn_motion(ca, sa, c, s, wx, wy, wz, vx, vy, vz)
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
            fx, fy = spread(0.0), spread(0.0)
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
            unsettled = max(unsettled, rub(laws, ws, flags[own], group, l, j, push, fx, fy))
    return unsettled


@inner
def accelerations(
    tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, user: int, shaken: int, loaded: int
) -> None:
    """Accelerations of all lanes of a group from the state in the workspace, left there."""
    if loaded:
        restart_reactions(ws, n)
    for _ in range(60 if loaded else 1):
        _outward(tree, constants, beams, ws, n)
        _inward(tree, flags, constants, beams, laws, ws, n, user)
        if _outward_accelerations(tree, flags, constants, beams, laws, ws, n, shaken) == 0.0:
            break
