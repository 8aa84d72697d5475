"""Mass matrices of one rigid tree in many states, from composite bodies: eight states at once, and written one by one.

The wrench that a unit acceleration of a joint needs of the composite body beyond it is carried to the base, and gives an element
at each joint on its way. Serial chains of many joints have ``batch_mass``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.batch.dynamics import (
    ALPHA,
    ARMATURE,
    BODY,
    CONSTANTS,
    FIRST,
    GAMMA,
    PARENT,
    PREFIX,
    PRISMATIC,
    SECOND,
    TURN,
    R,
    to_parent,
    turn_of,
    wrench_to_parent,
)
from harness.denoc.lanes.spatial import turn_symmetric
from harness.denoc.simd.vector import (
    add_run,
    batch_kernel,
    gather,
    in_place,
    inner,
    load,
    load_run,
    scatter,
    spread,
    spread_from,
    store,
    store_run,
)

# From this number of joints on matrices are written one by one.
LONG = 16

# Workspace of the mass matrix: turn (two, of a prismatic joint too), position, composite first and second moments.
SLIDE, WHOLE_FIRST, WHOLE_SECOND = 2, 3, 6


@in_place
def composite_inward(
    c: Any, k: int, prismatic: int, cosine: Any, sine: Any, position: Any, m: Any, hx: Any, hy: Any, hz: Any,
    ixx: Any, iyy: Any, izz: Any, ixy: Any, ixz: Any, iyz: Any,
) -> Any:  # fmt: skip
    """First and second moments of a composite body of mass m, in the parent's axes about its origin (before a turn about z)."""
    if prismatic != 0:
        # Shift along the axis: first moments by m q z, second moments with them.
        along = position * (hz + hz + m * position)
        ixx = ixx + along
        iyy = iyy + along
        ixz = ixz - hx * position
        iyz = iyz - hy * position
        hz = hz + m * position
    ca = spread_from(c, k + ALPHA)
    sa = spread_from(c, k + ALPHA + 1)
    ixx, iyy, izz, ixy, ixz, iyz = turn_symmetric(cosine, sine, ixx, iyy, izz, ixy, ixz, iyz)
    iyy, izz, ixx, iyz, ixy, ixz = turn_symmetric(ca, sa, iyy, izz, ixx, iyz, ixy, ixz)
    hx, hy, hz = to_parent(c, k, cosine, sine, hx, hy, hz)
    rx = spread_from(c, k + R)
    ry = spread_from(c, k + R + 1)
    rz = spread_from(c, k + R + 2)
    gx = hx + m * rx
    gy = hy + m * ry
    gz = hz + m * rz
    # r (h + g) is twice what the first moment adds, and what the mass adds.
    xx = rx * (hx + gx)
    yy = ry * (hy + gy)
    zz = rz * (hz + gz)
    ixx = ixx + (yy + zz)
    iyy = iyy + (zz + xx)
    izz = izz + (xx + yy)
    ixy = ixy - (rx * hy + ry * gx)
    ixz = ixz - (rx * hz + rz * gx)
    iyz = iyz - (ry * hz + rz * gy)
    return gx, gy, gz, ixx, iyy, izz, ixy, ixz, iyz


def element_places(parents: Sequence[int]) -> NDArray[np.uint64]:
    """Where the elements off the diagonal lie in a flat (n, n) matrix, in the order in which ``mass_matrix`` finds them.

    parents (n,): of the joints, negative at the base. Returns place and mirrored place in turn, those between joints of which
    one carries the other.
    """
    n = len(parents)
    found: list[int] = []
    for i in range(n - 1, -1, -1):
        j = parents[i]
        while j >= 0:
            found += [i * n + j, j * n + i]
            j = parents[j]
    return np.array(found, dtype=np.uint64)


