"""Dynamics of one rigid tree in many states: eight states at once, the tree's constants shared by all of them.

The recursions are those of ``lanes.tree`` on the same re-framed bodies, laid out for throughput: what is kept between the
sweeps is small (so that long chains stay in the cache), and a body's articulated inertia passes to its parent through
an accumulator that a whole serial chain shares.
"""

from __future__ import annotations

from typing import Any

from numba import njit

from harness.denoc.batch import trunk as trunks
from harness.denoc.compiling.pipeline import Kernel
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
    ENTRY,
    add_run,
    batch_kernel,
    gather,
    in_place,
    load,
    load_run,
    scatter,
    sine_cosine,
    spread,
    store,
    store_run,
)

# One body's constants (single numbers).
R, ALPHA, DELTA, GAMMA, MASS, FIRST, SECOND, ARMATURE, DAMPING, STIFFNESS, REST = 0, 3, 5, 7, 9, 10, 13, 19, 20, 21, 22
CONSTANTS = 23

# One body's integers. GIVES: accumulator that the parent reads; TAKES: the one it reads itself, -1 at a tip;
# OPENS: whether it is the first to write its parent's.
PARENT, PRISMATIC, PREFIX, GIVES, TAKES, OPENS = range(6)
COLUMNS = 6

# One body's workspace in vectors of eight: turn (prismatic: q too), joint velocity, ω, v, U / D, u / D; the sweep out again
# keeps accelerations where velocities were.
TURN, RATE, OMEGA, VELOCITY, GAIN, PUSH = 0, 2, 3, 6, 9, 15
BODY = 17
# An accumulator: angular (6), mixed (9), linear (6), bias (6).
ACCUMULATOR = 27


@in_place
def turn_of(c: Any, k: int, q: Any, prismatic: int) -> Any:
    """Cosine and sine of a body's turn about z."""
    cd = c[k + DELTA]
    sd = c[k + DELTA + 1]
    if prismatic != 0:
        return spread(cd), spread(sd)
    s, co = sine_cosine(q)
    return co * cd - s * sd, s * cd + co * sd


@in_place
def to_parent(c: Any, k: int, cosine: Any, sine: Any, x: Any, y: Any, z: Any) -> Any:
    """A vector's coordinates after the turns about z and x, before that of a later child about z."""
    x, y = cosine * x - sine * y, sine * x + cosine * y
    ca = c[k + ALPHA]
    sa = c[k + ALPHA + 1]
    return x, ca * y - sa * z, sa * y + ca * z


@in_place
def wrench_to_parent(
    c: Any, k: int, prefix: int, cosine: Any, sine: Any, nx: Any, ny: Any, nz: Any, fx: Any, fy: Any, fz: Any
) -> Any:
    """Moment and force at a body's origin, its slide taken back, as moment about the parent's origin and force in its axes."""
    nx, ny, nz = to_parent(c, k, cosine, sine, nx, ny, nz)
    fx, fy, fz = to_parent(c, k, cosine, sine, fx, fy, fz)
    rx = c[k + R]
    ry = c[k + R + 1]
    rz = c[k + R + 2]
    nx = nx + (ry * fz - rz * fy)
    ny = ny + (rz * fx - rx * fz)
    nz = nz + (rx * fy - ry * fx)
    if prefix != 0:
        cg = c[k + GAMMA]
        sg = c[k + GAMMA + 1]
        nx, ny = cg * nx - sg * ny, sg * nx + cg * ny
        fx, fy = cg * fx - sg * fy, sg * fx + cg * fy
    return nx, ny, nz, fx, fy, fz


@in_place
def inertia_of(c: Any, k: int) -> Any:
    """Mass, first moments and second moments about its origin of a body whose constants begin at ``k``."""
    return (
        c[k + MASS], c[k + FIRST], c[k + FIRST + 1], c[k + FIRST + 2], c[k + SECOND], c[k + SECOND + 1], c[k + SECOND + 2],
        c[k + SECOND + 3], c[k + SECOND + 4], c[k + SECOND + 5],
    )  # fmt: skip


