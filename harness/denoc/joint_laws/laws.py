"""Everything that acts at a joint, as one compiled law with a fixed row of parameter slots; zero switches a term off.

Generalized force on the joint, on the right-hand side of the equations of motion, with v = joint velocity::

    + constant_torque + cogging_amplitude · sin(cogging_periods · q + cogging_phase)
    − damping · v − quadratic_drag · v |v| − cubic_damping · v³
    − stiffness · (q − rest_angle) − cubic_stiffness · q³
    − polynomial_square · x² − polynomial_cube · x³,   x = q − polynomial_rest
    − dry(v),   |dry| = F_c + (F_s − F_c) exp(−(v / v_s)²) + mu_radius · R     while it slides
                |dry| ≤ max(F_s, F_c) + mu_radius · R                          while it sticks
      or, where creep_velocity v_c > 0, dry(v) = |dry| tanh(v / v_c) at any speed: it never sticks
      or, where soft_time τ > 0, dry(v) = soft_inertia (v̇ + v / τ), within ± |dry|: a soft constraint
    − f,   df/dq = dahl_stiffness (1 − sign(v) · f / dahl_torque): between reversals f approaches ± dahl_torque
           exponentially in the distance travelled since the last one, and is evaluated so
    − contact,  contact = k δ + d dδ/dt + J d²δ/dt² where that pushes, δ = how far the joint is beyond the stop
    + user_scale · user(q, v, t, user_1 … user_4)

R is the magnitude of the force that the joint transmits across its axis (the reaction, which depends on the
accelerations and so on the friction itself; solved to a fixed point). A stop lies at ``stop_angle`` and bounds the
side its sign points to; where ``stop_both`` is 1 it bounds the greater positions whatever its sign, a like one at ``stop_lower``
the lesser, and the joint has to do with the one on whose side of the middle between them it is.
``armature`` is inertia about the axis (the paper's hub inertia I_h).

Sources: Stribeck's law in the exponential form of Bo and Pavelescu (Wear 82, 1982); P. Dahl, A solid friction
model (Aerospace Corporation TOR-0158, 1968); the one-sided spring-damper stop that only pushes is the compliant
contact of Kelvin and Voigt with adhesion cut off; with an inertia J it is MuJoCo's soft constraint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from harness.denoc.simd.vector import choose, exponential, in_place, inner, load, magnitude, sine_cosine


@dataclass(frozen=True)
class Slot:
    """One parameter of a lane row: its name, SI unit (of a revolute joint) and meaning."""

    name: str
    unit: str
    meaning: str


SLOTS = (
    Slot("armature", "kg·m²", "inertia about the joint axis, hub inertia"),
    Slot("damping", "N·m·s/rad", "viscous coefficient"),
    Slot("coulomb_torque", "N·m", "dry friction at speed"),
    Slot("static_torque", "N·m", "dry friction at rest; below coulomb_torque it counts as equal to it"),
    Slot("stribeck_velocity", "rad/s", "speed over which static falls to Coulomb friction"),
    Slot("quadratic_drag", "N·m·s²/rad²", "drag torque over v |v|"),
    Slot("mu_radius", "m", "friction coefficient times bearing radius; prismatic: friction coefficient [1]"),
    Slot("creep_velocity", "rad/s", "speed under which dry friction gives way instead of sticking; 0 where it sticks"),
    Slot("soft_time", "s", "time by which soft dry friction turns round before its joint does; 0 where it is not soft"),
    Slot("soft_inertia", "kg·m²", "inertia that soft dry friction adds while it holds"),
    Slot("dahl_torque", "N·m", "level that Dahl friction saturates at"),
    Slot("dahl_stiffness", "N·m/rad", "Dahl friction's initial stiffness"),
    Slot("stiffness", "N·m/rad", "linear spring"),
    Slot("rest_angle", "rad", "where the linear spring is slack"),
    Slot("cubic_stiffness", "N·m/rad³", "spring torque over q³"),
    Slot("cubic_damping", "N·m·s³/rad³", "damping torque over v³"),
    Slot(
        "polynomial_square", "N·m/rad²", "spring torque over the square of the distance from polynomial_rest: one-sided"
    ),
    Slot("polynomial_cube", "N·m/rad³", "spring torque over its cube"),
    Slot("polynomial_rest", "rad", "where that spring is slack"),
    Slot("constant_torque", "N·m", "constant torque along the positive axis"),
    Slot("cogging_amplitude", "N·m", "amplitude of the torque periodic in the angle"),
    Slot("cogging_periods", "1/rev", "its periods in a revolution"),
    Slot("cogging_phase", "rad", "its phase at q = 0"),
    Slot("stop_angle", "rad", "where a stop begins; its sign tells the side it bounds"),
    Slot("stop_stiffness", "N·m/rad", "stiffness of the stop"),
    Slot("stop_damping", "N·m·s/rad", "damping of the stop; a stop pushes and never pulls"),
    Slot("stop_inertia", "kg·m²", "inertia that the stop adds to the joint's while it pushes"),
    Slot(
        "stop_both",
        "1",
        "1 where the joint has a stop at either end of its range, at stop_angle and stop_lower; else 0",
    ),
    Slot("stop_lower", "rad", "where the stop at the lower end begins"),
    Slot("user_scale", "1", "factor on the user's own law"),
    Slot("user_1", "SI", "first parameter of the user's own law"),
    Slot("user_2", "SI", "second parameter of the user's own law"),
    Slot("user_3", "SI", "third parameter of the user's own law"),
    Slot("user_4", "SI", "fourth parameter of the user's own law"),
)
SLOT_NAMES = tuple(slot.name for slot in SLOTS)
WIDTH = len(SLOTS)

ARMATURE = SLOT_NAMES.index("armature")
DAMPING = SLOT_NAMES.index("damping")
COULOMB = SLOT_NAMES.index("coulomb_torque")
STATIC = SLOT_NAMES.index("static_torque")
STRIBECK = SLOT_NAMES.index("stribeck_velocity")
DRAG = SLOT_NAMES.index("quadratic_drag")
MU_RADIUS = SLOT_NAMES.index("mu_radius")
CREEP = SLOT_NAMES.index("creep_velocity")
SOFT_TIME = SLOT_NAMES.index("soft_time")
SOFT_INERTIA = SLOT_NAMES.index("soft_inertia")
DAHL_TORQUE = SLOT_NAMES.index("dahl_torque")
DAHL_STIFFNESS = SLOT_NAMES.index("dahl_stiffness")
STIFFNESS = SLOT_NAMES.index("stiffness")
REST = SLOT_NAMES.index("rest_angle")
CUBIC = SLOT_NAMES.index("cubic_stiffness")
CUBIC_DAMPING = SLOT_NAMES.index("cubic_damping")
SQUARE = SLOT_NAMES.index("polynomial_square")
CUBE = SLOT_NAMES.index("polynomial_cube")
SLACK = SLOT_NAMES.index("polynomial_rest")
CONSTANT = SLOT_NAMES.index("constant_torque")
COGGING_AMPLITUDE = SLOT_NAMES.index("cogging_amplitude")
COGGING_PERIODS = SLOT_NAMES.index("cogging_periods")
COGGING_PHASE = SLOT_NAMES.index("cogging_phase")
STOP_ANGLE = SLOT_NAMES.index("stop_angle")
STOP_STIFFNESS = SLOT_NAMES.index("stop_stiffness")
STOP_DAMPING = SLOT_NAMES.index("stop_damping")
STOP_INERTIA = SLOT_NAMES.index("stop_inertia")
STOP_BOTH = SLOT_NAMES.index("stop_both")
STOP_LOWER = SLOT_NAMES.index("stop_lower")
USER_SCALE = SLOT_NAMES.index("user_scale")
USER_1 = SLOT_NAMES.index("user_1")

# Which terms any lane of a group uses; the others are skipped. A skipped term is exactly zero in every lane.
HAS_DRY, HAS_STRIBECK, HAS_LOAD, HAS_DAHL, HAS_COGGING, HAS_STOP, HAS_USER, HAS_SIGN = 1, 2, 4, 8, 16, 32, 64, 128
HAS_POLYNOMIAL = 1024
HAS_CREEP, HAS_SOFT = 256, 512  # dry friction that gives way, and as a soft constraint; HAS_DRY is the one that sticks
RUBS = HAS_DRY | HAS_CREEP | HAS_SOFT
ALMOST = 1e-9  # relative slack between holding and breaking loose, so that rounding cannot make them alternate


@inner
def terms_in_use(parameters: Any, start: int, stride: int) -> int:
    """Bit set (HAS_…) of the terms that one joint's slots switch on."""
    flags = 0
    coulomb = parameters[start + COULOMB * stride]
    static = parameters[start + STATIC * stride]
    if coulomb != 0.0 or static != 0.0 or parameters[start + MU_RADIUS * stride] != 0.0:
        if parameters[start + SOFT_TIME * stride] > 0.0:
            flags |= HAS_SOFT
        elif parameters[start + CREEP * stride] > 0.0:
            flags |= HAS_CREEP
        else:
            flags |= HAS_DRY | HAS_SIGN
    if static > coulomb:
        flags |= HAS_STRIBECK
    if parameters[start + MU_RADIUS * stride] != 0.0:
        flags |= HAS_LOAD
    if parameters[start + DAHL_TORQUE * stride] * parameters[start + DAHL_STIFFNESS * stride] > 0.0:
        flags |= HAS_DAHL | HAS_SIGN
    if parameters[start + DRAG * stride] != 0.0:
        flags |= HAS_SIGN
    if (
        parameters[start + CUBIC_DAMPING * stride] != 0.0
        or parameters[start + SQUARE * stride] != 0.0
        or parameters[start + CUBE * stride] != 0.0
    ):
        flags |= HAS_POLYNOMIAL
    if parameters[start + COGGING_AMPLITUDE * stride] != 0.0:
        flags |= HAS_COGGING
    if parameters[start + STOP_STIFFNESS * stride] != 0.0 or parameters[start + STOP_DAMPING * stride] != 0.0:
        flags |= HAS_STOP
    if parameters[start + USER_SCALE * stride] != 0.0:
        flags |= HAS_USER
    return flags


