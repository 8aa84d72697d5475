"""What the loops ask at a state: how far each condition is open, its rate and acceleration, and the wrenches that hold it.

A shift along the first frame's axis u is u · d, d being the way from one origin to the other; a turn is the cosine of an axis a
of the first frame and an axis b of the second, which are to stay orthogonal. Accelerations are those that the rows of the tree
hold; gravity, which they hold as well, is the same for both frames.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.compiling.compiled import inlined, internal
from harness.denoc.loops import places as at_
from harness.denoc.loops.tables import (
    ACCELERATION,
    AXIS,
    CONDITIONS,
    COUPLED,
    FIRST,
    HEAD,
    KIND,
    LOOPS,
    OF,
    ORIGIN,
    OTHER,
    RATE,
    ROTATION,
    SECOND,
    SHIFT,
    TWIST,
    VALUE,
    VELOCITY,
)
from harness.denoc.recursion import rows as r
from harness.denoc.recursion.triples import Triple, cross, dot3, minus, plus

Places = Any
Numbers = Any
Rows = Any
Vector = Any


@inlined
def triple(x: Numbers, at: int) -> Triple:
    """The vector at x[at:]."""
    return x[at], x[at + 1], x[at + 2]


@inlined
def column(x: Numbers, at: int, k: int) -> Triple:
    """Column k of a 3 × 3 matrix at x[at:]."""
    return x[at + k], x[at + 3 + k], x[at + 6 + k]


@inlined
def put(x: Numbers, at: int, a: Triple) -> None:
    """Write a vector to x[at:]."""
    x[at], x[at + 1], x[at + 2] = a


@internal
def place_frames(places: Places, x: Numbers, d: Rows) -> None:
    """Every frame in base axes, from the rows of the bodies that carry them."""
    for k in range(2 * places[LOOPS]):
        body, own, out = places[HEAD + k], at_.frame(k), at_.moving(places, k)
        t = d[body]
        for i in range(3):
            t0, t1, t2 = t[r.TURN + 3 * i], t[r.TURN + 3 * i + 1], t[r.TURN + 3 * i + 2]
            for j in range(3):
                x[out + ROTATION + 3 * i + j] = t0 * x[own + j] + t1 * x[own + 3 + j] + t2 * x[own + 6 + j]
            x[out + ORIGIN + i] = t[r.POSITION + i] + t0 * x[own + 9] + t1 * x[own + 10] + t2 * x[own + 11]
        arm = minus(triple(x, out + ORIGIN), triple(t, r.POSITION))
        spin = triple(t, r.SPIN)
        put(x, out + TWIST, spin)
        put(x, out + TWIST + 3, plus(triple(t, r.VELOCITY), cross(spin, arm)))
    accelerate_frames(places, x, d)


@internal
def accelerate_frames(places: Places, x: Numbers, d: Rows) -> None:
    """Accelerations of the frames, which are placed."""
    for k in range(2 * places[LOOPS]):
        body, out = places[HEAD + k], at_.moving(places, k)
        t = d[body]
        arm = minus(triple(x, out + ORIGIN), triple(t, r.POSITION))
        spin, angular = triple(t, r.SPIN), triple(t, r.ACCELERATION)
        put(x, out + RATE, angular)
        pulled = plus(cross(angular, arm), cross(spin, cross(spin, arm)))
        put(x, out + RATE + 3, plus(triple(t, r.ACCELERATION + 3), pulled))


@internal
def evaluate(places: Places, x: Numbers, q: Vector, v: Vector, a: Vector) -> None:
    """Value, rate and acceleration of every condition, and what it weighs on both frames' twists; a: joint accelerations."""
    for k in range(places[CONDITIONS]):
        here, s = at_.condition(places, k), at_.state(places, k)
        sign = x[at_.sign(places, k)]
        of, i, j = places[here + OF], places[here + AXIS], places[here + OTHER]
        if places[here + KIND] == COUPLED:
            _couple(places, x, at_.coupling(places, of), at_.terms(places, of), s, q, v, a)
            continue
        f, g = at_.moving(places, 2 * of), at_.moving(places, 2 * of + 1)
        w1, al1 = triple(x, f + TWIST), triple(x, f + RATE)
        u = column(x, f + ROTATION, i)
        du = cross(w1, u)
        ddu = plus(cross(al1, u), cross(w1, du))
        if places[here + KIND] == SHIFT:
            way = minus(triple(x, g + ORIGIN), triple(x, f + ORIGIN))
            speed = minus(triple(x, g + TWIST + 3), triple(x, f + TWIST + 3))
            pull = minus(triple(x, g + RATE + 3), triple(x, f + RATE + 3))
            x[s + VALUE] = dot3(u, way)
            x[s + VELOCITY] = dot3(u, speed) + dot3(du, way)
            x[s + ACCELERATION] = dot3(u, pull) + 2.0 * dot3(du, speed) + dot3(ddu, way)
            put(x, s + FIRST, cross(u, way))
            put(x, s + FIRST + 3, (-u[0], -u[1], -u[2]))
            put(x, s + SECOND, (0.0, 0.0, 0.0))
            put(x, s + SECOND + 3, u)
        else:
            w2, al2 = triple(x, g + TWIST), triple(x, g + RATE)
            b = column(x, g + ROTATION, j)
            db = cross(w2, b)
            ddb = plus(cross(al2, b), cross(w2, db))
            x[s + VALUE] = sign * dot3(u, b)
            x[s + VELOCITY] = sign * (dot3(du, b) + dot3(u, db))
            x[s + ACCELERATION] = sign * (dot3(ddu, b) + 2.0 * dot3(du, db) + dot3(u, ddb))
            m = cross(b, u)
            put(x, s + FIRST, (-sign * m[0], -sign * m[1], -sign * m[2]))
            put(x, s + FIRST + 3, (0.0, 0.0, 0.0))
            put(x, s + SECOND, (sign * m[0], sign * m[1], sign * m[2]))
            put(x, s + SECOND + 3, (0.0, 0.0, 0.0))


@internal
def _couple(places: Places, x: Numbers, here: int, terms: int, s: int, q: Vector, v: Vector, a: Vector) -> None:
    """A coupling; in place of wrenches the polynomial's slope."""
    value, slope, bend = x[terms], 0.0, 0.0
    velocity, acceleration = 0.0, 0.0
    if places[here + 2] >= 0:
        y = q[places[here + 2]]
        value, slope, bend = 0.0, 0.0, 0.0
        for i in range(4, -1, -1):
            bend = bend * y + 2.0 * slope
            slope = slope * y + value
            value = value * y + x[terms + i]
        velocity, acceleration = v[places[here + 3]], a[places[here + 3]]
    x[s + VALUE] = q[places[here]] - value
    x[s + VELOCITY] = v[places[here + 1]] - slope * velocity
    x[s + ACCELERATION] = a[places[here + 1]] - slope * acceleration - bend * velocity * velocity
    x[s + FIRST] = slope