@in_place
def carried(c: Any, k: int, takes: int, accumulators: Any, twist: Any) -> Any:
    """Articulated inertia and bias wrench of a body with what it carries, which waits in the accumulator ``takes`` (-1: none)."""
    wx, wy, wz, vx, vy, vz = twist
    m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz = inertia_of(c, k)
    px, py, pz, fx, fy, fz = bias_wrench(m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz, wx, wy, wz, vx, vy, vz)
    if takes >= 0:
        a = takes * ACCUMULATOR * 8
        axx = load(accumulators, a) + ixx
        ayy = load(accumulators, a + 8) + iyy
        azz = load(accumulators, a + 16) + izz
        axy = load(accumulators, a + 24) + ixy
        axz = load(accumulators, a + 32) + ixz
        ayz = load(accumulators, a + 40) + iyz
        bxx = load(accumulators, a + 48)
        bxy = load(accumulators, a + 56) - hz
        bxz = load(accumulators, a + 64) + hy
        byx = load(accumulators, a + 72) + hz
        byy = load(accumulators, a + 80)
        byz = load(accumulators, a + 88) - hx
        bzx = load(accumulators, a + 96) - hy
        bzy = load(accumulators, a + 104) + hx
        bzz = load(accumulators, a + 112)
        mxx = load(accumulators, a + 120) + m
        myy = load(accumulators, a + 128) + m
        mzz = load(accumulators, a + 136) + m
        mxy, mxz, myz = load_run(accumulators, a + 144, 3)
        px = px + load(accumulators, a + 168)
        py = py + load(accumulators, a + 176)
        pz = pz + load(accumulators, a + 184)
        fx = fx + load(accumulators, a + 192)
        fy = fy + load(accumulators, a + 200)
        fz = fz + load(accumulators, a + 208)
    else:
        zero = spread(0.0)
        axx, ayy, azz, axy, axz, ayz = (
            spread(ixx), spread(iyy), spread(izz), spread(ixy), spread(ixz), spread(iyz),
        )  # fmt: skip
        bxx, bxy, bxz = zero, spread(-hz), spread(hy)
        byx, byy, byz = spread(hz), zero, spread(-hx)
        bzx, bzy, bzz = spread(-hy), spread(hx), zero
        mxx, myy, mzz, mxy, mxz, myz = spread(m), spread(m), spread(m), zero, zero, zero
    return (
        (axx, ayy, azz, axy, axz, ayz),
        (bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz),
        (mxx, myy, mzz, mxy, mxz, myz),
        (px, py, pz, fx, fy, fz),
    )


