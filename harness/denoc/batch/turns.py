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

from harness.denoc.chart.kernels import rotation
from harness.denoc.compiling.compiled import compiled, inlined

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
            turn = rotation(q[r, i], q[r, i + 1], q[r, i + 2], q[r, i + 3])
            if balls[j, FLOATS] != 0:
                for c in range(TURN):
                    kept[r, t + c] = turn[c]
                for c in range(3):
                    local[r, k - 3 + c] = 0.0
                rates[r, k - 3], rates[r, k - 2], rates[r, k - 1] = turned_back(
                    kept, r, t, v[r, k - 3], v[r, k - 2], v[r, k - 1]
                )
                continue
            r00, r01, r02, r12, r22 = turn[0], turn[1], turn[2], turn[5], turn[8]
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
            rates[r, k], rates[r, k + 1], rates[r, k + 2] = of_spin(
                (cb, r02, cc, sc), v[r, k], v[r, k + 1], v[r, k + 2]
            )


@inlined
def turned_back(kept: Any, r: int, t: int, x: Any, y: Any, z: Any) -> Any:
    """A vector in a floating body's axes, Rᵀ times it."""
    return (
        kept[r, t] * x + kept[r, t + 3] * y + kept[r, t + 6] * z,
        kept[r, t + 1] * x + kept[r, t + 4] * y + kept[r, t + 7] * z,
        kept[r, t + 2] * x + kept[r, t + 5] * y + kept[r, t + 8] * z,
    )


@inlined
def turned(kept: Any, r: int, t: int, x: Any, y: Any, z: Any) -> Any:
    """A vector out of a floating body's axes, R times it."""
    return (
        kept[r, t] * x + kept[r, t + 1] * y + kept[r, t + 2] * z,
        kept[r, t + 3] * x + kept[r, t + 4] * y + kept[r, t + 5] * z,
        kept[r, t + 6] * x + kept[r, t + 7] * y + kept[r, t + 8] * z,
    )


@inlined
def of_ball(kept: Any, r: int, t: int, floats: int) -> Any:
    """Cosine and sine of b, of c; none of a floating body is turned."""
    if floats != 0:
        return 1.0, 0.0, 1.0, 0.0
    return kept[r, t], kept[r, t + 1], kept[r, t + 2], kept[r, t + 3]


@inlined
def to_spin(trig: Any, a: Any, b: Any, c: Any) -> Any:
    """E times a vector of the turns."""
    cb, sb, cc, sc = trig
    return cc * cb * a + sc * b, -sc * cb * a + cc * b, sb * a + c


@inlined
def of_spin(trig: Any, x: Any, y: Any, z: Any) -> Any:
    """E⁻¹ times a vector of the spin."""
    cb, sb, cc, sc = trig
    a = (cc * x - sc * y) / cb
    return a, sc * x + cc * y, z - sb * a


@inlined
def moments_to_spin(trig: Any, a: Any, b: Any, c: Any) -> Any:
    """E⁻ᵀ times moments on the turns."""
    cb, sb, cc, sc = trig
    u = (a - sb * c) / cb
    return cc * u + sc * b, cc * b - sc * u, c


@inlined
def moments_of_spin(trig: Any, x: Any, y: Any, z: Any) -> Any:
    """Eᵀ times moments on the spin."""
    cb, sb, cc, sc = trig
    return cb * (cc * x - sc * y) + sb * z, sc * x + cc * y, z


@inlined
def product(trig: Any, a: Any, b: Any, c: Any) -> Any:
    """Ė times the rates of the turns."""
    cb, sb, cc, sc = trig
    return (
        -(sc * cb * c + cc * sb * b) * a + cc * c * b,
        (sc * sb * b - cc * cb * c) * a - sc * c * b,
        cb * b * a,
    )


@compiled
def forces_to_turns(balls: Any, damping: Any, v: Any, tau: Any, kept: Any, forces: Any) -> None:
    """Lowered forces from those on the velocities (B, n), the dampers of balls counted; damping: of each ball."""
    for r in range(tau.shape[0]):
        for k in range(tau.shape[1]):
            forces[r, k] = tau[r, k]
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            forces[r, k], forces[r, k + 1], forces[r, k + 2] = moments_of_spin(
                of_ball(kept, r, t, floats),
                tau[r, k] - damping[j] * v[r, k],
                tau[r, k + 1] - damping[j] * v[r, k + 1],
                tau[r, k + 2] - damping[j] * v[r, k + 2],
            )
            if floats != 0:
                forces[r, k - 3], forces[r, k - 2], forces[r, k - 1] = turned_back(
                    kept, r, t, tau[r, k - 3], tau[r, k - 2], tau[r, k - 1]
                )


