"""States of mechanisms whose joints turn in space, as states of the joints of one degree that they are lowered to, row by row.

What floats freely, with all else hanging on it, may be looked at from axes that stand still and coincide with its own at that
moment: its rotation is none then, its linear velocity, acceleration and force are turned, and weight, which acts on all of it
alike, is an acceleration less.

Any other ball is lowered to turns a, b, c about x, y and z one after the other (``system.lowering``), R = Rx(a) Ry(b) Rz(c). With
cosines and sines of b and c its spin in the child's axes is w = E (ȧ, ḃ, ċ),

    E = [[cos c cos b, sin c, 0], [-sin c cos b, cos c, 0], [sin b, 0, 1]],

so that dw/dt = E (ä, b̈, c̈) + Ė (ȧ, ḃ, ċ), forces of the turns are Eᵀ those of the spin, and the matrix of masses is congruent.
Where cos b is small, E nearly loses a direction: such rows are told, and left to the recursion that has no such place.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.compiling.compiled import compiled, inlined, internal

# cos b below which a row is left out: rounding grows as its inverse square, and of all rotations one in a hundred is there.
NEAREST = 0.15
TURN = 9  # numbers kept of each ball and row: of a floating one its rotation, of another cosine and sine of b, of c
QUATERNION, FIRST, FLOATS = range(3)  # of each ball: where its quaternion begins, its first turn, whether it floats


@compiled
def to_turns(
    balls: Any, take: Any, factor: Any, shift: Any, q: Any, v: Any, local: Any, rates: Any, kept: Any, near: Any
) -> None:
    """Lowered positions and rates from positions (B, nq) and velocities (B, n), and what other conversions need of each ball.

    near: which rows are to be left out, (B,) of 0 and 1.
    """
    for r in range(q.shape[0]):
        near[r] = 0
        for k in range(take.shape[0]):
            rates[r, k] = v[r, k]
            local[r, k] = factor[k] * q[r, take[k]] + shift[k] if take[k] >= 0 else 0.0
        for j in range(balls.shape[0]):
            i, k, t = balls[j, QUATERNION], balls[j, FIRST], TURN * j
            w, x, y, z = q[r, i], q[r, i + 1], q[r, i + 2], q[r, i + 3]
            s = 2.0 / (w * w + x * x + y * y + z * z)
            r00, r01, r02 = 1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)
            r12, r22 = s * (y * z - w * x), 1.0 - s * (x * x + y * y)
            if balls[j, FLOATS] != 0:
                kept[r, t], kept[r, t + 1], kept[r, t + 2], kept[r, t + 5], kept[r, t + 8] = r00, r01, r02, r12, r22
                kept[r, t + 3], kept[r, t + 4] = s * (x * y + w * z), 1.0 - s * (x * x + z * z)
                kept[r, t + 6], kept[r, t + 7] = s * (x * z - w * y), s * (y * z + w * x)
                for c in range(3):
                    local[r, k - 3 + c] = 0.0
                    local[r, k + c] = 0.0
                turned_back(kept, r, t, v, k - 3, rates)
                continue
            cb = np.sqrt(r00 * r00 + r01 * r01)
            if cb < NEAREST:
                near[r] = 1
                # Any sound state: what comes of it is not used.
                r00, r01, r02, r12, r22, cb = 1.0, 0.0, 0.0, 0.0, 1.0, 1.0
            cc, sc = r00 / cb, -r01 / cb
            local[r, k] = np.arctan2(-r12, r22)
            local[r, k + 1] = np.arctan2(r02, cb)
            local[r, k + 2] = np.arctan2(sc, cc)
            kept[r, t], kept[r, t + 1], kept[r, t + 2], kept[r, t + 3] = cb, r02, cc, sc
            wx, wy, wz = v[r, k], v[r, k + 1], v[r, k + 2]
            a = (cc * wx - sc * wy) / cb
            rates[r, k], rates[r, k + 1], rates[r, k + 2] = a, sc * wx + cc * wy, wz - r02 * a


@internal
def turned_back(kept: Any, r: int, t: int, vectors: Any, k: int, out: Any) -> None:
    """A vector in a floating body's axes, Rᵀ times columns k to k + 2 of a row."""
    x, y, z = vectors[r, k], vectors[r, k + 1], vectors[r, k + 2]
    for c in range(3):
        out[r, k + c] = kept[r, t + c] * x + kept[r, t + 3 + c] * y + kept[r, t + 6 + c] * z


@internal
def turned(kept: Any, r: int, t: int, vectors: Any, k: int, out: Any) -> None:
    """A vector out of a floating body's axes, R times columns k to k + 2 of a row."""
    x, y, z = vectors[r, k], vectors[r, k + 1], vectors[r, k + 2]
    for c in range(3):
        out[r, k + c] = kept[r, t + 3 * c] * x + kept[r, t + 3 * c + 1] * y + kept[r, t + 3 * c + 2] * z


@inlined
def product(cb: Any, sb: Any, cc: Any, sc: Any, a: Any, b: Any, c: Any) -> Any:
    """Ė (ȧ, ḃ, ċ)."""
    return (
        -(sc * cb * c + cc * sb * b) * a + cc * c * b,
        (sc * sb * b - cc * cb * c) * a - sc * c * b,
        cb * b * a,
    )