@in_place
def sliding_friction(laws: Any, start: int, flags: int, v: Any, reaction: Any) -> Any:
    """Magnitude of dry friction at velocity v, lanes of slots lying eight apart from ``start`` on."""
    level = load(laws, start + COULOMB * 8)
    if flags & HAS_STRIBECK:
        static = load(laws, start + STATIC * 8)
        speed = load(laws, start + STRIBECK * 8)
        ratio = v / choose(speed, speed, 1.0)
        # At a Stribeck velocity of zero friction falls to Coulomb's as soon as the joint moves.
        square = choose(speed, ratio * ratio, 700.0)
        extra = choose(static - level, static - level, 0.0)
        level = level + extra * exponential(-choose(700.0 - square, square, 700.0))
    if flags & HAS_LOAD:
        level = level + load(laws, start + MU_RADIUS * 8) * reaction
    return level


@in_place
def sticking_limit(laws: Any, start: int, flags: int, reaction: Any) -> Any:
    """The greatest force that dry friction can hold at rest; none where it gives way."""
    coulomb = load(laws, start + COULOMB * 8)
    static = load(laws, start + STATIC * 8)
    limit = choose(static - coulomb, static, coulomb) + load(laws, start + MU_RADIUS * 8) * reaction
    if flags & HAS_CREEP:
        limit = choose(load(laws, start + CREEP * 8), 0.0 * limit, limit)
    if flags & HAS_SOFT:
        limit = choose(load(laws, start + SOFT_TIME * 8), 0.0 * limit, limit)
    return limit


