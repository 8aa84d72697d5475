"""A recursion of the lanes with what it does not know by itself: loops that are closed, and forces that turn with a joint in space.

The tree's own recursion is called for the accelerations without constraint forces a, and once more for every condition, with its
row of the Jacobian as a force, for A = J M⁻¹ Jᵀ. Constraint forces are those that leave no acceleration of any condition open
beyond what a spring and a damper of the rate ``KEPT_BY`` ask for: what rounding opens closes again (Baumgarte, Comput.
Methods Appl. Mech. Eng. 1 (1972)).

A loop with clearance is no condition but a contact: within its gap the frames go free of each other, beyond it a stiff spring and
a damper push them back and never pull, along the way from one origin to the other as far as the loop closes shifts.

Dry friction holds a mechanism of one degree of freedom at all its joints together: what they can bear adds up by how far each of
them moves. With more degrees of freedom it holds, at the joints that stick and at those that cannot move while these do, by the
forces within what each can bear that leave the least motion (Gauss's principle; a quadratic programme in a box, which the projected
Gauss-Seidel method solves however many joints stick: Moreau, in Nonsmooth Mechanics and Applications, CISM 302 (1988) 1).

A ball is three turns about x, y and z (Cardan angles) within lanes, of which the middle one keeps off a quarter of a turn. What
acts on it acts on its angular velocity ω: a torque of −(c + F / |ω| + d |ω|) ω, in which F / |ω| stays finite near rest. What rubs
where a loop is closed acts in the same way on how fast its two frames turn against one another, which is no coordinate's rate.

The plan is an array of integers (``closing.Beyond``); numbers stand behind the workspace of the tree, in vectors of eight lanes.
"""

from __future__ import annotations

import math
from typing import Any

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.nodes import DIRECTION, FREE, HOLD, JOINT, LIMIT, QD, QDD, RESTS, TAU, Q
from harness.denoc.recursion.triples import cross, dot3, minus, plus
from harness.denoc.simd.vector import (
    call_recursion,
    choose,
    in_place,
    inner,
    lane_stepper,
    load,
    load_run,
    sine_cosine,
    spread,
    square_root,
    store,
    store_run,
    vectors,
)

# Heads of the plan.
RECURSION, TAIL, GROUPS, BODIES, CONDITIONS, DEGREES, LEADING, COORDINATES, LOOPS = range(9)
PLAN = 9
# Integers of a group: first coordinate, kind; of a body: parent (−1 base), kind, coordinate; of a condition: kind, two bodies,
# which loop it is of (−1: none that can be open).
GROUP_PLACES, BODY_PLACES, CONDITION_PLACES = 2, 3, 4
SPIN, SHIFT = 0, 1
FIXED, TURNS, SLIDES = 0, 1, 2
ALONG, ACROSS, COUPLED = 0, 1, 2
# Numbers: of a group its laws, of a body rotation, origin and axis, of a condition axis and point of the first, those of the
# second, of a loop gap, stiffness and damping.
GROUP_NUMBERS, BODY_NUMBERS, CONDITION_NUMBERS, LOOP_NUMBERS = 4, 15, 9, 6
TURNING = 3  # of a loop's numbers, those before its laws
# A body in motion: rotation, origin, angular and linear velocity, their accelerations, axis.
MOTION = 27
KEPT_BY = 20.0  # rad/s
STUCK = 1e-9  # share of a joint's mobility, below which it has none
RESTING = 1e-6  # rad/s (m/s), which what a mechanism is open by leaves of a joint's velocity at most
SWEEPS = 2000  # of the method of Gauss and Seidel; a few dozen do unless joints are all but alike
ALMOST_REST = 1e-3  # rad/s (m/s), below which dry friction of a ball gives way
CLOSED = 1e-14
NEAR = 0.05  # of the mechanism's size or in radians, within which a state is closed as it is, and otherwise from the stated one
WITHIN, YIELDS = 1.1, 1e-3
PACE = 0.1  # rad or m at a time from the stated position


@inner
def _bodies_at(plan: Any) -> int:
    return PLAN + GROUP_PLACES * plan[GROUPS]


@inner
def _conditions_at(plan: Any) -> int:
    return _bodies_at(plan) + BODY_PLACES * plan[BODIES]


@inner
def _body_numbers(plan: Any) -> int:
    return plan[TAIL] + GROUP_NUMBERS * plan[GROUPS]


@inner
def _condition_numbers(plan: Any) -> int:
    return _body_numbers(plan) + BODY_NUMBERS * plan[BODIES]


@inner
def _loop_numbers(plan: Any) -> int:
    return _condition_numbers(plan) + CONDITION_NUMBERS * plan[CONDITIONS]


@inner
def _motion_at(plan: Any) -> int:
    return _loop_numbers(plan) + LOOP_NUMBERS * plan[LOOPS]


@inner
def _states_at(plan: Any) -> int:
    """Value, rate and bias of the acceleration of every condition."""
    return _motion_at(plan) + MOTION * plan[BODIES]


@inner
def _jacobian_at(plan: Any) -> int:
    return _states_at(plan) + 3 * plan[CONDITIONS]


@inner
def _answers_at(plan: Any) -> int:
    """Accelerations by every condition's force."""
    return _jacobian_at(plan) + plan[CONDITIONS] * plan[COORDINATES]


