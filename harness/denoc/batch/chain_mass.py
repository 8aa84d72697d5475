"""Mass matrices of one serial chain in many states: I_ij = s_jᵀ w_i for j ≤ i, mirrored to the other side of the diagonal.

s_j is the motion that a unit rate of joint j gives (angular, linear), w_i the wrench that a unit acceleration of joint i needs
of the composite body beyond it. A sweep inward finds both for eight states at once, in the axes of the last body, so that no
turn of the base matters. Then every state is dealt with by itself, in tiles of eight by eight joints: six multiplications
an element, rows of the result written as they lie, and what lies on the other side of the diagonal not computed again.
Tiles are counted from the tip; joints that are left over at the base are taken one by one.

Motions and wrenches of up to 64 joints are about one origin, that of the outermost of these, and motions are carried outward to
the origin of the wrenches that they are multiplied with: arms reach past 64 bodies more than lie between the joints, so that
nothing grows with the distance from the base.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.batch.dynamics import (
    ALPHA,
    ARMATURE,
    CONSTANTS,
    FIRST,
    PRISMATIC,
    SECOND,
    R,
    turn_of,
)
from harness.denoc.batch.tree_mass import composite_inward
from harness.denoc.simd.shuffle import mirrored, scatter_pairs, store_rows, transposed
from harness.denoc.simd.vector import (
    address_of,
    batch_kernel,
    gather,
    in_place,
    inner,
    load,
    load_run,
    settle,
    spread,
    spread_from,
    store,
    store_run,
    stream,
)

# A tile: motions (angular, linear), wrenches (moments, forces), elements on the diagonal; of each eight numbers, one a joint.
# While the sweep fills it, each of these numbers is a vector of eight states.
MOTION, WRENCH, DIAGONAL = 0, 6, 12
TILE = 13 * 8
# Tiles that share an origin.
GROUP = 8
# Elements of joints left over with each other, eight states each, in seven rows of seven.
LEFT = 49 * 8
# Results of more numbers are not held by any cache, and matrices of fewer are held by one that is near: those are made
# there and then written past the caches, in about half the time.
FAR, NEAR = 1 << 21, 1 << 16
# From this number of joints on it takes less time than ``batch_tree_mass.mass_matrix``.
SHORTEST = 16


def room(n: int) -> int:
    """Numbers in the workspace of a chain of n.

    The tile being filled, ways between origins (3 vectors each), tiles by state, elements of joints left over, a matrix.
    """
    return TILE * 8 + n // 8 * (3 * 8 + TILE * 8) + LEFT + (n * n if n * n <= NEAR else 0)


@in_place
def _fill(ws: Any, at: int, slot: Any, x: Any, y: Any, z: Any) -> None:
    """A vector in space of one joint, to the tile being filled."""
    store(ws, (at * 8 + slot) * 8, x)
    store(ws, (at * 8 + 8 + slot) * 8, y)
    store(ws, (at * 8 + 16 + slot) * 8, z)


@in_place
def _row(ws: Any, w: Any, ax: Any, ay: Any, az: Any, lx: Any, ly: Any, lz: Any) -> Any:
    """Eight motions times one wrench, which lies at w in its tile."""
    moment = ax * spread_from(ws, w) + ay * spread_from(ws, w + 8) + az * spread_from(ws, w + 16)
    return moment + lx * spread_from(ws, w + 24) + ly * spread_from(ws, w + 32) + lz * spread_from(ws, w + 40)


@in_place
def _rows(ws: Any, w: Any, ax: Any, ay: Any, az: Any, lx: Any, ly: Any, lz: Any) -> Any:
    """Eight motions times the eight wrenches of a tile, from w on: a row for each wrench."""
    return (
        _row(ws, w, ax, ay, az, lx, ly, lz),
        _row(ws, w + 1, ax, ay, az, lx, ly, lz),
        _row(ws, w + 2, ax, ay, az, lx, ly, lz),
        _row(ws, w + 3, ax, ay, az, lx, ly, lz),
        _row(ws, w + 4, ax, ay, az, lx, ly, lz),
        _row(ws, w + 5, ax, ay, az, lx, ly, lz),
        _row(ws, w + 6, ax, ay, az, lx, ly, lz),
        _row(ws, w + 7, ax, ay, az, lx, ly, lz),
    )


@in_place
def _product(ws: Any, w: Any, step: int, ax: Any, ay: Any, az: Any, lx: Any, ly: Any, lz: Any) -> Any:
    """One motion times eight wrenches of so many joints or states, whose six vectors lie ``step`` apart from w on."""
    moment = ax * load(ws, w) + ay * load(ws, w + step) + az * load(ws, w + 2 * step)
    return moment + lx * load(ws, w + 3 * step) + ly * load(ws, w + 4 * step) + lz * load(ws, w + 5 * step)


@in_place
def _further(ws: Any, way: Any, x: Any, y: Any, z: Any, ax: Any, ay: Any, az: Any, bx: Any, by: Any, bz: Any) -> Any:
    """The way to an origin with the last piece, and the linear motion there of angular motion a and linear motion b here."""
    # Seen from there.
    x = x + spread_from(ws, way)
    y = y + spread_from(ws, way + 8)
    z = z + spread_from(ws, way + 16)
    return x, y, z, bx + (y * az - z * ay), by + (z * ax - x * az), bz + (x * ay - y * ax)


@inner
def _sweep(row: int, tree: Any, c: Any, ws: Any, masses: Any, q: Any) -> None:
    """Motions and wrenches of eight states: of whole tiles by state, of the joints left over where the last tile was filled."""
    n = tree.shape[0]
    tiles = n // 8
    rest = n % 8
    zero = spread(0.0)
    one = spread(1.0)
    # The body's axes and its place seen from the tile's origin; first and second moments of the composite body.
    ax, ay, az, bx, by, bz, zx, zy, zz = one, zero, zero, zero, one, zero, zero, zero, one
    ox, oy, oz = zero, zero, zero
    hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz = zero, zero, zero, zero, zero, zero, zero, zero, zero
    # Tiles from the tip inward, and then the joints left over.
    for t in range(tiles - 1, -2, -1):
        begin = max(rest + t * 8, 0)
        for slot in range((rest if t < 0 else 8) - 1, -1, -1):
            i = begin + slot
            k = i * CONSTANTS
            m = spread_from(masses, i)
            hx = hx + c[k + FIRST]
            hy = hy + c[k + FIRST + 1]
            hz = hz + c[k + FIRST + 2]
            ixx = ixx + c[k + SECOND]
            iyy = iyy + c[k + SECOND + 1]
            izz = izz + c[k + SECOND + 2]
            ixy = ixy + c[k + SECOND + 3]
            ixz = ixz + c[k + SECOND + 4]
            iyz = iyz + c[k + SECOND + 5]
            position = gather(q, row * n + i, n)
            prismatic = tree[i, PRISMATIC]
            cosine, sine = turn_of(c, k, position, prismatic)
            if prismatic == 0:
                ux, uy, uz = zx, zy, zz
                vx, vy, vz = oy * zz - oz * zy, oz * zx - ox * zz, ox * zy - oy * zx
                nx = ax * ixz + bx * iyz + zx * izz
                ny = ay * ixz + by * iyz + zy * izz
                nz = az * ixz + bz * iyz + zz * izz
                fx, fy, fz = bx * hx - ax * hy, by * hx - ay * hy, bz * hx - az * hy
                own = izz
            else:
                ux, uy, uz = zero, zero, zero
                vx, vy, vz = zx, zy, zz
                nx, ny, nz = ax * hy - bx * hx, ay * hy - by * hx, az * hy - bz * hx
                fx, fy, fz = zx * m, zy * m, zz * m
                own = m
            _fill(ws, MOTION, slot, ux, uy, uz)
            _fill(ws, MOTION + 3, slot, vx, vy, vz)
            _fill(ws, WRENCH, slot, nx + (oy * fz - oz * fy), ny + (oz * fx - ox * fz), nz + (ox * fy - oy * fx))
            _fill(ws, WRENCH + 3, slot, fx, fy, fz)
            store(ws, (DIAGONAL * 8 + slot) * 8, own + c[k + ARMATURE])
            if i > 0:
                if prismatic != 0:
                    ox, oy, oz = ox - zx * position, oy - zy * position, oz - zz * position
                ax, bx = cosine * ax - sine * bx, sine * ax + cosine * bx
                ay, by = cosine * ay - sine * by, sine * ay + cosine * by
                az, bz = cosine * az - sine * bz, sine * az + cosine * bz
                ca = spread_from(c, k + ALPHA)
                sa = spread_from(c, k + ALPHA + 1)
                bx, zx = ca * bx - sa * zx, sa * bx + ca * zx
                by, zy = ca * by - sa * zy, sa * by + ca * zy
                bz, zz = ca * bz - sa * zz, sa * bz + ca * zz
                rx = spread_from(c, k + R)
                ry = spread_from(c, k + R + 1)
                rz = spread_from(c, k + R + 2)
                ox = ox - (ax * rx + bx * ry + zx * rz)
                oy = oy - (ay * rx + by * ry + zy * rz)
                oz = oz - (az * rx + bz * ry + zz * rz)
                hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz = composite_inward(
                    c, k, prismatic, cosine, sine, position, m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz
                )
        if t >= 0:
            if (tiles - t) % GROUP == 0:
                # The next tile has an origin of its own.
                store_run(ws, (TILE + t * 3) * 8, (ox, oy, oz))
                ox, oy, oz = zero, zero, zero
            for k in range(13):
                place = (TILE + tiles * 3 + t * 13 + k) * 8
                store_rows(ws, place, tiles * TILE, transposed(load_run(ws, k * 64, 8)))


@inner
def _left_over(n: int, ws: Any) -> None:
    """Elements between joints left over, of eight states at once, to the workspace."""
    left = (TILE + n // 8 * (3 + TILE)) * 8
    for j in range(n % 8):
        at = j * 8
        ax, ay, az, bx, by, bz = (
            load(ws, at), load(ws, at + 64), load(ws, at + 128), load(ws, at + 192), load(ws, at + 256), load(ws, at + 320),
        )  # fmt: skip
        store(ws, left + (j * 7 + j) * 8, load(ws, at + DIAGONAL * 64))
        for i in range(j + 1, n % 8):
            value = _product(ws, WRENCH * 64 + i * 8, 64, ax, ay, az, bx, by, bz)
            store(ws, left + (i * 7 + j) * 8, value)
            store(ws, left + (j * 7 + i) * 8, value)


@in_place
def _send(ws: Any, place: int, square: int, out: Any, corner: int) -> None:
    """A matrix from the workspace to the result, past the caches from the first cache line on that is all its own."""
    head = min((-address_of(out, corner) % 64) // 8, square)
    end = head + (square - head) // 8 * 8
    for k in range(head, end, 8):
        stream(out, corner + k, load(ws, place + k))
    for k in range(head):
        out[corner + k] = ws[place + k]
    for k in range(end, square):
        out[corner + k] = ws[place + k]


@inner
def _multiply(row: int, n: int, ws: Any, out: Any) -> None:
    """The matrices of eight states, from motions and wrenches."""
    square = n * n
    tiles = n // 8
    rest = n % 8
    left = (TILE + tiles * (3 + TILE)) * 8
    aside = len(out) > FAR and square <= NEAR
    matrices = ws if aside else out
    zero = spread(0.0)
    for s in range(8):
        corner = left + LEFT if aside else (row + s) * square
        ways = TILE * 8 + s
        state = (TILE + tiles * 3) * 8 + s * tiles * TILE
        for i in range(rest):
            for j in range(rest):
                matrices[corner + i * n + j] = ws[left + (i * 7 + j) * 8 + s]
        # Two at a time: beside the last of an odd number stands one of the tile before, whose elements the tiles write over.
        for j in range(0, rest, 2):
            motion = j * 8 + s
            ax, ay, az = spread_from(ws, motion), spread_from(ws, motion + 64), spread_from(ws, motion + 128)
            bx, by, bz = spread_from(ws, motion + 192), spread_from(ws, motion + 256), spread_from(ws, motion + 320)
            motion += 8
            cx, cy, cz = spread_from(ws, motion), spread_from(ws, motion + 64), spread_from(ws, motion + 128)
            dx, dy, dz = spread_from(ws, motion + 192), spread_from(ws, motion + 256), spread_from(ws, motion + 320)
            x, y, z, lx, ly, lz = zero, zero, zero, bx, by, bz
            u, v, w, mx, my, mz = zero, zero, zero, dx, dy, dz
            # Places in the result are counted on, since the compiler makes too many pointers of products.
            beside = corner + j * n + rest
            below = corner + rest * n + j
            for outer in range(tiles):
                if (tiles - outer) % GROUP == 0:
                    x, y, z, lx, ly, lz = _further(ws, ways + outer * 24, x, y, z, ax, ay, az, bx, by, bz)
                    u, v, w, mx, my, mz = _further(ws, ways + outer * 24, u, v, w, cx, cy, cz, dx, dy, dz)
                wrench = state + outer * TILE + WRENCH * 8
                first = _product(ws, wrench, 8, ax, ay, az, lx, ly, lz)
                second = _product(ws, wrench, 8, cx, cy, cz, mx, my, mz)
                store(matrices, beside, first)
                store(matrices, beside + n, second)
                scatter_pairs(matrices, below, n, first, second)
                beside += 8
                below += 8 * n
        for t in range(tiles):
            i = rest + t * 8
            tile = state + t * TILE
            ax, ay, az, bx, by, bz = load_run(ws, tile + MOTION * 8, 6)
            rows = _rows(ws, tile + WRENCH * 8, ax, ay, az, bx, by, bz)
            store_rows(matrices, corner + i * n + i, n, mirrored(rows, transposed(rows), load(ws, tile + DIAGONAL * 8)))
            below = corner + (i + 8) * n + i
            beside = corner + i * n + i + 8
            x, y, z, lx, ly, lz = zero, zero, zero, bx, by, bz
            for outer in range(t + 1, tiles):
                if (tiles - outer) % GROUP == 0:
                    x, y, z, lx, ly, lz = _further(ws, ways + outer * 24, x, y, z, ax, ay, az, bx, by, bz)
                rows = _rows(ws, state + outer * TILE + WRENCH * 8, ax, ay, az, lx, ly, lz)
                store_rows(matrices, below, n, rows)
                store_rows(matrices, beside, n, transposed(rows))
                below += 8 * n
                beside += 8
        if aside:
            _send(ws, corner, square, out, (row + s) * square)


@batch_kernel
def chain_mass_matrix(first: int, last: int, tree: Any, c: Any, ws: Any, masses: Any, q: Any, out: Any) -> None:
    """As ``batch_tree_mass.mass_matrix``, of a serial chain."""
    n = tree.shape[0]
    for row in range(first, last, 8):
        _sweep(row, tree, c, ws, masses, q)
        _left_over(n, ws)
        _multiply(row, n, ws, out)
    settle()