@in_place
def rubbing(laws: Any, start: int, flags: int, v: Any, direction: Any, reaction: Any, slips: Any) -> Any:
    """Dry friction against positive motion: set-valued, creeping or soft.

    direction: of sliding, where it sticks; slips: which way a soft constraint slips, 0 where it holds. What it then does with the
    acceleration is in ``axis_inertia``.
    """
    level = sliding_friction(laws, start, flags, v, reaction)
    force = level * direction
    if flags & HAS_CREEP:
        speed = load(laws, start + CREEP * 8)
        twice = 2.0 * magnitude(v) / choose(speed, speed, 1.0)
        left = exponential(-choose(700.0 - twice, twice, 700.0))
        share = (1.0 - left) / (1.0 + left)
        force = choose(speed, level * choose(v, share, -share), force)
    if flags & HAS_SOFT:
        time = load(laws, start + SOFT_TIME * 8)
        held = load(laws, start + SOFT_INERTIA * 8) / choose(time, time, 1.0) * v
        force = choose(time, choose(magnitude(slips), level * slips, held), force)
    return force


@in_place
def axis_inertia(laws: Any, start: int, flags: int, slips: Any, contact: Any) -> Any:
    """Inertia about a joint's own axis: its armature, and what soft dry friction and a stop add while they hold and push."""
    inertia = load(laws, start + ARMATURE * 8)
    if flags & HAS_SOFT:
        held = load(laws, start + SOFT_INERTIA * 8)
        held = choose(magnitude(slips), 0.0 * held, choose(load(laws, start + SOFT_TIME * 8), held, 0.0 * held))
        inertia = inertia + held
    if flags & HAS_STOP:
        inertia = inertia + load(laws, start + STOP_INERTIA * 8) * contact
    return inertia


@in_place
def slipping(laws: Any, start: int, flags: int, v: Any, vdot: Any, reaction: Any, slips: Any) -> Any:
    """Which way a soft constraint slips, given the acceleration that it had when it slipped (or held) as ``slips`` says.

    It goes from one way to the other by way of holding: so every joint by itself ends where force and motion agree.
    """
    time, inertia = load(laws, start + SOFT_TIME * 8), load(laws, start + SOFT_INERTIA * 8)
    level = sliding_friction(laws, start, flags, v, reaction)
    pull = inertia * (vdot + v / choose(time, time, 1.0))
    nothing = 0.0 * v
    from_rest = choose(pull - level, 1.0 + nothing, choose(-level - pull, nothing - 1.0, nothing))
    still = choose(slips * pull - level * (1.0 - ALMOST), slips, nothing)
    return choose(time, choose(magnitude(slips), still, from_rest), nothing)