@inner
def _system_at(plan: Any) -> int:
    """Equations of the constraint forces."""
    return _answers_at(plan) + plan[CONDITIONS] * plan[COORDINATES]


@inner
def _kept_at(plan: Any) -> int:
    """Vectors of coordinates: forces, modes, directions, accelerations, response of the leading one."""
    return _system_at(plan) + plan[CONDITIONS] * (plan[CONDITIONS] + 1)


@in_place
def _get(ws: Any, at: int, k: int) -> Any:
    """The vector at ``at + k``, of eight lanes."""
    return load_run(ws, (at + k) * 8, 3)


@inner
def _of_lane(ws: Any, at: int, lane: int) -> Any:
    """The vector at ``at`` of one lane."""
    p = at * 8 + lane
    return ws[p], ws[p + 8], ws[p + 16]


@in_place
def _times(s: Any, a: Any) -> Any:
    return s * a[0], s * a[1], s * a[2]


@in_place
def _nowhere() -> Any:
    """The vector 0 in all lanes."""
    zero = spread(0.0)
    return zero, zero, zero


@in_place
def _turned(ws: Any, at: int, a: Any) -> Any:
    """A vector in the axes of the body whose motion is at ``at``, in base axes."""
    r = load_run(ws, at * 8, 9)
    return (
        r[0] * a[0] + r[1] * a[1] + r[2] * a[2],
        r[3] * a[0] + r[4] * a[1] + r[5] * a[2],
        r[6] * a[0] + r[7] * a[1] + r[8] * a[2],
    )


@inner
def move_bodies(plan: Any, ws: Any) -> None:
    """Place and motion of every body, accelerations without those of the coordinates."""
    here, numbers, motion = _bodies_at(plan), _body_numbers(plan), _motion_at(plan)
    for b in range(plan[BODIES]):
        above, kind, coordinate = plan[here + 3 * b], plan[here + 3 * b + 1], plan[here + 3 * b + 2]
        own, out = numbers + BODY_NUMBERS * b, motion + MOTION * b
        origin, spin, speed, spin_rate, pull = (
            _get(ws, own, 9), _nowhere(), _nowhere(), _nowhere(), _nowhere()
        )  # fmt: skip
        if above >= 0:
            up = motion + MOTION * above
            arm = _turned(ws, up, origin)
            spin, spin_rate = _get(ws, up, 12), _get(ws, up, 18)
            origin = plus(_get(ws, up, 9), arm)
            speed = plus(_get(ws, up, 15), cross(spin, arm))
            pull = plus(_get(ws, up, 21), plus(cross(spin_rate, arm), cross(spin, cross(spin, arm))))
            for column in range(3):
                p = (own + column) * 8
                turned = _turned(ws, up, (load(ws, p), load(ws, p + 24), load(ws, p + 48)))
                p = (out + column) * 8
                store(ws, p, turned[0])
                store(ws, p + 24, turned[1])
                store(ws, p + 48, turned[2])
        else:
            store_run(ws, out * 8, load_run(ws, own * 8, 9))
        if kind != FIXED:
            a = _get(ws, own, 12)
            axis = _turned(ws, out, a)
            j = coordinate * JOINT * 8
            q, qd = load(ws, j + Q * 8), load(ws, j + QD * 8)
            store_run(ws, (out + 24) * 8, axis)
            if kind == SLIDES:
                arm = _times(q, axis)
                origin = plus(origin, arm)
                going = _times(qd, axis)
                pull = plus(pull, plus(cross(spin_rate, arm), cross(spin, cross(spin, arm))))
                pull = plus(pull, _times(2.0, cross(spin, going)))
                speed = plus(speed, plus(cross(spin, arm), going))
            else:
                s, c = sine_cosine(q)
                d = 1.0 - c
                x, y, z = a
                for row in range(3):
                    p = (out + 3 * row) * 8
                    r0, r1, r2 = load_run(ws, p, 3)
                    store_run(
                        ws,
                        p,
                        (
                            r0 * (c + d * x * x) + r1 * (d * x * y + s * z) + r2 * (d * x * z - s * y),
                            r0 * (d * x * y - s * z) + r1 * (c + d * y * y) + r2 * (d * y * z + s * x),
                            r0 * (d * x * z + s * y) + r1 * (d * y * z - s * x) + r2 * (c + d * z * z),
                        ),
                    )
                turning = _times(qd, axis)
                spin_rate = plus(spin_rate, cross(spin, turning))
                spin = plus(spin, turning)
        store_run(ws, (out + 9) * 8, origin)
        store_run(ws, (out + 12) * 8, spin)
        store_run(ws, (out + 15) * 8, speed)
        store_run(ws, (out + 18) * 8, spin_rate)
        store_run(ws, (out + 21) * 8, pull)


@in_place
def _of_body(ws: Any, motion: int, body: int, k: int) -> Any:
    """A vector of a body's motion; nothing of the base's."""
    return _nowhere() if body < 0 else _get(ws, motion + MOTION * body, k)


@in_place
def _in_base(ws: Any, motion: int, body: int, a: Any) -> Any:
    return a if body < 0 else _turned(ws, motion + MOTION * body, a)


