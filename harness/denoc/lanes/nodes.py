"""What the recursions of the lanes share, in space and in the plane: how nodes lie in the arrays, and what acts at them.

A beam's point is at (x - ½ bᵀ H b) f + (s·b) h. Everything lies in one flat array a group of eight lanes, lane-contiguous; an
offset below counts such vectors.
"""

from __future__ import annotations

import math
from typing import Any

from harness.denoc.joint_laws import laws as law
from harness.denoc.simd.vector import (
    address_of,
    call_at,
    choose,
    in_place,
    inner,
    load,
    magnitude,
    sine_cosine,
    spread,
    square_root,
    store,
)

# Kinds of node, and the columns of the integer table that describes one.
# (ABSENT: a section that carries nothing in any lane of the group, skipped.)
REVOLUTE, PRISMATIC, BEAM, SECTION, ABSENT = 0, 1, 2, 3, 4
# ROW, HEAD: where in a parameter row a section's values begin, and those of its beam.
# SIGN: 0, or, where all moves in one plane (``lanes.planar``), ±1, which way a node's axis points from it.
# PLAN: in the first row, the address of what ``lanes.closed`` adds to the tree, 0 where it adds nothing.
PARENT, KIND, PREFIX, COORDINATE, MODES, TABLE, POINTS, WORK, ROW, HEAD, SIGN, PLAN = range(12)
COLUMNS = 12

# One node's constants, in vectors of eight lanes.
R, ALPHA, DELTA, GAMMA, MASS, FIRST, SECOND = 0, 3, 5, 7, 9, 10, 13
CONSTANTS = 19
# In motion in a plane: a slide's or a beam's direction, the way a beam bends; R, MASS, FIRST and SECOND as above, in the plane.
PLANE_F, PLANE_H = 3, 5

# One node's workspace (COLUMN: of a section node, its bias acceleration).
OMEGA, VELOCITY, TURN, ANGULAR, MIXED, LINEAR, BIAS, COLUMN, FORCE, INVERSE, ACCELERATION = (
    0, 3, 6, 8, 14, 23, 29, 35, 41, 42, 43,
)  # fmt: skip
BODY = 49

# One coordinate's state and results; a mode uses Q, QD, QDD and TAU only.
Q, QD, QDD, TAU, DIRECTION, FREE, CONTACT, ANCHOR, GRIP, REACTION, HOLD, LIMIT, TAU_SLOPE, REACTION_START, SLIPS = (
    range(15)
)
# Which way soft friction slips where a step begins, and where it ends.
SLIPS_START, SLIPS_END = 15, 16
JOINT = 17
# In HOLD, of a joint that is taken to slide and cannot move beside those that stick.
RESTS = math.inf

# What the group shares: time, start of the effort's segment, base acceleration parameters, scratch.
# (SHAKE: gravity x, y, z, angular frequency, phase, amplitude along x, y, z)
TIME, TAU_TIME, SHAKE, SCRATCH = 0, 1, 2, 10
GROUP = 12


def beam_table_size(m: int, points: int) -> int:
    """Constants of a beam node: stiffness K and damping C (m, m), then points."""
    return 2 * m * m + points * point_size(m)


def point_size(m: int) -> int:
    """Values of a mass point: 1, x, s (m), H (m, m), each times the root of the mass there."""
    return 2 + m + m * m


def section_table_size(m: int) -> int:
    """Constants of a section node: x, s (m), slope (m), H (m, m)."""
    return 1 + 2 * m + m * m


def beam_work_size(m: int) -> int:
    """Workspace of a beam node: coupling N (m, 6), modal inertia A (m, m), modal bias (m)."""
    return 7 * m + m * m


def section_work_size(m: int) -> int:
    """Workspace of a section node: -(H b)_k (m)."""
    return m