@inner
def _put(ws: Any, element: int, places: Any, out: Any, corner: int, n: int) -> None:
    """One matrix, from elements of eight states: zeros, the diagonal, and four elements at a time with their mirrored ones.

    Matrices of many joints have strides at which eight of them get into each other's way in the cache, which is why each is
    written by itself. Indices without sign are not looked at twice.
    """
    square = n * n
    for k in range(corner, corner + square - 7, 8):
        store(out, k, spread(0.0))
    for k in range(corner + square // 8 * 8, corner + square):
        out[k] = 0.0
    at = np.uint64(element)
    begin = np.uint64(corner)
    for i in range(n):
        out[begin + np.uint64(i * (n + 1))] = ws[at]
        at += np.uint64(8)
    fours = np.uint64(len(places) // 8 * 8)
    for k in range(np.uint64(0), fours, np.uint64(8)):
        first, second = ws[at], ws[at + np.uint64(8)]
        third, fourth = ws[at + np.uint64(16)], ws[at + np.uint64(24)]
        at += np.uint64(32)
        p0, p1, p2, p3 = places[k], places[k + np.uint64(1)], places[k + np.uint64(2)], places[k + np.uint64(3)]
        p4, p5, p6, p7 = (
            places[k + np.uint64(4)],
            places[k + np.uint64(5)],
            places[k + np.uint64(6)],
            places[k + np.uint64(7)],
        )
        out[begin + p0] = first
        out[begin + p1] = first
        out[begin + p2] = second
        out[begin + p3] = second
        out[begin + p4] = third
        out[begin + p5] = third
        out[begin + p6] = fourth
        out[begin + p7] = fourth
    for k in range(fours, np.uint64(len(places)), np.uint64(2)):
        value = ws[at]
        at += np.uint64(8)
        out[begin + places[k]] = value
        out[begin + places[k + np.uint64(1)]] = value


@batch_kernel
def mass_matrix(first: int, last: int, tree: Any, places: Any, c: Any, ws: Any, masses: Any, q: Any, out: Any) -> None:
    """Generalized inertia matrices of the states in rows first, first + 8, … below last, from composite bodies.

    places: as ``element_places``, or empty, in which case elements are written eight states at a time. masses: of the
    composite bodies (n,); out: flat (B, n, n).
    """
    n = tree.shape[0]
    square = n * n
    elements = n * BODY * 8
    by_state = len(places) > 0
    branched = False
    for i in range(n):
        branched = branched or tree[i, PARENT] != i - 1
    for row in range(first, last, 8):
        base = row * n
        corner = row * square
        if branched and not by_state:
            # Elements between branches are left alone by what follows.
            for k in range(corner, corner + 8 * square, 8):
                store(out, k, spread(0.0))
        for i in range(n):
            b = i * BODY * 8
            k = i * CONSTANTS
            position = gather(q, base + i, n)
            cosine, sine = turn_of(c, k, position, tree[i, PRISMATIC])
            store_run(ws, b + TURN * 8, (cosine, sine))
            store(ws, b + SLIDE * 8, position)
            for f in range(3):
                store(ws, b + (WHOLE_FIRST + f) * 8, spread(c[k + FIRST + f]))
            for f in range(6):
                store(ws, b + (WHOLE_SECOND + f) * 8, spread(c[k + SECOND + f]))
        at = elements + n * 8
        for i in range(n - 1, -1, -1):
            b = i * BODY * 8
            k = i * CONSTANTS
            m = masses[i]
            hx, hy, hz = load_run(ws, b + WHOLE_FIRST * 8, 3)
            ixx, iyy, izz, ixy, ixz, iyz = load_run(ws, b + WHOLE_SECOND * 8, 6)
            zero = spread(0.0)
            # Wrench that a unit acceleration of the joint needs, carried to the base along the ancestors' axes.
            if tree[i, PRISMATIC] == 0:
                nx, ny, nz, fx, fy, fz = ixz, iyz, izz, -hy, hx, zero
                own = izz + c[k + ARMATURE]
            else:
                nx, ny, nz, fx, fy, fz = hy, -hx, zero, zero, zero, spread(m)
                own = spread(m + c[k + ARMATURE])
            if by_state:
                store(ws, elements + i * 8, own)
            else:
                scatter(out, corner + i * n + i, square, own)
            j = i
            while tree[j, PARENT] >= 0:
                d = j * BODY * 8
                e = j * CONSTANTS
                cosine, sine = load_run(ws, d + TURN * 8, 2)
                if tree[j, PRISMATIC] != 0:
                    position = load(ws, d + SLIDE * 8)
                    nx = nx - position * fy
                    ny = ny + position * fx
                nx, ny, nz, fx, fy, fz = wrench_to_parent(c, e, tree[j, PREFIX], cosine, sine, nx, ny, nz, fx, fy, fz)
                j = tree[j, PARENT]
                value = nz if tree[j, PRISMATIC] == 0 else fz
                if by_state:
                    store(ws, at, value)
                    at += 8
                else:
                    scatter(out, corner + i * n + j, square, value)
                    scatter(out, corner + j * n + i, square, value)
            p = tree[i, PARENT]
            if p < 0:
                continue
            cosine, sine = load_run(ws, b + TURN * 8, 2)
            slide = load(ws, b + SLIDE * 8) if tree[i, PRISMATIC] != 0 else zero
            hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz = composite_inward(
                c, k, tree[i, PRISMATIC], cosine, sine, slide, m, hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz
            )
            if tree[i, PREFIX] != 0:
                cg = c[k + GAMMA]
                sg = c[k + GAMMA + 1]
                ixx, iyy, izz, ixy, ixz, iyz = turn_symmetric(cg, sg, ixx, iyy, izz, ixy, ixz, iyz)
                hx, hy = cg * hx - sg * hy, sg * hx + cg * hy
            a = (p * BODY + WHOLE_FIRST) * 8
            add_run(ws, a, (hx, hy, hz, ixx, iyy, izz, ixy, ixz, iyz))
        if by_state:
            for s in range(8):
                _put(ws, elements + s, places, out, corner + s * square, n)