@inner
def _measure_coupling(ws: Any, joint: int, leader: int, own: int, states: int, row: int) -> None:
    """A coupling's value, rate and bias of the acceleration, to ``states``, and its row of the Jacobian.

    own: its five coefficients.
    """
    zero = spread(0.0)
    j = joint * JOINT * 8
    value, slope, bend, led = load(ws, own * 8), zero, zero, zero
    if leader >= 0:
        l = leader * JOINT * 8
        y, led = load(ws, l + Q * 8), load(ws, l + QD * 8)
        value = zero
        for i in range(4, -1, -1):
            bend = bend * y + 2.0 * slope
            slope = slope * y + value
            value = value * y + load(ws, (own + i) * 8)
        store(ws, (row + leader) * 8, -slope)
    store(ws, (row + joint) * 8, spread(1.0))
    store_run(ws, states * 8, (load(ws, j + Q * 8) - value, load(ws, j + QD * 8) - slope * led, -bend * led * led))


@inner
def measure_conditions(plan: Any, ws: Any) -> None:
    """Value, rate, bias of the acceleration and row of the Jacobian of every condition, once bodies are placed."""
    n = plan[COORDINATES]
    here, numbers, jacobian = _conditions_at(plan), _condition_numbers(plan), _jacobian_at(plan)
    bodies, motion = _bodies_at(plan), _motion_at(plan)
    for k in range(plan[CONDITIONS]):
        place = here + CONDITION_PLACES * k
        kind, one, other = plan[place], plan[place + 1], plan[place + 2]
        own, row, states = numbers + CONDITION_NUMBERS * k, jacobian + n * k, _states_at(plan) + 3 * k
        for i in range(n):
            store(ws, (row + i) * 8, spread(0.0))
        if kind == COUPLED:
            _measure_coupling(ws, one, other, own, states, row)
            continue
        w1, w2 = _of_body(ws, motion, one, 12), _of_body(ws, motion, other, 12)
        al1, al2 = _of_body(ws, motion, one, 18), _of_body(ws, motion, other, 18)
        u = _in_base(ws, motion, one, _get(ws, own, 0))
        b = _in_base(ws, motion, other, _get(ws, own, 6))
        du = cross(w1, u)
        ddu = plus(cross(al1, u), cross(w1, du))
        x2, way = _nowhere(), _nowhere()
        if kind == ALONG:
            p = _in_base(ws, motion, one, _get(ws, own, 3))
            x2 = plus(_of_body(ws, motion, other, 9), b)
            way = minus(x2, plus(_of_body(ws, motion, one, 9), p))
            v1 = plus(_of_body(ws, motion, one, 15), cross(w1, p))
            v2 = plus(_of_body(ws, motion, other, 15), cross(w2, b))
            a1 = plus(_of_body(ws, motion, one, 21), plus(cross(al1, p), cross(w1, cross(w1, p))))
            a2 = plus(_of_body(ws, motion, other, 21), plus(cross(al2, b), cross(w2, cross(w2, b))))
            going = minus(v2, v1)
            bias = dot3(u, minus(a2, a1)) + 2.0 * dot3(du, going) + dot3(ddu, way)
            store_run(ws, states * 8, (dot3(u, way), dot3(u, going) + dot3(du, way), bias))
        else:
            db = cross(w2, b)
            ddb = plus(cross(al2, b), cross(w2, db))
            bias = dot3(ddu, b) + 2.0 * dot3(du, db) + dot3(u, ddb)
            store_run(ws, states * 8, (dot3(u, b), dot3(du, b) + dot3(u, db), bias))
        for side in range(2):
            body = other if side == 0 else one
            while body >= 0:
                joint, column = plan[bodies + 3 * body + 1], plan[bodies + 3 * body + 2]
                at = motion + MOTION * body
                if joint != FIXED:
                    axis = _get(ws, at, 24)
                    share = spread(0.0)
                    if kind == ALONG:
                        moved = axis
                        if joint == TURNS:
                            moved = cross(axis, minus(x2, _get(ws, at, 9)))
                        share = dot3(u, moved)
                        if side == 1:
                            # The axis turns with the first frame: a turn takes the way along.
                            share = -share
                            if joint == TURNS:
                                share = share + dot3(cross(axis, u), way)
                    elif joint == TURNS:
                        share = dot3(u, cross(axis, b)) if side == 0 else dot3(cross(axis, u), b)
                    store(ws, (row + column) * 8, load(ws, (row + column) * 8) + share)
                body = plan[bodies + 3 * body]


@inner
def _solve(ws: Any, at: int, m: int, lane: int) -> bool:
    """Solve the m equations at ``at`` of one lane, the right-hand side their last column, to that column; False if singular."""
    w = m + 1
    for k in range(m):
        best, pivot = 0.0, k
        for r in range(k, m):
            size = abs(ws[(at + r * w + k) * 8 + lane])
            if size > best:
                best, pivot = size, r
        if not best > 0.0:
            return False
        if pivot != k:
            for c in range(w):
                p, r = (at + k * w + c) * 8 + lane, (at + pivot * w + c) * 8 + lane
                kept = ws[p]
                ws[p] = ws[r]
                ws[r] = kept
        over = 1.0 / ws[(at + k * w + k) * 8 + lane]
        for r in range(k + 1, m):
            share = ws[(at + r * w + k) * 8 + lane] * over
            for c in range(k + 1, w):
                ws[(at + r * w + c) * 8 + lane] -= share * ws[(at + k * w + c) * 8 + lane]
    for k in range(m - 1, -1, -1):
        value = ws[(at + k * w + m) * 8 + lane]
        for c in range(k + 1, m):
            value -= ws[(at + k * w + c) * 8 + lane] * ws[(at + c * w + m) * 8 + lane]
        ws[(at + k * w + m) * 8 + lane] = value / ws[(at + k * w + k) * 8 + lane]
    return True