@in_place
def bent(beams: Any, ws: Any, x: Any, shapes: int, curves: int, m: int, first: int, axial: int, step: int) -> Any:
    """Place (x, y) of a beam's point in the beam's axes, its rates, and the bias of its axial acceleration.

    x: place of the straight beam's; shapes, curves: where s (m) and H (m, m) of the point begin; first: state of the first mode.
    The axial parts -(H b)_k of the partial velocities are left at ``axial``, ``step`` vectors apart.
    """
    zero = spread(0.0)
    y, xd, yd, xdd = zero, zero, zero, zero
    for k in range(m):
        q = load(ws, first + (k * JOINT + Q) * 8)
        qd = load(ws, first + (k * JOINT + QD) * 8)
        s = load(beams, shapes + k * 8)
        hb, hd = zero, zero
        for l in range(m):
            h = load(beams, curves + (k * m + l) * 8)
            hb = hb + h * load(ws, first + (l * JOINT + Q) * 8)
            hd = hd + h * load(ws, first + (l * JOINT + QD) * 8)
        x = x - 0.5 * (hb * q)
        xd = xd - hb * qd
        xdd = xdd - hd * qd
        y = y + s * q
        yd = yd + s * qd
        store(ws, axial + k * step * 8, -hb)
    return x, y, xd, yd, xdd


@in_place
def bent_section(beams: Any, ws: Any, e: int, m: int, first: int, axial: int) -> Any:
    """A section's place and the rest as of ``bent``, then its turn about the beam's n and the turn's rate.

    e: constants of the section.
    """
    x, y, xd, yd, xdd = bent(beams, ws, load(beams, e), e + 8, e + (1 + 2 * m) * 8, m, first, axial, 1)
    turn, spin = spread(0.0), spread(0.0)
    for f in range(m):
        slope = load(beams, e + (1 + m + f) * 8)
        turn = turn + slope * load(ws, first + (f * JOINT + Q) * 8)
        spin = spin + slope * load(ws, first + (f * JOINT + QD) * 8)
    return x, y, xd, yd, xdd, turn, spin


@in_place
def modal_force(beams: Any, ws: Any, group: int, e: int, m: int, first: int, k: int, bias: Any) -> Any:
    """What accelerates a beam's mode k while its hub stands still: applied force less bias, stiffness and damping."""
    c = first + k * JOINT * 8
    late = load(ws, group + TIME * 8) - load(ws, group + TAU_TIME * 8)
    y = load(ws, c + TAU * 8) + load(ws, c + TAU_SLOPE * 8) * late - bias
    for l in range(m):
        y = y - load(beams, e + (k * m + l) * 8) * load(ws, first + (l * JOINT + Q) * 8)
        y = y - load(beams, e + (m * m + k * m + l) * 8) * load(ws, first + (l * JOINT + QD) * 8)
    return y


@in_place
def shaken_base(ws: Any, group: int, shaken: int) -> Any:
    """The base's acceleration, gravity being one of the base upwards, and the shaking of the base itself."""
    g = group + SHAKE * 8
    x = -load(ws, g)
    y = -load(ws, g + 8)
    z = -load(ws, g + 16)
    if shaken:
        phase = load(ws, g + 24) * load(ws, group + TIME * 8) + load(ws, g + 32)
        pulse, _ = sine_cosine(phase)
        x = x + load(ws, g + 40) * pulse
        y = y + load(ws, g + 48) * pulse
        z = z + load(ws, g + 56) * pulse
    return x, y, z


@inner
def user_forces(laws: Any, ws: Any, user: int, time: int, j: int, start: int) -> Any:
    """The user's own law, called lane by lane; eight forces in the scratch vector.

    Behind its four parameters stands the effort that is applied at the joint, which a drive keeps within its range.
    """
    scratch = time + (SCRATCH - TIME) * 8
    for lane in range(8):
        first = start + lane
        scale = laws[first + law.USER_SCALE * 8]
        value = 0.0
        if scale != 0.0 and user != 0:
            for p in range(4):
                ws[scratch + 8 + p] = laws[first + (law.USER_1 + p) * 8]
            late = ws[time + lane] - ws[time + (TAU_TIME - TIME) * 8 + lane]
            ws[scratch + 12] = ws[j + TAU * 8 + lane] + ws[j + TAU_SLOPE * 8 + lane] * late
            value = scale * call_at(
                user, ws[j + Q * 8 + lane], ws[j + QD * 8 + lane], ws[time + lane], address_of(ws, scratch + 8)
            )
        ws[scratch + lane] = value