@inlined
def of_ball(kept: Any, r: int, t: int, floats: int) -> Any:
    """Cosine and sine of b, of c; none of a floating body is turned."""
    if floats != 0:
        return 1.0, 0.0, 1.0, 0.0
    return kept[r, t], kept[r, t + 1], kept[r, t + 2], kept[r, t + 3]


@compiled
def forces_to_turns(balls: Any, damping: Any, v: Any, tau: Any, kept: Any, forces: Any) -> None:
    """Lowered forces from those on the velocities (B, n), the dampers of balls counted; damping: of each ball."""
    for r in range(tau.shape[0]):
        for k in range(tau.shape[1]):
            forces[r, k] = tau[r, k]
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            cb, sb, cc, sc = of_ball(kept, r, t, floats)
            x = tau[r, k] - damping[j] * v[r, k]
            y = tau[r, k + 1] - damping[j] * v[r, k + 1]
            z = tau[r, k + 2] - damping[j] * v[r, k + 2]
            forces[r, k] = cb * (cc * x - sc * y) + sb * z
            forces[r, k + 1] = sc * x + cc * y
            forces[r, k + 2] = z
            if floats != 0:
                turned_back(kept, r, t, tau, k - 3, forces)


@compiled
def accelerations_from_turns(balls: Any, gravity: Any, rates: Any, kept: Any, out: Any) -> None:
    """Lowered accelerations (B, n) made those of the velocities, in place; gravity: of what floats."""
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            cb, sb, cc, sc = of_ball(kept, r, t, floats)
            x, y, z = product(cb, sb, cc, sc, rates[r, k], rates[r, k + 1], rates[r, k + 2])
            a, b, c = out[r, k], out[r, k + 1], out[r, k + 2]
            out[r, k] = cc * cb * a + sc * b + x
            out[r, k + 1] = -sc * cb * a + cc * b + y
            out[r, k + 2] = sb * a + c + z
            if floats != 0:
                turned(kept, r, t, out, k - 3, out)
                for i in range(3):
                    out[r, k - 3 + i] += gravity[i]


@compiled
def accelerations_to_turns(balls: Any, gravity: Any, qdd: Any, rates: Any, kept: Any, asked: Any) -> None:
    """Lowered accelerations from those of the velocities, (B, n)."""
    for r in range(qdd.shape[0]):
        for k in range(qdd.shape[1]):
            asked[r, k] = qdd[r, k]
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            cb, sb, cc, sc = of_ball(kept, r, t, floats)
            x, y, z = product(cb, sb, cc, sc, rates[r, k], rates[r, k + 1], rates[r, k + 2])
            x, y, z = qdd[r, k] - x, qdd[r, k + 1] - y, qdd[r, k + 2] - z
            a = (cc * x - sc * y) / cb
            asked[r, k], asked[r, k + 1], asked[r, k + 2] = a, sc * x + cc * y, z - sb * a
            if floats != 0:
                for i in range(3):
                    asked[r, k - 3 + i] -= gravity[i]
                turned_back(kept, r, t, asked, k - 3, asked)


@compiled
def forces_from_turns(balls: Any, damping: Any, v: Any, kept: Any, out: Any) -> None:
    """Lowered forces (B, n) made those on the velocities, the dampers of balls counted, in place."""
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            cb, sb, cc, sc = of_ball(kept, r, t, floats)
            u, b, c = (out[r, k] - sb * out[r, k + 2]) / cb, out[r, k + 1], out[r, k + 2]
            out[r, k] = cc * u + sc * b + damping[j] * v[r, k]
            out[r, k + 1] = -sc * u + cc * b + damping[j] * v[r, k + 1]
            out[r, k + 2] = c + damping[j] * v[r, k + 2]
            if floats != 0:
                turned(kept, r, t, out, k - 3, out)


@compiled
def masses_from_turns(balls: Any, kept: Any, out: Any) -> None:
    """Lowered mass matrices (B, n, n) made those of the velocities, in place."""
    n = out.shape[1]
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            if floats != 0:
                turned_masses(kept, r, t, k - 3, n, out)
                continue
            cb, sb, cc, sc = of_ball(kept, r, t, floats)
            for i in range(n):
                u, b, c = (out[r, i, k] - sb * out[r, i, k + 2]) / cb, out[r, i, k + 1], out[r, i, k + 2]
                out[r, i, k], out[r, i, k + 1], out[r, i, k + 2] = cc * u + sc * b, cc * b - sc * u, c
            for i in range(n):
                u, b, c = (out[r, k, i] - sb * out[r, k + 2, i]) / cb, out[r, k + 1, i], out[r, k + 2, i]
                out[r, k, i], out[r, k + 1, i], out[r, k + 2, i] = cc * u + sc * b, cc * b - sc * u, c


@internal
def turned_masses(kept: Any, r: int, t: int, k: int, n: int, out: Any) -> None:
    """Columns and rows k to k + 2 of a matrix out of a floating body's axes."""
    for i in range(n):
        x, y, z = out[r, i, k], out[r, i, k + 1], out[r, i, k + 2]
        for c in range(3):
            out[r, i, k + c] = kept[r, t + 3 * c] * x + kept[r, t + 3 * c + 1] * y + kept[r, t + 3 * c + 2] * z
    for i in range(n):
        x, y, z = out[r, k, i], out[r, k + 1, i], out[r, k + 2, i]
        for c in range(3):
            out[r, k + c, i] = kept[r, t + 3 * c] * x + kept[r, t + 3 * c + 1] * y + kept[r, t + 3 * c + 2] * z