@in_place
def _resistance(laws: Any, rate: Any) -> Any:
    """What damping, dry friction and drag do against a velocity or an angular velocity as a vector."""
    damping, dry, drag = laws
    speed = square_root(dot3(rate, rate))
    return _times(-(damping + drag * speed + dry / square_root(speed * speed + ALMOST_REST * ALMOST_REST)), rate)


@inner
def _acts(ws: Any, own: int) -> bool:
    """Whether any lane has a law among the three whose numbers begin at ``own``."""
    acts = False
    for k in range(24):
        if ws[own + k] != 0.0:
            acts = True
    return acts


@inner
def act_on_groups(plan: Any, ws: Any) -> None:
    """Add to the forces what acts on turns in space and shifts in space as a whole."""
    for g in range(plan[GROUPS]):
        first, kind = plan[PLAN + 2 * g], plan[PLAN + 2 * g + 1]
        own = (plan[TAIL] + GROUP_NUMBERS * g) * 8
        if not _acts(ws, own):
            continue
        j1 = first * JOINT * 8
        j2, j3 = j1 + JOINT * 8, j1 + 2 * JOINT * 8
        one, zero = spread(1.0), spread(0.0)
        x, y, z = load(ws, j1 + QD * 8), load(ws, j2 + QD * 8), load(ws, j3 + QD * 8)
        a1, a2 = (one, zero, zero), (zero, one, zero)
        if kind == SPIN:
            sb, cb = sine_cosine(load(ws, j2 + Q * 8))
            sc, cc = sine_cosine(load(ws, j3 + Q * 8))
            a1, a2 = (cb * cc, -cb * sc, sb), (sc, cc, zero)
            x, y, z = x * a1[0] + y * a2[0], x * a1[1] + y * a2[1], x * a1[2] + z
        force = _resistance(load_run(ws, own, 3), (x, y, z))
        store(ws, j1 + TAU * 8, load(ws, j1 + TAU * 8) + dot3(a1, force))
        store(ws, j2 + TAU * 8, load(ws, j2 + TAU * 8) + dot3(a2, force))
        store(ws, j3 + TAU * 8, load(ws, j3 + TAU * 8) + force[2])


@inner
def _rub(plan: Any, ws: Any, pushed: int) -> bool:
    """Add to the forces at ``pushed`` what resists the turning of closed loops' frames, once bodies move; whether anything does."""
    here, bodies, motion = _conditions_at(plan), _bodies_at(plan), _motion_at(plan)
    any_rubs = False
    for loop in range(plan[LOOPS]):
        own = (_loop_numbers(plan) + LOOP_NUMBERS * loop + TURNING) * 8
        if not _acts(ws, own):
            continue
        any_rubs = True
        one, other = -1, -1
        for k in range(plan[CONDITIONS]):
            place = here + CONDITION_PLACES * k
            if plan[place + 3] == loop:
                one, other = plan[place + 1], plan[place + 2]
        torque = _resistance(
            load_run(ws, own, 3), minus(_of_body(ws, motion, other, 12), _of_body(ws, motion, one, 12))
        )
        for side in range(2):
            body, way = (other, 1.0) if side == 0 else (one, -1.0)
            while body >= 0:
                if plan[bodies + 3 * body + 1] == TURNS:
                    p = (pushed + plan[bodies + 3 * body + 2]) * 8
                    store(ws, p, load(ws, p) + way * dot3(_get(ws, motion + MOTION * body, 24), torque))
                body = plan[bodies + 3 * body]
    return any_rubs


@inner
def _gap(plan: Any, ws: Any, k: int, lane: int) -> float:
    """The gap of the loop that a condition is of, where it is one of a shift and has one; 0 where the condition holds."""
    place = _conditions_at(plan) + CONDITION_PLACES * k
    if plan[place] != ALONG or plan[place + 3] < 0:
        return 0.0
    return ws[(_loop_numbers(plan) + LOOP_NUMBERS * plan[place + 3]) * 8 + lane]


@in_place
def _parted(plan: Any, ws: Any, k: int) -> Any:
    """``_gap`` of all lanes."""
    place = _conditions_at(plan) + CONDITION_PLACES * k
    if plan[place] != ALONG or plan[place + 3] < 0:
        return spread(0.0)
    return load(ws, (_loop_numbers(plan) + LOOP_NUMBERS * plan[place + 3]) * 8)