@in_place
def joint_force(laws: Any, ws: Any, flags: int, user: int, group: int, l: int, j: int) -> Any:
    """Force along a joint: the applied one, its laws' and the user's."""
    force = load(ws, j + TAU * 8) + load(ws, j + TAU_SLOPE * 8) * (
        load(ws, group + TIME * 8) - load(ws, group + TAU_TIME * 8)
    )
    force = force + law.passive_force(
        laws,
        l,
        flags,
        load(ws, j + Q * 8),
        load(ws, j + QD * 8),
        load(ws, j + DIRECTION * 8),
        load(ws, j + CONTACT * 8),
        load(ws, j + ANCHOR * 8),
        load(ws, j + GRIP * 8),
        load(ws, j + REACTION * 8),
        load(ws, j + SLIPS * 8),
    )
    if flags & law.HAS_USER:
        user_forces(laws, ws, user, group + TIME * 8, j, l)
        force = force + load(ws, group + SCRATCH * 8)
    return force


@in_place
def in_any_lane(ws: Any, group: int, value: Any) -> float:
    """1 if a value is positive in any lane, else 0."""
    store(ws, group + SCRATCH * 8, value)
    found = 0.0
    for lane in range(8):
        if ws[group + SCRATCH * 8 + lane] > 0.0:
            found = 1.0
    return found


@in_place
def settled(laws: Any, ws: Any, group: int, l: int, update: Any, reaction: Any) -> Any:
    """A reaction's next value, and 1 if that changed in any lane whose friction depends on it."""
    change = magnitude(update - reaction) - 1e-13 * update
    # A settled lane keeps its value, so that its result does not depend on how long others iterate.
    update = choose(change, update, reaction)
    return update, in_any_lane(ws, group, choose(load(laws, l + law.MU_RADIUS * 8), change, -1.0))


@in_place
def still_slips(laws: Any, ws: Any, flags: int, group: int, l: int, j: int) -> float:
    """Renew which way soft dry friction slips; 1 if that changed in any lane."""
    slips = load(ws, j + SLIPS * 8)
    v, vdot, reaction = load(ws, j + QD * 8), load(ws, j + QDD * 8), load(ws, j + REACTION * 8)
    renewed = law.slipping(laws, l, flags, v, vdot, reaction, slips)
    store(ws, j + SLIPS * 8, renewed)
    return in_any_lane(ws, group, magnitude(renewed - slips))


@in_place
def rub(laws: Any, ws: Any, flags: int, group: int, l: int, j: int, push: Any, fx: Any, fy: Any) -> float:
    """What dry friction needs to know of a joint: the force that holds it, the greatest that friction can, the reaction.

    push: the force that is short of the joint's equation; fx, fy: reaction across the axis, read where friction depends on it.
    Returns 1 while the reaction changes, for the fixed point of load-dependent friction, or soft friction begins or ends to slip.
    """
    unsettled = 0.0
    reaction = load(ws, j + REACTION * 8)
    if flags & law.HAS_LOAD:
        reaction, unsettled = settled(laws, ws, group, l, square_root(fx * fx + fy * fy), reaction)
        store(ws, j + REACTION * 8, reaction)
    store(ws, j + HOLD * 8, push)
    store(ws, j + LIMIT * 8, law.sticking_limit(laws, l, flags, reaction))
    if flags & law.HAS_SOFT:
        unsettled = max(unsettled, still_slips(laws, ws, flags, group, l, j))
    return unsettled


@in_place
def restart_reactions(ws: Any, n: int) -> None:
    """Reactions as they were found last, for an iteration to begin with."""
    for i in range(n):
        j = i * JOINT * 8
        store(ws, j + REACTION * 8, load(ws, j + REACTION_START * 8))
