"""Accelerations of eight copies of a tree that moves in one plane: ``lanes.tree`` in three dimensions instead of six.

Where all revolute axes and the axes that beams bend about are parallel, and all prismatic axes across them, nothing but the
motion in that plane is felt: a body is its mass, its first moments and one moment of inertia, an
articulated inertia has six elements instead of twenty-one, and nothing has to be turned from frame to frame, since all is kept
in the base's axes X, Y and about the normal N. Accelerations are the classical ones of a node's origin, so that no
linear velocities are needed. Nodes, laws, held joints and the places of the coordinates are those of ``lanes.nodes``.

A wrench is (moment about N, force X, force Y), an acceleration (α, aX, aY), an articulated inertia (00, 01, 02, 11, 12, 22).
"""

from __future__ import annotations

from typing import Any

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.nodes import (
    ABSENT,
    BEAM,
    BODY,
    CONSTANTS,
    CONTACT,
    COORDINATE,
    FIRST,
    FREE,
    GROUP,
    JOINT,
    KIND,
    MASS,
    MODES,
    PARENT,
    PLANE_F,
    POINTS,
    PRISMATIC,
    QD,
    QDD,
    REVOLUTE,
    SECOND,
    SECTION,
    SIGN,
    SLIPS,
    TABLE,
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

# One node's workspace: spin, cosine and sine of the node's angle, offset from the parent's origin, bias acceleration, two
# directions (of the slide, or f and h of a beam), articulated inertia and bias wrench, column of the joint, force,
# inverse of the joint's inertia, acceleration.
SPIN, TURN, OFFSET, DRIFT, ALONG, ACROSS, ARTICULATED, BIAS, COLUMN, FORCE, INVERSE, ACCELERATION = (
    0, 1, 3, 5, 7, 9, 11, 17, 20, 23, 24, 25,
)  # fmt: skip


@inner
def _beam(tree: Any, beams: Any, ws: Any, n: int, i: int) -> None:
    """Inertia, coupling and bias of a beam node's mass points at its spin and bending."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    e = (tree[i, TABLE] + 2 * m * m) * 8
    work = tree[i, WORK] * 8
    first = tree[i, COORDINATE] * JOINT * 8
    side = float(tree[i, SIGN])
    zero = spread(0.0)
    for k in range(4 * m + m * m):
        store(ws, work + k * 8, zero)
    w = load(ws, b + SPIN * 8) * side
    square = w * w
    twice = w + w
    mass, hx, hy, second, moment, fx, fy = zero, zero, zero, zero, zero, zero, zero
    size = (2 + m + m * m) * 8
    modal = work + 3 * m * 8
    bias = modal + m * m * 8
    # The axial parts of the modes' partial velocities at a point, behind the rest.
    axial = bias + m * 8
    for p in range(tree[i, POINTS]):
        at = e + p * size
        one, x = load_run(beams, at, 2)
        x, y, xd, yd, xdd = bent(beams, ws, x, at + 16, at + (2 + m) * 8, m, first, axial, 1)
        mass = mass + one * one
        hx = hx + one * x
        hy = hy + one * y
        second = second + x * x + y * y
        cx = xdd - square * x - twice * yd
        cy = twice * xd - square * y
        fx = fx + one * cx
        fy = fy + one * cy
        moment = moment + (x * cy - y * cx)
        for k in range(m):
            dx = load(ws, axial + k * 8)
            dy = load(beams, at + (2 + k) * 8)
            add_run(ws, work + 3 * k * 8, ((x * dy - y * dx), one * dx, one * dy))
            store(ws, bias + k * 8, load(ws, bias + k * 8) + (dx * cx + dy * cy))
            for l in range(k + 1):
                a = modal + (k * m + l) * 8
                ex = load(ws, axial + l * 8)
                ey = load(beams, at + (2 + l) * 8)
                store(ws, a, load(ws, a) + (dx * ex + dy * ey))
    ax, ay = load_run(ws, b + ALONG * 8, 2)
    bx, by = load_run(ws, b + ACROSS * 8, 2)
    for k in range(m):
        t, x, y = load_run(ws, work + 3 * k * 8, 3)
        store_run(ws, work + 3 * k * 8, (side * t, ax * x + bx * y, ay * x + by * y))
    store_run(
        ws,
        b + ARTICULATED * 8,
        (
            second,
            -(ay * hx + by * hy),
            ax * hx + bx * hy,
            mass,
            zero,
            mass,
            side * moment,
            ax * fx + bx * fy,
            ay * fx + by * fy,
        ),
    )


@inner
def _eliminate_modes(tree: Any, beams: Any, ws: Any, n: int, i: int) -> None:
    """Take a beam's modes out of its articulated inertia and bias; leaves L, L⁻¹ Nᵀ and L⁻¹ y of A = L Lᵀ."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    e = tree[i, TABLE] * 8
    work = tree[i, WORK] * 8
    modal = work + 3 * m * 8
    bias = modal + m * m * 8
    first = tree[i, COORDINATE] * JOINT * 8
    group = n * JOINT * 8
    a00, a01, a02, a11, a12, a22, b0, b1, b2 = load_run(ws, b + ARTICULATED * 8, 9)
    for k in range(m):
        y = modal_force(beams, ws, group, e, m, first, k, load(ws, bias + k * 8))
        # Row k of L (its diagonal kept inverse), and forward substitution of y and of the row of Nᵀ.
        pivot = load(ws, modal + (k * m + k) * 8)
        n0, n1, n2 = load_run(ws, work + 3 * k * 8, 3)
        for l in range(k):
            value = load(ws, modal + (k * m + l) * 8)
            for r in range(l):
                value = value - load(ws, modal + (k * m + r) * 8) * load(ws, modal + (l * m + r) * 8)
            value = value * load(ws, modal + (l * m + l) * 8)
            store(ws, modal + (k * m + l) * 8, value)
            pivot = pivot - value * value
            y = y - value * load(ws, bias + l * 8)
            o0, o1, o2 = load_run(ws, work + 3 * l * 8, 3)
            n0 = n0 - value * o0
            n1 = n1 - value * o1
            n2 = n2 - value * o2
        inverse = 1.0 / square_root(pivot)
        store(ws, modal + (k * m + k) * 8, inverse)
        y = y * inverse
        store(ws, bias + k * 8, y)
        n0 = n0 * inverse
        n1 = n1 * inverse
        n2 = n2 * inverse
        store_run(ws, work + 3 * k * 8, (n0, n1, n2))
        a00 = a00 - n0 * n0
        a01 = a01 - n0 * n1
        a02 = a02 - n0 * n2
        a11 = a11 - n1 * n1
        a12 = a12 - n1 * n2
        a22 = a22 - n2 * n2
        b0 = b0 + n0 * y
        b1 = b1 + n1 * y
        b2 = b2 + n2 * y
    store_run(ws, b + ARTICULATED * 8, (a00, a01, a02, a11, a12, a22, b0, b1, b2))


@inner
def _accelerate_modes(tree: Any, ws: Any, n: int, i: int) -> None:
    """Modal accelerations L⁻ᵀ (L⁻¹ y − L⁻¹ Nᵀ a) from the beam node's acceleration a."""
    b = (n * JOINT + GROUP + i * BODY) * 8
    m = tree[i, MODES]
    work = tree[i, WORK] * 8
    modal = work + 3 * m * 8
    bias = modal + m * m * 8
    first = tree[i, COORDINATE] * JOINT * 8
    turning, x, y = load_run(ws, b + ACCELERATION * 8, 3)
    for k in range(m - 1, -1, -1):
        n0, n1, n2 = load_run(ws, work + 3 * k * 8, 3)
        value = load(ws, bias + k * 8) - (n0 * turning + n1 * x + n2 * y)
        for r in range(k + 1, m):
            value = value - load(ws, modal + (r * m + k) * 8) * load(ws, first + (r * JOINT + QDD) * 8)
        store(ws, first + (k * JOINT + QDD) * 8, value * load(ws, modal + (k * m + k) * 8))


@in_place
def _outward(tree: Any, constants: Any, beams: Any, ws: Any, n: int) -> None:
    """Angles, spins and bias accelerations of all nodes; articulated inertias start as the nodes' own."""
    for i in range(tree.shape[0]):
        b = (n * JOINT + GROUP + i * BODY) * 8
        k = i * CONSTANTS * 8
        kind = tree[i, KIND]
        if kind == ABSENT:
            continue
        parent = tree[i, PARENT]
        j = tree[i, COORDINATE] * JOINT * 8
        sign = float(tree[i, SIGN])
        zero = spread(0.0)
        w = zero
        c = spread(1.0)
        s = zero
        if parent >= 0:
            p = (n * JOINT + GROUP + parent * BODY) * 8
            w, c, s = load_run(ws, p + SPIN * 8, 3)
        if kind == SECTION:
            # Where the section is and how it is turned, from the beam's modes, in the beam's axes.
            m = tree[i, MODES]
            e = tree[i, TABLE] * 8
            work = tree[i, WORK] * 8
            x, y, xd, yd, xdd, turn, spin = bent_section(beams, ws, e, m, j, work)
            p = (n * JOINT + GROUP + parent * BODY) * 8
            ax, ay = load_run(ws, p + ALONG * 8, 2)
            bx, by = load_run(ws, p + ACROSS * 8, 2)
            twice = (w + w) * sign
            lx = xdd - (w * w) * x - twice * yd
            ly = twice * xd - (w * w) * y
            store_run(
                ws, b + OFFSET * 8, (ax * x + bx * y, ay * x + by * y, ax * lx + bx * ly, ay * lx + by * ly)
            )  # fmt: skip
            sq, cq = sine_cosine(turn)
            sq = sq * sign
            c, s = c * cq - s * sq, s * cq + c * sq
            w = w + sign * spin
        else:
            if parent >= 0:
                rx, ry = load_run(constants, k + R * 8, 2)
                x = c * rx - s * ry
                y = s * rx + c * ry
            else:
                x, y = zero, zero
            dx, dy = zero, zero
            if kind == PRISMATIC:
                fx, fy = load_run(constants, k + PLANE_F * 8, 2)
                fx, fy = c * fx - s * fy, s * fx + c * fy
                store_run(ws, b + ALONG * 8, (fx, fy))
                q = load(ws, j + Q * 8)
                twice = (w + w) * load(ws, j + QD * 8)
                x = x + q * fx
                y = y + q * fy
                dx = -twice * fy
                dy = twice * fx
            square = w * w
            store_run(ws, b + OFFSET * 8, (x, y, dx - square * x, dy - square * y))
            if kind == REVOLUTE:
                sq, cq = sine_cosine(load(ws, j + Q * 8))
                sq = sq * sign
                c, s = c * cq - s * sq, s * cq + c * sq
                w = w + sign * load(ws, j + QD * 8)
        store_run(ws, b + SPIN * 8, (w, c, s))
        if kind == BEAM:
            fx, fy, hx, hy = load_run(constants, k + PLANE_F * 8, 4)
            store_run(ws, b + ALONG * 8, (c * fx - s * fy, s * fx + c * fy, c * hx - s * hy, s * hx + c * hy))
            _beam(tree, beams, ws, n, i)
            continue
        mass = load(constants, k + MASS * 8)
        hx, hy = load_run(constants, k + FIRST * 8, 2)
        hx, hy = c * hx - s * hy, s * hx + c * hy
        square = w * w
        a = b + ARTICULATED * 8
        store_run(
            ws, a, (load(constants, k + SECOND * 8), -hy, hx, mass, zero, mass, zero, -(square * hx), -(square * hy))
        )


@in_place
def _inward(tree: Any, flags: Any, beams: Any, laws: Any, ws: Any, n: int, user: int) -> None:
    """Eliminate the modes and the free joints from the tips to the base."""
    group = n * JOINT * 8
    for i in range(tree.shape[0] - 1, -1, -1):
        b = (n * JOINT + GROUP + i * BODY) * 8
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
        a00, a01, a02, a11, a12, a22, b0, b1, b2 = load_run(ws, b + ARTICULATED * 8, 9)
        if kind <= PRISMATIC:
            force = joint_force(laws, ws, flags[own], user, group, l, j)
            armature = law.axis_inertia(laws, l, flags[own], load(ws, j + SLIPS * 8), load(ws, j + CONTACT * 8))
            free = load(ws, j + FREE * 8)
            if kind == REVOLUTE:
                sign = float(tree[i, SIGN])
                u0, u1, u2 = sign * a00, sign * a01, sign * a02
                inverse = free / (a00 + armature)
                force = force - sign * b0
            else:
                fx, fy = load_run(ws, b + ALONG * 8, 2)
                u0 = a01 * fx + a02 * fy
                u1 = a11 * fx + a12 * fy
                u2 = a12 * fx + a22 * fy
                inverse = free / (u1 * fx + u2 * fy + armature)
                force = force - (b1 * fx + b2 * fy)
            store_run(ws, b + COLUMN * 8, (u0, u1, u2, force, inverse))
            if parent < 0:
                continue
            k0 = u0 * inverse
            k1 = u1 * inverse
            k2 = u2 * inverse
            a00 = a00 - k0 * u0
            a01 = a01 - k0 * u1
            a02 = a02 - k0 * u2
            a11 = a11 - k1 * u1
            a12 = a12 - k1 * u2
            a22 = a22 - k2 * u2
            b0 = b0 + k0 * force
            b1 = b1 + k1 * force
            b2 = b2 + k2 * force
        x, y, cx, cy = load_run(ws, b + OFFSET * 8, 4)
        b0 = b0 + (a01 * cx + a02 * cy)
        b1 = b1 + (a11 * cx + a12 * cy)
        b2 = b2 + (a12 * cx + a22 * cy)
        p = (n * JOINT + GROUP + parent * BODY) * 8
        if kind == SECTION:
            # What hangs on the section drives the modes through the section's partial motions.
            m = tree[i, MODES]
            e = tree[i, TABLE] * 8
            own_work = tree[i, WORK] * 8
            work = tree[parent, WORK] * 8
            side = float(tree[i, SIGN])
            ax, ay = load_run(ws, p + ALONG * 8, 2)
            bx, by = load_run(ws, p + ACROSS * 8, 2)
            for f in range(m):
                lx = load(ws, own_work + f * 8)
                ly = load(beams, e + (1 + f) * 8)
                dt = side * load(beams, e + (1 + m + f) * 8)
                dx = ax * lx + bx * ly
                dy = ay * lx + by * ly
                g0 = a00 * dt + a01 * dx + a02 * dy
                g1 = a01 * dt + a11 * dx + a12 * dy
                g2 = a02 * dt + a12 * dx + a22 * dy
                add_run(ws, work + 3 * f * 8, (g0 + (x * g2 - y * g1), g1, g2))
                for o in range(f + 1):
                    ox = load(ws, own_work + o * 8)
                    oy = load(beams, e + (1 + o) * 8)
                    ot = side * load(beams, e + (1 + m + o) * 8)
                    a = work + (3 * m + f * m + o) * 8
                    store(
                        ws,
                        a,
                        load(ws, a) + (ot * g0 + (ax * ox + bx * oy) * g1 + (ay * ox + by * oy) * g2),
                    )
                a = work + (3 * m + m * m + f) * 8
                store(ws, a, load(ws, a) + (dt * b0 + dx * b1 + dy * b2))
        # About the parent's origin, from which this one's lies at (x, y).
        l0 = x * a12 - y * a11
        l1 = x * a22 - y * a12
        add_run(
            ws,
            p + ARTICULATED * 8,
            (
                a00 + (x * a02 - y * a01) + (x * (a02 + l1) - y * (a01 + l0)),
                a01 + l0,
                a02 + l1,
                a11,
                a12,
                a22,
                b0 + (x * b2 - y * b1),
                b1,
                b2,
            ),
        )


@in_place
def _outward_accelerations(tree: Any, flags: Any, beams: Any, laws: Any, ws: Any, n: int, shaken: int) -> float:
    """Accelerations of joints and modes, forces that hold the held joints, reactions across the axes.

    Returns 1 while a reaction changes, for the fixed point of load-dependent friction.
    """
    group = n * JOINT * 8
    unsettled = 0.0
    for i in range(tree.shape[0]):
        b = (n * JOINT + GROUP + i * BODY) * 8
        kind = tree[i, KIND]
        if kind == ABSENT:
            continue
        parent = tree[i, PARENT]
        own = tree[i, COORDINATE]
        j = own * JOINT * 8
        l = own * law.WIDTH * 8
        if parent >= 0:
            p = (n * JOINT + GROUP + parent * BODY) * 8
            turning, ax, ay = load_run(ws, p + ACCELERATION * 8, 3)
            x, y, cx, cy = load_run(ws, b + OFFSET * 8, 4)
            ax = ax - turning * y + cx
            ay = ay + turning * x + cy
        else:
            turning = spread(0.0)
            ax, ay, _ = shaken_base(ws, group, shaken)
        if kind >= BEAM:
            if kind == SECTION:
                p = (n * JOINT + GROUP + parent * BODY) * 8
                m = tree[i, MODES]
                e = tree[i, TABLE] * 8
                own_work = tree[i, WORK] * 8
                lx = spread(0.0)
                ly = lx
                lt = lx
                for f in range(m):
                    qdd = load(ws, j + (f * JOINT + QDD) * 8)
                    lx = lx + load(ws, own_work + f * 8) * qdd
                    ly = ly + load(beams, e + (1 + f) * 8) * qdd
                    lt = lt + load(beams, e + (1 + m + f) * 8) * qdd
                fx, fy = load_run(ws, p + ALONG * 8, 2)
                hx, hy = load_run(ws, p + ACROSS * 8, 2)
                turning = turning + float(tree[i, SIGN]) * lt
                ax = ax + fx * lx + hx * ly
                ay = ay + fy * lx + hy * ly
            store_run(ws, b + ACCELERATION * 8, (turning, ax, ay))
            if kind == BEAM:
                _accelerate_modes(tree, ws, n, i)
            continue
        u0, u1, u2, force, inverse = load_run(ws, b + COLUMN * 8, 5)
        push = (u0 * turning + u1 * ax + u2 * ay) - force
        qdd = -(inverse * push)
        store(ws, j + QDD * 8, qdd)
        if kind == REVOLUTE:
            turning = turning + float(tree[i, SIGN]) * qdd
        else:
            fx, fy = load_run(ws, b + ALONG * 8, 2)
            ax = ax + fx * qdd
            ay = ay + fy * qdd
        store_run(ws, b + ACCELERATION * 8, (turning, ax, ay))
        if flags[own] & law.RUBS:
            fx, fy = spread(0.0), spread(0.0)
            if flags[own] & law.HAS_LOAD:
                # Only revolute joints come here: across a slide the force along the normal counts as well.
                _, a01, a02, a11, a12, a22, _, b1, b2 = load_run(ws, b + ARTICULATED * 8, 9)
                fx = a01 * turning + a11 * ax + a12 * ay + b1
                fy = a02 * turning + a12 * ax + a22 * ay + b2
            unsettled = max(unsettled, rub(laws, ws, flags[own], group, l, j, push, fx, fy))
    return unsettled


@inner
def planar_accelerations(
    tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, user: int, shaken: int, loaded: int
) -> None:
    """Accelerations of all lanes of a group from the state in the workspace, left there."""
    if loaded:
        restart_reactions(ws, n)
    for _ in range(60 if loaded else 1):
        _outward(tree, constants, beams, ws, n)
        _inward(tree, flags, beams, laws, ws, n, user)
        if _outward_accelerations(tree, flags, beams, laws, ws, n, shaken) == 0.0:
            break