@inner
def _push_back(plan: Any, ws: Any, pushed: int, lane: int) -> bool:
    """Add to the forces of a lane at ``pushed`` the contacts of loops with clearance; whether there are such loops."""
    n, states, jacobian, here = plan[COORDINATES], _states_at(plan), _jacobian_at(plan), _conditions_at(plan)
    any_open = False
    for loop in range(plan[LOOPS]):
        gap, stiffness, damping = _of_lane(ws, _loop_numbers(plan) + LOOP_NUMBERS * loop, lane)
        if not gap > 0.0:
            continue
        any_open = True
        square, along = 0.0, 0.0
        for k in range(plan[CONDITIONS]):
            place = here + CONDITION_PLACES * k
            if plan[place] == ALONG and plan[place + 3] == loop:
                s = (states + 3 * k) * 8 + lane
                square += ws[s] * ws[s]
                along += ws[s] * ws[s + 8]
        way = math.sqrt(square)
        if not way > gap:
            continue
        force = stiffness * (way - gap) + damping * along / way
        if not force > 0.0:
            continue
        for k in range(plan[CONDITIONS]):
            place = here + CONDITION_PLACES * k
            if plan[place] == ALONG and plan[place + 3] == loop:
                share = force * ws[(states + 3 * k) * 8 + lane] / way
                for i in range(n):
                    ws[(pushed + i) * 8 + lane] -= share * ws[(jacobian + n * k + i) * 8 + lane]
    return any_open


@inner
def accelerations(
    plan: Any, tree: int, nodes: int, flags: int, constants: int, beams: int, laws: int, work: int, dry: Any, limits: Any,
    ws: Any, user: int, shaken: int, loaded: int,
) -> None:  # fmt: skip
    """Accelerations of eight copies, to their places in the workspace; dry: flags of the coordinates' laws; limits: these laws.

    The other arrays are addresses, as the tree's recursion takes them.
    """
    n, m = plan[COORDINATES], plan[CONDITIONS]
    kept = _kept_at(plan)
    modes, ways, found, response = kept + n, kept + 2 * n, kept + 3 * n, kept + 4 * n
    for i in range(n):
        store(ws, (kept + i) * 8, load(ws, (i * JOINT + TAU) * 8))
    act_on_groups(plan, ws)
    if m == 0:
        call_recursion(plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded)
        for i in range(n):
            store(ws, (i * JOINT + TAU) * 8, load(ws, (kept + i) * 8))
        return
    pushed = response + n
    for i in range(n):
        store(ws, (pushed + i) * 8, load(ws, (i * JOINT + TAU) * 8))
    # Friction that holds a mechanism of one degree of freedom is told once the others' forces are known.
    held_together = 0
    if plan[DEGREES] == 1:
        for i in range(n):
            if dry[i] & law.HAS_DRY:
                for lane in range(8):
                    if ws[(i * JOINT + FREE) * 8 + lane] == 0.0:
                        held_together = 1
    shared = plan[DEGREES] > 1 and _let_go(ws, dry, limits, n, modes, ways)
    if held_together:
        for i in range(n):
            j = i * JOINT * 8
            store(ws, (modes + i) * 8, load(ws, j + FREE * 8))
            store(ws, (ways + i) * 8, load(ws, j + DIRECTION * 8))
        for lane in range(8):
            if _is_held(plan, ws, dry, modes, lane):
                for i in range(n):
                    if dry[i] & law.HAS_DRY:
                        ws[(i * JOINT + FREE) * 8 + lane] = 1.0
                        ws[(i * JOINT + DIRECTION) * 8 + lane] = 0.0
    move_bodies(plan, ws)
    measure_conditions(plan, ws)
    parted = False
    for lane in range(8):
        if _push_back(plan, ws, pushed, lane):
            parted = True
    if _rub(plan, ws, pushed) or parted:
        for i in range(n):
            store(ws, (i * JOINT + TAU) * 8, load(ws, (pushed + i) * 8))
    jacobian, answers, equations, states = _jacobian_at(plan), _answers_at(plan), _system_at(plan), _states_at(plan)
    call_recursion(plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded)
    for i in range(n):
        store(ws, (found + i) * 8, load(ws, (i * JOINT + QDD) * 8))
    for k in range(m):
        for i in range(n):
            push = load(ws, (pushed + i) * 8) + load(ws, (jacobian + n * k + i) * 8)
            store(ws, (i * JOINT + TAU) * 8, push)
        call_recursion(plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded)
        for i in range(n):
            answer = load(ws, (i * JOINT + QDD) * 8) - load(ws, (found + i) * 8)
            store(ws, (answers + n * k + i) * 8, answer)
    _eliminate(plan, ws, found, jacobian, answers, equations, states)
    if (plan[DEGREES] > 1 or parted) and _any_sticks(ws, dry, n):
        # They are held against the constraint forces, too.
        for i in range(n):
            push = load(ws, (pushed + i) * 8)
            for k in range(m):
                push = push + load(ws, (equations + k * (m + 1) + m) * 8) * load(ws, (jacobian + n * k + i) * 8)
            store(ws, (i * JOINT + TAU) * 8, push)
        call_recursion(plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded)
    if held_together:
        # How the mechanism answers a force at its leading coordinate.
        leading = plan[LEADING]
        for i in range(n):
            push = load(ws, (pushed + i) * 8)
            store(ws, (i * JOINT + TAU) * 8, push + 1.0 if i == leading else push)
        call_recursion(plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded)
        for i in range(n):
            store(ws, (response + i) * 8, load(ws, (i * JOINT + QDD) * 8))
        _eliminate(plan, ws, response, jacobian, answers, equations, states)
        for i in range(n):
            store(ws, (response + i) * 8, load(ws, (response + i) * 8) - load(ws, (found + i) * 8))
        for lane in range(8):
            if _is_held(plan, ws, dry, modes, lane):
                _hold(plan, ws, dry, found, response, lane)
        for i in range(n):
            j = i * JOINT * 8
            store(ws, j + FREE * 8, load(ws, (modes + i) * 8))
            store(ws, j + DIRECTION * 8, load(ws, (ways + i) * 8))
    if shared:
        forces = pushed + n
        for f in range(n):
            if dry[f] & law.HAS_DRY:
                own = forces + n + n * f
                for i in range(n):
                    push = load(ws, (pushed + i) * 8)
                    store(ws, (i * JOINT + TAU) * 8, push + 1.0 if i == f else push)
                call_recursion(
                    plan[RECURSION], tree, nodes, flags, constants, beams, laws, work, n, user, shaken, loaded
                )
                for i in range(n):
                    store(ws, (own + i) * 8, load(ws, (i * JOINT + QDD) * 8))
                _eliminate(plan, ws, own, jacobian, answers, equations, states)
                for i in range(n):
                    store(ws, (own + i) * 8, load(ws, (own + i) * 8) - load(ws, (found + i) * 8))
        for lane in range(8):
            if _sticks(ws, dry, n, modes, lane) and _rubs_at_several(limits, n, lane):
                _share(ws, dry, limits, n, modes, found, forces, lane)
        for i in range(n):
            j = i * JOINT * 8
            store(ws, j + FREE * 8, load(ws, (modes + i) * 8))
            store(ws, j + DIRECTION * 8, load(ws, (ways + i) * 8))
    for i in range(n):
        store(ws, (i * JOINT + QDD) * 8, load(ws, (found + i) * 8))
        store(ws, (i * JOINT + TAU) * 8, load(ws, (kept + i) * 8))