@in_place
def passive_force(
    laws: Any,
    start: int,
    flags: int,
    q: Any,
    v: Any,
    direction: Any,
    contact: Any,
    anchor: Any,
    grip: Any,
    reaction: Any,
    slips: Any,
) -> Any:
    """All terms of the law but the user's own one, on the right-hand side.

    laws: slots lane-contiguous, eight lanes a slot; start: of the joint's slots; flags: HAS_… of the group.
    direction: +1 or −1 sliding, 0 at rest; contact: 1 while the stop pushes; anchor, grip: where the joint turned
    round last, and Dahl's friction there;
    reaction: magnitude of the reaction force across the axis; slips: see ``rubbing``.
    """
    force = (
        load(laws, start + CONSTANT * 8)
        - load(laws, start + DAMPING * 8) * v
        - load(laws, start + STIFFNESS * 8) * (q - load(laws, start + REST * 8))
        - load(laws, start + CUBIC * 8) * (q * q * q)
    )
    if flags & HAS_POLYNOMIAL:
        x = q - load(laws, start + SLACK * 8)
        force = force - load(laws, start + CUBIC_DAMPING * 8) * (v * v * v)
        force = force - (load(laws, start + SQUARE * 8) + load(laws, start + CUBE * 8) * x) * (x * x)
    if flags & HAS_SIGN:
        force = force - load(laws, start + DRAG * 8) * (v * v) * direction
    if flags & RUBS:
        force = force - rubbing(laws, start, flags, v, direction, reaction, slips)
    if flags & HAS_DAHL:
        torque = load(laws, start + DAHL_TORQUE * 8)
        stiffness = load(laws, start + DAHL_STIFFNESS * 8)
        inverse = choose(torque * stiffness, stiffness, 0.0) / choose(torque, torque, 1.0)
        level = choose(torque * stiffness, torque, 0.0) * direction
        force = force - (level - (level - grip) * exponential(-(inverse * (direction * (q - anchor)))))
    if flags & HAS_COGGING:
        s, _ = sine_cosine(load(laws, start + COGGING_PERIODS * 8) * q + load(laws, start + COGGING_PHASE * 8))
        force = force + load(laws, start + COGGING_AMPLITUDE * 8) * s
    if flags & HAS_STOP:
        angle = load(laws, start + STOP_ANGLE * 8)
        lower = load(laws, start + STOP_LOWER * 8)
        both = load(laws, start + STOP_BOTH * 8)
        towards = choose(both, 2.0 * q - angle - lower, angle)
        angle = choose(both, choose(-towards, lower, angle), angle)
        side = choose(-towards, -1.0 + 0.0 * angle, 1.0 + 0.0 * angle)
        push = load(laws, start + STOP_STIFFNESS * 8) * (side * (q - angle))
        push = push + load(laws, start + STOP_DAMPING * 8) * (side * v)
        force = force - side * push * contact
    return force


@inner
def dahl_friction(laws: Any, start: int, lane: int, q: float, direction: float, anchor: float, grip: float) -> float:
    """Dahl's friction of one lane, opposing positive motion, at a position reached in one direction from the anchor."""
    torque = laws[start + DAHL_TORQUE * 8 + lane]
    stiffness = laws[start + DAHL_STIFFNESS * 8 + lane]
    if not torque * stiffness > 0.0:
        return 0.0
    level = torque * direction
    return level - (level - grip) * math.exp(-stiffness / torque * direction * (q - anchor))


@inner
def stop_gap(laws: Any, start: int, lane: int, q: float, v: float, vdot: float) -> float:
    """Positive exactly while one lane's stop pushes: the lesser of how far the joint is beyond it and the push.

    vdot: the acceleration, in contact or out of it: the push that it leads to has the same sign either way.
    """
    angle = laws[start + STOP_ANGLE * 8 + lane]
    towards = angle
    if laws[start + STOP_BOTH * 8 + lane] > 0.0:
        lower = laws[start + STOP_LOWER * 8 + lane]
        towards = 2.0 * q - angle - lower
        if towards < 0.0:
            angle = lower
    side = -1.0 if towards < 0.0 else 1.0
    depth = side * (q - angle)
    push = laws[start + STOP_STIFFNESS * 8 + lane] * depth + laws[start + STOP_DAMPING * 8 + lane] * side * v
    return min(depth, push + laws[start + STOP_INERTIA * 8 + lane] * side * vdot)