@in_place
def _sweeps(
    first: int,
    last: int,
    tree: Any,
    c: Any,
    ws: Any,
    accumulators: Any,
    base_motion: Any,
    q: Any,
    qd: Any,
    tau: Any,
    out: Any,
    begin: int,
    more: int,
) -> None:
    """Forward dynamics of the bodies from ``begin`` on; more: by how many a row of positions is longer than one of velocities.

    base_motion: gravity, or where ``begin`` is not 0 the numbers of a trunk (``batch.trunk``). Both are constants where this is
    taken in, so that a tree without a trunk has no code for one.
    """
    n = tree.shape[0]
    for row in range(first, last, 8):
        base = row * n
        at = row * (n + more) + more
        if begin != 0:
            b = (begin - 1) * BODY * 8
            wx, wy, wz, vx, vy, vz = trunks.motion(base, n, base_motion, ws, 0, q, qd)
            store_run(ws, b + OMEGA * 8, (wx, wy, wz))
            store_run(ws, b + VELOCITY * 8, (vx, vy, vz))
        for i in range(begin, n):
            b = i * BODY * 8
            k = i * CONSTANTS
            position = gather(q, at + i, n + more)
            rate = gather(qd, base + i, n)
            prismatic = tree[i, PRISMATIC]
            cosine, sine = turn_of(c, k, position, prismatic)
            p = tree[i, PARENT]
            zero = spread(0.0)
            if p >= 0:
                p = p * BODY * 8
                wx, wy, wz = load_run(ws, p + OMEGA * 8, 3)
                vx, vy, vz = load_run(ws, p + VELOCITY * 8, 3)
                if tree[i, PREFIX] != 0:
                    wx, wy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], wx, wy)
                    vx, vy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], vx, vy)
                vx = vx + (wy * c[k + R + 2] - wz * c[k + R + 1])
                vy = vy + (wz * c[k + R] - wx * c[k + R + 2])
                vz = vz + (wx * c[k + R + 1] - wy * c[k + R])
                wx, wy, wz, vx, vy, vz = turn_motion(
                    c[k + ALPHA], c[k + ALPHA + 1], cosine, sine, wx, wy, wz, vx, vy, vz
                )
            else:
                wx, wy, wz, vx, vy, vz = zero, zero, zero, zero, zero, zero
            if prismatic == 0:
                wz = wz + rate
                store_run(ws, b + TURN * 8, (cosine, sine))
            else:
                vx = vx + wy * position
                vy = vy - wx * position
                vz = vz + rate
                store(ws, b + TURN * 8, position)
            store(ws, b + RATE * 8, rate)
            store_run(ws, b + OMEGA * 8, (wx, wy, wz))
            store_run(ws, b + VELOCITY * 8, (vx, vy, vz))
        for i in range(n - 1, begin - 1, -1):
            b = i * BODY * 8
            k = i * CONSTANTS
            prismatic = tree[i, PRISMATIC]
            rate = load(ws, b + RATE * 8)
            wx, wy, wz = load_run(ws, b + OMEGA * 8, 3)
            vx, vy, vz = load_run(ws, b + VELOCITY * 8, 3)
            angular, mixed, linear, bias = carried(c, k, tree[i, TAKES], accumulators, (wx, wy, wz, vx, vy, vz))
            axx, ayy, azz, axy, axz, ayz = angular
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
            mxx, myy, mzz, mxy, mxz, myz = linear
            px, py, pz, fx, fy, fz = bias
            force = gather(tau, base + i, n) - c[k + DAMPING] * rate
            if c[k + STIFFNESS] != 0.0:
                force = force - c[k + STIFFNESS] * (gather(q, at + i, n + more) - c[k + REST])
            if prismatic == 0:
                column = (axz, ayz, azz, bzx, bzy, bzz)
                inverse = 1.0 / (azz + c[k + ARMATURE])
                force = (force - pz) * inverse
            else:
                column = (bxz, byz, bzz, mxz, myz, mzz)
                inverse = 1.0 / (mzz + c[k + ARMATURE])
                force = (force - fz) * inverse
            u1, u2, u3, u4, u5, u6 = column
            gain = (u1 * inverse, u2 * inverse, u3 * inverse, u4 * inverse, u5 * inverse, u6 * inverse)
            store_run(ws, b + GAIN * 8, gain)
            store(ws, b + PUSH * 8, force)
            if tree[i, PARENT] < 0:
                continue
            px = px + u1 * force
            py = py + u2 * force
            pz = pz + u3 * force
            fx = fx + u4 * force
            fy = fy + u5 * force
            fz = fz + u6 * force
            angular, mixed, linear = without_joint(
                gain,
                column,
                (axx, ayy, azz, axy, axz, ayz),
                (bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz),
                (mxx, myy, mzz, mxy, mxz, myz),
            )
            axx, ayy, azz, axy, axz, ayz = angular
            bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
            mxx, myy, mzz, mxy, mxz, myz = linear
            if prismatic == 0:
                c1, c2, c4, c5 = wy * rate, -(wx * rate), vy * rate, -(vx * rate)
                px = px + axx * c1 + axy * c2 + bxx * c4 + bxy * c5
                py = py + axy * c1 + ayy * c2 + byx * c4 + byy * c5
                pz = pz + axz * c1 + ayz * c2 + bzx * c4 + bzy * c5
                fx = fx + bxx * c1 + byx * c2 + mxx * c4 + mxy * c5
                fy = fy + bxy * c1 + byy * c2 + mxy * c4 + myy * c5
                fz = fz + bxz * c1 + byz * c2 + mxz * c4 + myz * c5
                bias = (px, py, pz, fx, fy, fz)
                cosine, sine = load_run(ws, b + TURN * 8, 2)
            else:
                c4, c5 = wy * rate, -(wx * rate)
                px = px + bxx * c4 + bxy * c5
                py = py + byx * c4 + byy * c5
                pz = pz + bzx * c4 + bzy * c5
                fx = fx + mxx * c4 + mxy * c5
                fy = fy + mxy * c4 + myy * c5
                fz = fz + mxz * c4 + myz * c5
                angular, mixed, linear, bias = slide_articulated_back(
                    load(ws, b + TURN * 8), angular, mixed, linear, (px, py, pz, fx, fy, fz)
                )
                cosine = spread(c[k + DELTA])
                sine = spread(c[k + DELTA + 1])
            angular, mixed, linear, bias = turn_articulated(cosine, sine, angular, mixed, linear, bias)
            angular, mixed, linear, bias = turn_articulated_about_x(
                c[k + ALPHA], c[k + ALPHA + 1], angular, mixed, linear, bias
            )
            angular, mixed, linear, bias = shift_articulated(
                c[k + R], c[k + R + 1], c[k + R + 2], angular, mixed, linear, bias
            )
            if tree[i, PREFIX] != 0:
                angular, mixed, linear, bias = turn_articulated(
                    c[k + GAMMA], c[k + GAMMA + 1], angular, mixed, linear, bias
                )
            a = tree[i, GIVES] * ACCUMULATOR * 8
            if tree[i, OPENS] == 0:
                add_run(accumulators, a, angular)
                add_run(accumulators, a + 48, mixed)
                add_run(accumulators, a + 120, linear)
                add_run(accumulators, a + 168, bias)
            else:
                store_run(accumulators, a, angular)
                store_run(accumulators, a + 48, mixed)
                store_run(accumulators, a + 120, linear)
                store_run(accumulators, a + 168, bias)
        if begin != 0:
            i = begin - 1
            b = i * BODY * 8
            wx, wy, wz = load_run(ws, b + OMEGA * 8, 3)
            vx, vy, vz = load_run(ws, b + VELOCITY * 8, 3)
            twist = (wx, wy, wz, vx, vy, vz)
            angular, mixed, linear, bias = carried(c, i * CONSTANTS, tree[i, TAKES], accumulators, twist)
            push = trunks.wrench(base, n, base_motion, ws, 0, tau, twist)
            left = (
                push[0] - bias[0], push[1] - bias[1], push[2] - bias[2],
                push[3] - bias[3], push[4] - bias[4], push[5] - bias[5],
            )  # fmt: skip
            found = trunks.acceleration(angular, mixed, linear, left)
            trunks.write(base, n, base_motion, ws, 0, twist, found, out)
            store_run(ws, b + OMEGA * 8, (found[0], found[1], found[2]))
            store_run(ws, b + VELOCITY * 8, (found[3], found[4], found[5]))
        for i in range(begin, n):
            b = i * BODY * 8
            k = i * CONSTANTS
            prismatic = tree[i, PRISMATIC]
            p = tree[i, PARENT]
            if p >= 0:
                p = p * BODY * 8
                wx, wy, wz = load_run(ws, p + OMEGA * 8, 3)
                vx, vy, vz = load_run(ws, p + VELOCITY * 8, 3)
            else:
                zero = spread(0.0)
                wx, wy, wz = zero, zero, zero
                vx, vy, vz = spread(-base_motion[0]), spread(-base_motion[1]), spread(-base_motion[2])
            if tree[i, PREFIX] != 0:
                wx, wy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], wx, wy)
                vx, vy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], vx, vy)
            if p >= 0:
                vx = vx + (wy * c[k + R + 2] - wz * c[k + R + 1])
                vy = vy + (wz * c[k + R] - wx * c[k + R + 2])
                vz = vz + (wx * c[k + R + 1] - wy * c[k + R])
            wy, wz = turn_forward(c[k + ALPHA], c[k + ALPHA + 1], wy, wz)
            vy, vz = turn_forward(c[k + ALPHA], c[k + ALPHA + 1], vy, vz)
            rate = load(ws, b + RATE * 8)
            ox, oy = load_run(ws, b + OMEGA * 8, 2)
            if prismatic == 0:
                cosine, sine = load_run(ws, b + TURN * 8, 2)
                wx, wy = turn_forward(cosine, sine, wx, wy)
                vx, vy = turn_forward(cosine, sine, vx, vy)
                wx = wx + oy * rate
                wy = wy - ox * rate
                vx = vx + load(ws, b + VELOCITY * 8 + 8) * rate
                vy = vy - load(ws, b + VELOCITY * 8) * rate
            else:
                position = load(ws, b + TURN * 8)
                wx, wy = turn_forward(c[k + DELTA], c[k + DELTA + 1], wx, wy)
                vx, vy = turn_forward(c[k + DELTA], c[k + DELTA + 1], vx, vy)
                vx = vx + wy * position + oy * rate
                vy = vy - wx * position - ox * rate
            qdd = load(ws, b + PUSH * 8) - (
                load(ws, b + GAIN * 8) * wx
                + load(ws, b + GAIN * 8 + 8) * wy
                + load(ws, b + GAIN * 8 + 16) * wz
                + load(ws, b + GAIN * 8 + 24) * vx
                + load(ws, b + GAIN * 8 + 32) * vy
                + load(ws, b + GAIN * 8 + 40) * vz
            )
            scatter(out, base + i, n, qdd)
            if prismatic == 0:
                wz = wz + qdd
            else:
                vz = vz + qdd
            store_run(ws, b + OMEGA * 8, (wx, wy, wz))
            store_run(ws, b + VELOCITY * 8, (vx, vy, vz))