@inner
def _sticks(ws: Any, dry: Any, n: int, modes: int, lane: int) -> bool:
    """Whether any joint of a lane sticks; modes: where the modes of all are kept."""
    for i in range(n):  # noqa: SIM110 - a generator is not compiled
        if dry[i] & law.HAS_DRY and ws[(modes + i) * 8 + lane] == 0.0:
            return True
    return False


@inner
def _rubs_at_several(laws: Any, n: int, lane: int) -> bool:
    """Whether several joints of a lane have dry friction that sticks."""
    count = 0
    for i in range(n):
        if law.terms_in_use(laws, i * law.WIDTH * 8 + lane, 8) & law.HAS_DRY:
            count += 1
    return count > 1


@inner
def _let_go(ws: Any, dry: Any, laws: Any, n: int, modes: int, ways: int) -> bool:
    """Keep the modes of all joints, and let go those that stick in lanes where several joints rub; whether there are any."""
    several = 0
    for i in range(n):
        if dry[i] & law.HAS_DRY:
            several += 1
    if several < 2:
        return False
    for i in range(n):
        j = i * JOINT * 8
        store(ws, (modes + i) * 8, load(ws, j + FREE * 8))
        store(ws, (ways + i) * 8, load(ws, j + DIRECTION * 8))
    found = False
    for lane in range(8):
        if _sticks(ws, dry, n, modes, lane) and _rubs_at_several(laws, n, lane):
            found = True
            for i in range(n):
                if dry[i] & law.HAS_DRY and ws[(modes + i) * 8 + lane] == 0.0:
                    ws[(i * JOINT + FREE) * 8 + lane] = 1.0
                    ws[(i * JOINT + DIRECTION) * 8 + lane] = 0.0
    return found


@inner
def _share(ws: Any, dry: Any, laws: Any, n: int, modes: int, found: int, forces: int, lane: int) -> None:
    """What holds the joints of a lane that stick, and its accelerations at ``found``, in place.

    Behind the vector of forces stand the answers of all coordinates to a force at each. What cannot move while others stick, which
    a factorisation of the answers tells, is held with them, whatever way it is taken to slide.
    """
    answers = forces + n
    rest = (answers + n * n) * 8 + lane
    held = rest + n * n * 8
    for i in range(n):
        ws[held + i * 8] = 0.0
        for k in range(n):
            ws[rest + (n * i + k) * 8] = ws[(answers + n * i + k) * 8 + lane] if dry[i] & law.HAS_DRY else 0.0
    # Joints that stick are taken out one after the other: what is left of the others' answers is how they move beside them.
    for s in range(n):
        if not (dry[s] & law.HAS_DRY and ws[(modes + s) * 8 + lane] == 0.0):
            continue
        pivot = ws[rest + (n * s + s) * 8]
        if not pivot > STUCK * ws[(answers + n * s + s) * 8 + lane]:
            continue
        for i in range(n):
            if i != s and dry[i] & law.HAS_DRY:
                share = ws[rest + (n * i + s) * 8] / pivot
                for k in range(n):
                    if k != s:
                        ws[rest + (n * i + k) * 8] -= share * ws[rest + (n * s + k) * 8]
                ws[rest + (n * i + s) * 8] = 0.0
        for k in range(n):
            ws[rest + (n * s + k) * 8] = 0.0
    for i in range(n):
        ws[(forces + i) * 8 + lane] = 0.0
        j = i * JOINT * 8 + lane
        limit = ws[j + LIMIT * 8]
        if not (dry[i] & law.HAS_DRY and limit > 0.0):
            continue
        own = ws[(answers + n * i + i) * 8 + lane]
        sticks = ws[(modes + i) * 8 + lane] == 0.0
        if not sticks and ws[rest + (n * i + i) * 8] > STUCK * own:
            continue
        ws[held + i * 8] = 1.0
        if not sticks:
            # It does not slide: its friction is for the programme to say.
            against = ws[j + DIRECTION * 8] * limit
            for k in range(n):
                ws[(found + k) * 8 + lane] += against * ws[(answers + n * i + k) * 8 + lane]
    for _ in range(SWEEPS):
        moved = 0.0
        for i in range(n):
            if ws[held + i * 8] == 0.0:
                continue
            limit = ws[(i * JOINT + LIMIT) * 8 + lane]
            before = ws[(forces + i) * 8 + lane]
            asked = before - ws[(found + i) * 8 + lane] / ws[(answers + n * i + i) * 8 + lane]
            now = min(max(asked, -limit), limit)
            ws[(forces + i) * 8 + lane] = now
            moved = max(moved, abs(now - before) / limit)
            for k in range(n):
                ws[(found + k) * 8 + lane] += (now - before) * ws[(answers + n * i + k) * 8 + lane]
        if not moved > 0.1 * law.ALMOST:
            break
    for i in range(n):
        if ws[held + i * 8] == 0.0:
            continue
        j = i * JOINT * 8 + lane
        left = ws[(found + i) * 8 + lane] / ws[(answers + n * i + i) * 8 + lane]
        # Beyond what it can bear by the force that would still hold it.
        ws[j + HOLD * 8] = ws[(forces + i) * 8 + lane] - left
        if abs(left) <= law.ALMOST * ws[j + LIMIT * 8]:
            ws[j + HOLD * 8] = ws[(forces + i) * 8 + lane]
            ws[(found + i) * 8 + lane] = 0.0
            if ws[(modes + i) * 8 + lane] != 0.0 and abs(ws[j + QD * 8]) < RESTING:
                ws[j + HOLD * 8] = RESTS