@compiled
def accelerations_from_turns(balls: Any, gravity: Any, rates: Any, kept: Any, out: Any) -> None:
    """Lowered accelerations (B, n) made those of the velocities, in place; gravity: of each ball in the axes that it moves in."""
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            trig = of_ball(kept, r, t, floats)
            x, y, z = product(trig, rates[r, k], rates[r, k + 1], rates[r, k + 2])
            a, b, c = to_spin(trig, out[r, k], out[r, k + 1], out[r, k + 2])
            out[r, k], out[r, k + 1], out[r, k + 2] = a + x, b + y, c + z
            if floats != 0:
                x, y, z = turned(kept, r, t, out[r, k - 3], out[r, k - 2], out[r, k - 1])
                out[r, k - 3], out[r, k - 2], out[r, k - 1] = x + gravity[j, 0], y + gravity[j, 1], z + gravity[j, 2]


@compiled
def accelerations_to_turns(balls: Any, gravity: Any, qdd: Any, rates: Any, kept: Any, asked: Any) -> None:
    """Lowered accelerations from those of the velocities, (B, n)."""
    for r in range(qdd.shape[0]):
        for k in range(qdd.shape[1]):
            asked[r, k] = qdd[r, k]
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            trig = of_ball(kept, r, t, floats)
            x, y, z = product(trig, rates[r, k], rates[r, k + 1], rates[r, k + 2])
            asked[r, k], asked[r, k + 1], asked[r, k + 2] = of_spin(
                trig, qdd[r, k] - x, qdd[r, k + 1] - y, qdd[r, k + 2] - z
            )
            if floats != 0:
                asked[r, k - 3], asked[r, k - 2], asked[r, k - 1] = turned_back(
                    kept,
                    r,
                    t,
                    qdd[r, k - 3] - gravity[j, 0],
                    qdd[r, k - 2] - gravity[j, 1],
                    qdd[r, k - 1] - gravity[j, 2],
                )


@compiled
def forces_from_turns(balls: Any, damping: Any, v: Any, kept: Any, out: Any) -> None:
    """Lowered forces (B, n) made those on the velocities, the dampers of balls counted, in place."""
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            k, t, floats = balls[j, FIRST], TURN * j, balls[j, FLOATS]
            x, y, z = moments_to_spin(of_ball(kept, r, t, floats), out[r, k], out[r, k + 1], out[r, k + 2])
            out[r, k] = x + damping[j] * v[r, k]
            out[r, k + 1] = y + damping[j] * v[r, k + 1]
            out[r, k + 2] = z + damping[j] * v[r, k + 2]
            if floats != 0:
                out[r, k - 3], out[r, k - 2], out[r, k - 1] = turned(
                    kept, r, t, out[r, k - 3], out[r, k - 2], out[r, k - 1]
                )


@inlined
def out_of_lowered(kept: Any, r: int, t: int, floats: int, x: Any, y: Any, z: Any) -> Any:
    """Three entries of a row of masses: of what floats those of its slides, of another ball those of its turns."""
    if floats != 0:
        return turned(kept, r, t, x, y, z)
    return moments_to_spin(of_ball(kept, r, t, floats), x, y, z)


@compiled
def masses_from_turns(balls: Any, kept: Any, out: Any) -> None:
    """Lowered mass matrices (B, n, n) made those of the velocities, in place."""
    n = out.shape[1]
    for r in range(out.shape[0]):
        for j in range(balls.shape[0]):
            t, floats = TURN * j, balls[j, FLOATS]
            k = balls[j, FIRST] - 3 if floats != 0 else balls[j, FIRST]
            for i in range(n):
                out[r, i, k], out[r, i, k + 1], out[r, i, k + 2] = out_of_lowered(
                    kept, r, t, floats, out[r, i, k], out[r, i, k + 1], out[r, i, k + 2]
                )
            for i in range(n):
                out[r, k, i], out[r, k + 1, i], out[r, k + 2, i] = out_of_lowered(
                    kept, r, t, floats, out[r, k, i], out[r, k + 1, i], out[r, k + 2, i]
                )