@batch_kernel
def forward_dynamics(
    first: int,
    last: int,
    tree: Any,
    c: Any,
    ws: Any,
    accumulators: Any,
    gravity: Any,
    q: Any,
    qd: Any,
    tau: Any,
    out: Any,
) -> None:
    """Accelerations of the states in rows first, first + 8, … below last, flat arrays of (B, n); eight rows from each."""
    _sweeps(first, last, tree, c, ws, accumulators, gravity, q, qd, tau, out, 0, 0)


@batch_kernel
def floating_dynamics(
    first: int,
    last: int,
    tree: Any,
    c: Any,
    ws: Any,
    accumulators: Any,
    trunk: Any,
    q: Any,
    qd: Any,
    tau: Any,
    out: Any,
) -> None:
    """The same of what hangs on a trunk (``batch.trunk``): q is a flat array of (B, n + 1)."""
    _sweeps(first, last, tree, c, ws, accumulators, trunk, q, qd, tau, out, trunks.BODIES, 1)


# Workspace of inverse dynamics: turn (or q), spin, its rate, acceleration of the origin; then moment and force.
SPIN, SPIN_RATE, LINEAR, MOMENT, THRUST = 2, 5, 8, 11, 14


@batch_kernel
def inverse_dynamics(
    first: int, last: int, tree: Any, c: Any, ws: Any, gravity: Any, q: Any, qd: Any, qdd: Any, out: Any
) -> None:
    """Generalized forces of the states in rows first, first + 8, … below last (Newton and Euler)."""
    n = tree.shape[0]
    for row in range(first, last, 8):
        base = row * n
        for i in range(n):
            b = i * BODY * 8
            k = i * CONSTANTS
            position = gather(q, base + i, n)
            rate = gather(qd, base + i, n)
            push = gather(qdd, base + i, n)
            prismatic = tree[i, PRISMATIC]
            cosine, sine = turn_of(c, k, position, prismatic)
            p = tree[i, PARENT]
            if p >= 0:
                p = p * BODY * 8
                wx, wy, wz = load_run(ws, p + SPIN * 8, 3)
                ax, ay, az = load_run(ws, p + SPIN_RATE * 8, 3)
                vx, vy, vz = load_run(ws, p + LINEAR * 8, 3)
                if tree[i, PREFIX] != 0:
                    wx, wy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], wx, wy)
                    ax, ay = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], ax, ay)
                    vx, vy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], vx, vy)
                rx = c[k + R]
                ry = c[k + R + 1]
                rz = c[k + R + 2]
                sx = wy * rz - wz * ry
                sy = wz * rx - wx * rz
                sz = wx * ry - wy * rx
                vx = vx + (ay * rz - az * ry) + (wy * sz - wz * sy)
                vy = vy + (az * rx - ax * rz) + (wz * sx - wx * sz)
                vz = vz + (ax * ry - ay * rx) + (wx * sy - wy * sx)
                wy, wz = turn_forward(c[k + ALPHA], c[k + ALPHA + 1], wy, wz)
                ay, az = turn_forward(c[k + ALPHA], c[k + ALPHA + 1], ay, az)
                wx, wy = turn_forward(cosine, sine, wx, wy)
                ax, ay = turn_forward(cosine, sine, ax, ay)
            else:
                zero = spread(0.0)
                wx, wy, wz, ax, ay, az = zero, zero, zero, zero, zero, zero
                vx, vy, vz = spread(-gravity[0]), spread(-gravity[1]), spread(-gravity[2])
                if tree[i, PREFIX] != 0:
                    vx, vy = turn_forward(c[k + GAMMA], c[k + GAMMA + 1], vx, vy)
            vy, vz = turn_forward(c[k + ALPHA], c[k + ALPHA + 1], vy, vz)
            vx, vy = turn_forward(cosine, sine, vx, vy)
            if prismatic == 0:
                ax = ax + wy * rate
                ay = ay - wx * rate
                az = az + push
                wz = wz + rate
                store_run(ws, b + TURN * 8, (cosine, sine))
            else:
                # ω̇ × r + ω × (ω × r + 2 v) with r and v along the axis.
                twice = rate + rate
                sx = wy * position
                sy = -(wx * position)
                vx = vx + ay * position + wy * twice - wz * sy
                vy = vy - ax * position - wx * twice + wz * sx
                vz = vz + (wx * sy - wy * sx) + push
                store(ws, b + TURN * 8, position)
            store_run(ws, b + SPIN * 8, (wx, wy, wz))
            store_run(ws, b + SPIN_RATE * 8, (ax, ay, az))
            store_run(ws, b + LINEAR * 8, (vx, vy, vz))
            m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz = inertia_of(c, k)
            sx = wy * hz - wz * hy
            sy = wz * hx - wx * hz
            sz = wx * hy - wy * hx
            store_run(
                ws,
                b + THRUST * 8,
                (
                    m * vx + (ay * hz - az * hy) + (wy * sz - wz * sy),
                    m * vy + (az * hx - ax * hz) + (wz * sx - wx * sz),
                    m * vz + (ax * hy - ay * hx) + (wx * sy - wy * sx),
                ),
            )
            sx = ixx * wx + ixy * wy + ixz * wz
            sy = ixy * wx + iyy * wy + iyz * wz
            sz = ixz * wx + iyz * wy + izz * wz
            store_run(
                ws,
                b + MOMENT * 8,
                (
                    ixx * ax + ixy * ay + ixz * az + (wy * sz - wz * sy) + (hy * vz - hz * vy),
                    ixy * ax + iyy * ay + iyz * az + (wz * sx - wx * sz) + (hz * vx - hx * vz),
                    ixz * ax + iyz * ay + izz * az + (wx * sy - wy * sx) + (hx * vy - hy * vx),
                ),
            )
            # Hub inertia and passive forces already here, where the states are at hand.
            own = c[k + ARMATURE] * push + c[k + DAMPING] * rate
            if c[k + STIFFNESS] != 0.0:
                own = own + c[k + STIFFNESS] * (position - c[k + REST])
            scatter(out, base + i, n, own)
        for i in range(n - 1, -1, -1):
            b = i * BODY * 8
            k = i * CONSTANTS
            nx, ny, nz = load_run(ws, b + MOMENT * 8, 3)
            fx, fy, fz = load_run(ws, b + THRUST * 8, 3)
            prismatic = tree[i, PRISMATIC]
            force = nz if prismatic == 0 else fz
            scatter(out, base + i, n, gather(out, base + i, n) + force)
            p = tree[i, PARENT]
            if p < 0:
                continue
            if prismatic == 0:
                cosine, sine = load_run(ws, b + TURN * 8, 2)
            else:
                cosine = spread(c[k + DELTA])
                sine = spread(c[k + DELTA + 1])
                position = load(ws, b + TURN * 8)
                nx = nx - position * fy
                ny = ny + position * fx
            nx, ny, nz, fx, fy, fz = wrench_to_parent(c, k, tree[i, PREFIX], cosine, sine, nx, ny, nz, fx, fy, fz)
            a = p * BODY * 8
            add_run(ws, a + MOMENT * 8, (nx, ny, nz))
            add_run(ws, a + THRUST * 8, (fx, fy, fz))


@njit(_nrt=False, pipeline_class=Kernel, fastmath={"reassoc"}, **ENTRY)
def all_finite(x: Any) -> bool:
    """Whether all numbers of a flat array are finite: nothing else times zero is zero."""
    total = 0.0
    for k in range(len(x)):
        total += x[k] * 0.0
    return total == 0.0