@inner
def _is_held(plan: Any, ws: Any, dry: Any, modes: int, lane: int) -> bool:
    """Whether any joint of a lane sticks."""
    for k in range(plan[CONDITIONS]):
        # With clearance, joints stick each by itself.
        if _gap(plan, ws, k, lane) > 0.0:
            return False
    for i in range(plan[COORDINATES]):  # noqa: SIM110 - a generator is not compiled
        if dry[i] & law.HAS_DRY and ws[(modes + i) * 8 + lane] == 0.0:
            return True
    return False


@inner
def _any_sticks(ws: Any, dry: Any, n: int) -> bool:
    """Whether dry friction holds, or is soft and has to know the forces, at any joint of any lane."""
    for i in range(n):
        if dry[i] & (law.HAS_SOFT | law.HAS_LOAD):
            return True
        if dry[i] & law.HAS_DRY:
            for lane in range(8):
                if ws[(i * JOINT + FREE) * 8 + lane] == 0.0:
                    return True
    return False


@inner
def _eliminate(plan: Any, ws: Any, found: int, jacobian: int, answers: int, equations: int, states: int) -> None:
    """Accelerations at ``found`` with the constraint forces that they ask for, in place.

    The equations are symmetric and positive: no rows change places. Where conditions depend on one another, nothing finite is left.
    """
    n, m, w = plan[COORDINATES], plan[CONDITIONS], plan[CONDITIONS] + 1
    for r in range(m):
        value, rate, bias = load_run(ws, (states + 3 * r) * 8, 3)
        # A critically damped return to where the condition is closed.
        right = -bias - (2.0 * KEPT_BY * rate + KEPT_BY * KEPT_BY * value)
        for i in range(n):
            right = right - load(ws, (jacobian + n * r + i) * 8) * load(ws, (found + i) * 8)
        apart = _parted(plan, ws, r)
        store(ws, (equations + r * w + m) * 8, choose(apart, 0.0, right))
        for c in range(m):
            total = spread(0.0)
            for i in range(n):
                total = total + load(ws, (jacobian + n * r + i) * 8) * load(ws, (answers + n * c + i) * 8)
            # What has clearance says nothing.
            total = choose(apart + _parted(plan, ws, c), 1.0 if r == c else 0.0, total)
            store(ws, (equations + r * w + c) * 8, total)
    for k in range(m):
        over = 1.0 / load(ws, (equations + k * w + k) * 8)
        for r in range(k + 1, m):
            share = load(ws, (equations + r * w + k) * 8) * over
            for c in range(k + 1, w):
                p = (equations + r * w + c) * 8
                store(ws, p, load(ws, p) - share * load(ws, (equations + k * w + c) * 8))
    for k in range(m - 1, -1, -1):
        value = load(ws, (equations + k * w + m) * 8)
        for c in range(k + 1, m):
            value = value - load(ws, (equations + k * w + c) * 8) * load(ws, (equations + c * w + m) * 8)
        store(ws, (equations + k * w + m) * 8, value / load(ws, (equations + k * w + k) * 8))
    for i in range(n):
        total = load(ws, (found + i) * 8)
        for r in range(m):
            total = total + load(ws, (equations + r * w + m) * 8) * load(ws, (answers + n * r + i) * 8)
        store(ws, (found + i) * 8, total)


