"""The equations of motion in positions on their manifold, by those of the lowered tree recentred at every call.

With the rotation of a ball in the placement of its first turn, its three angles are zero and their rates the angular velocity w
in the child's axes. From w = E(angles) · rates of the angles, E being the identity there,

    dw/dt = angle accelerations + (w2 w3, -w1 w3, w1 w2),

so that accelerations differ from those of the angles by a product of rates, and mass matrix, forces and momenta do not differ
at all. Armature of a ball resists dw/dt, as in MuJoCo and Pinocchio: what it makes of that product is put right.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.chart.tables import (
    ARMATURE,
    AXES,
    BALL_NUMBERS,
    BALL_PLACES,
    BALLS,
    COORDINATE,
    FRAME,
    HEAD,
    LOWERED,
    POSITIONS,
    QUATERNION,
    ROW,
    VELOCITIES,
    VELOCITY,
)
from harness.denoc.compiling.compiled import allocating, compiled, inlined, internal
from harness.denoc.recursion.binding import INNER, NUMBERS, PLACES, header_at, rows_of, vector_at, words_at
from harness.denoc.recursion.rows import PLACE

Vector = Any
Rows = Any


@allocating
def places_of(header: Any) -> Any:
    """The chart's integers."""
    head = words_at(header[PLACES], HEAD)
    size = HEAD + head[LOWERED] + head[POSITIONS] + BALL_PLACES * head[BALLS]
    return words_at(header[PLACES], size)


@allocating
def numbers_of(header: Any, places: Any) -> Any:
    """The chart's floats, workspace included."""
    m, n = places[LOWERED], places[VELOCITIES]
    size = 2 * m + BALL_NUMBERS * places[BALLS] + m * n + workspace(m, n)
    return vector_at(header[NUMBERS], size)


@internal
def workspace(m: int, n: int) -> int:
    """Numbers of workspace behind the chart's constants."""
    return 6 * m + 4 * n + m * m + n * n + m * n


@internal
def work_begins(places: Any) -> int:
    """Where the workspace begins behind the chart's constants."""
    m, n = places[LOWERED], places[VELOCITIES]
    return 2 * m + BALL_NUMBERS * places[BALLS] + m * n


@internal
def ball_at(places: Any, k: int) -> int:
    """Where the integers of ball k begin."""
    return HEAD + places[LOWERED] + places[POSITIONS] + BALL_PLACES * k


@inlined
def rotation(w: Any, x: Any, y: Any, z: Any) -> Any:
    """Rotation matrix of a quaternion, row after row; one of any length but zero means the same rotation."""
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
        s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x),
        s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y),
    )  # fmt: skip


@internal
def recentre(rows: Rows, places: Any, numbers: Any, q: Vector, local: Vector) -> None:
    """Lowered positions of q to ``local``, and the rotations of balls to ``rows`` of the lowered tree."""
    m = places[LOWERED]
    for k in range(m):
        taken = places[HEAD + k]
        local[k] = numbers[m + k] + (numbers[k] * q[taken] if taken >= 0 else 0.0)
    for k in range(places[BALLS]):
        at, own = ball_at(places, k), 2 * m + BALL_NUMBERS * k
        first = places[at + QUATERNION]
        r0, r1, r2, r3, r4, r5, r6, r7, r8 = rotation(q[first], q[first + 1], q[first + 2], q[first + 3])
        f, a, place = own + FRAME, own + AXES, places[at + ROW]
        for i in range(3):
            f0, f1, f2 = numbers[f + 3 * i], numbers[f + 3 * i + 1], numbers[f + 3 * i + 2]
            t0 = f0 * r0 + f1 * r3 + f2 * r6
            t1 = f0 * r1 + f1 * r4 + f2 * r7
            t2 = f0 * r2 + f1 * r5 + f2 * r8
            for j in range(3):
                value = t0 * numbers[a + j] + t1 * numbers[a + 3 + j] + t2 * numbers[a + 6 + j]
                rows[place, PLACE + 3 * i + j] = value


@internal
def add_products(places: Any, w: Vector, sign: float, out: Vector) -> None:
    """Add ``sign`` times the products of rates of every ball to lowered coordinates; w: lowered rates."""
    for k in range(places[BALLS]):
        c = places[ball_at(places, k) + COORDINATE]
        out[c] += sign * w[c + 1] * w[c + 2]
        out[c + 1] -= sign * w[c] * w[c + 2]
        out[c + 2] += sign * w[c] * w[c + 1]


@internal
def add_armature(places: Any, numbers: Any, w: Vector, sign: float, out: Vector) -> None:
    """Add ``sign`` times armature times the products of rates of every ball."""
    m = places[LOWERED]
    for k in range(places[BALLS]):
        armature = sign * numbers[2 * m + BALL_NUMBERS * k + ARMATURE]
        c = places[ball_at(places, k) + COORDINATE]
        out[c] += armature * w[c + 1] * w[c + 2]
        out[c + 1] -= armature * w[c] * w[c + 2]
        out[c + 2] += armature * w[c] * w[c + 1]


@internal
def position_rates(places: Any, q: Vector, v: Vector, out: Vector) -> None:
    """Rates of the positions: velocities themselves, and q̇ = ½ q ⊗ (0, w) of quaternions."""
    rates = HEAD + places[LOWERED]
    for k in range(places[POSITIONS]):
        velocity = places[rates + k]
        if velocity >= 0:
            out[k] = v[velocity]
    for k in range(places[BALLS]):
        at = ball_at(places, k)
        i, j = places[at + QUATERNION], places[at + VELOCITY]
        w, x, y, z = q[i], q[i + 1], q[i + 2], q[i + 3]
        a, b, c = 0.5 * v[j], 0.5 * v[j + 1], 0.5 * v[j + 2]
        out[i] = -x * a - y * b - z * c
        out[i + 1] = w * a + y * c - z * b
        out[i + 2] = w * b + z * a - x * c
        out[i + 3] = w * c + x * b - y * a


@internal
def normalise(places: Any, q: Vector) -> None:
    """Quaternions to unit length."""
    for k in range(places[BALLS]):
        i = places[ball_at(places, k) + QUATERNION]
        scale = 1.0 / np.sqrt(q[i] ** 2 + q[i + 1] ** 2 + q[i + 2] ** 2 + q[i + 3] ** 2)
        for j in range(4):
            q[i + j] *= scale


@compiled
def recentred(model: int, q: Vector, local: Vector) -> None:
    """``recentre`` from Python: model is the address of a header."""
    header = header_at(model)
    places = places_of(header)
    recentre(rows_of(header_at(header[INNER])), places, numbers_of(header, places), q, local)