@inner
def _hold(plan: Any, ws: Any, dry: Any, found: int, response: int, lane: int) -> None:
    """A lane that dry friction holds: how much of what it can bear is asked of it, shared alike by its joints."""
    n = plan[COORDINATES]
    mobility = ws[(response + plan[LEADING]) * 8 + lane]
    asked = ws[(found + plan[LEADING]) * 8 + lane]
    most = 0.0
    for i in range(n):
        if dry[i] & law.HAS_DRY:
            most += abs(ws[(response + i) * 8 + lane]) * ws[(i * JOINT + LIMIT) * 8 + lane]
    for i in range(n):
        if dry[i] & law.HAS_DRY:
            j = i * JOINT * 8 + lane
            limit = ws[j + LIMIT * 8]
            share = abs(asked) / most * limit if most > 0.0 else abs(asked / mobility)
            # It would move this way, and what holds it acts the other.
            way = asked * ws[(response + i) * 8 + lane] * mobility
            ws[j + HOLD * 8] = -share if way > 0.0 else share
    for i in range(n):
        ws[(found + i) * 8 + lane] = 0.0


@lane_stepper
def close_states(
    rows: Any, states: Any, plan: Any, sizes: Any, size: int, stated: Any, dependent: Any, kept: Any, following: Any,
    length: float, near: float,
) -> None:  # fmt: skip
    """Close positions and rates of states (B, 2 n) of rows (B, P) in place, independent coordinates as they are.

    size: vectors of the workspace. stated: a closed position (n,), from where others are reached by and by; dependent: the
    coordinates that follow, as many as there are conditions; kept, following: the conditions that still hold where loops with
    clearance are within it, and the coordinates that follow by these. length: of the mechanism [m]. near: of that length or in
    radians, within which a state is closed from where it is. What cannot be closed becomes nan.
    """
    n, whole = plan[COORDINATES], plan[CONDITIONS]
    ws = vectors(size)
    states_at, jacobian, equations = _states_at(plan), _jacobian_at(plan), _system_at(plan)
    free = vectors(n)
    for b in range(len(rows)):
        for c in range(sizes[2]):
            ws[(sizes[3] + c) * 8] = rows[b, sizes[4] + c]
        for i in range(n):
            ws[(i * JOINT + Q) * 8] = states[b, i]
            ws[(i * JOINT + QD) * 8] = states[b, n + i]
        move_bodies(plan, ws)
        measure_conditions(plan, ws)
        within = True
        for k in range(whole):
            opening, gap = abs(ws[(states_at + 3 * k) * 8]), _gap(plan, ws, k, 0)
            # Within a gap, and a little beyond where a contact gives, frames may be apart.
            within = within and (gap == 0.0 or opening < WITHIN * gap + YIELDS * length)
        m = len(kept) if within else whole
        led = following if within else dependent
        if m == 0:
            continue
        for i in range(n):
            free[i] = 1.0
        open_by = 0.0
        for k in range(m):
            free[led[k]] = 0.0
            own = kept[k] if within else k
            open_by = max(open_by, abs(ws[(states_at + 3 * own) * 8]) / length)
        paces = 1
        if not open_by < near:
            farthest = 0.0
            for i in range(n):
                if free[i] != 0.0:
                    farthest = max(farthest, abs(states[b, i] - stated[i]))
                ws[(i * JOINT + Q) * 8] = stated[i]
            paces = 1 + int(min(farthest / PACE, 1e4)) if farthest >= 0.0 else 1
        closed = True
        for pace in range(1, paces + 1):
            for i in range(n):
                if free[i] != 0.0:
                    there = states[b, i]
                    ws[(i * JOINT + Q) * 8] = there if pace == paces else stated[i] + (there - stated[i]) * pace / paces
            closed = False
            for _ in range(20):
                move_bodies(plan, ws)
                measure_conditions(plan, ws)
                for k in range(m):
                    own = kept[k] if within else k
                    for c in range(m):
                        ws[(equations + k * (m + 1) + c) * 8] = ws[(jacobian + n * own + led[c]) * 8]
                    ws[(equations + k * (m + 1) + m) * 8] = -ws[(states_at + 3 * own) * 8]
                if not _solve(ws, equations, m, 0):
                    break
                step = 0.0
                for k in range(m):
                    step = max(step, abs(ws[(equations + k * (m + 1) + m) * 8]))
                if not step < 1e6:
                    break
                share = 0.5 / step if step > 0.5 else 1.0
                for k in range(m):
                    ws[(led[k] * JOINT + Q) * 8] += share * ws[(equations + k * (m + 1) + m) * 8]
                if step < CLOSED:
                    closed = True
                    break
                closed = step < 1e-9
            if not closed:
                break
        move_bodies(plan, ws)
        measure_conditions(plan, ws)
        for k in range(m):
            own = kept[k] if within else k
            right = 0.0
            for i in range(n):
                if free[i] != 0.0:
                    right -= ws[(jacobian + n * own + i) * 8] * states[b, n + i]
            for c in range(m):
                ws[(equations + k * (m + 1) + c) * 8] = ws[(jacobian + n * own + led[c]) * 8]
            ws[(equations + k * (m + 1) + m) * 8] = right
        solved = closed and _solve(ws, equations, m, 0)
        for k in range(m):
            i = led[k]
            states[b, i] = ws[(i * JOINT + Q) * 8] if solved else math.nan
            states[b, n + i] = ws[(equations + k * (m + 1) + m) * 8] if solved else math.nan
