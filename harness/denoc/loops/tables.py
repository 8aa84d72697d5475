"""What the kernels of loops read and write: one array of integers and one of floats for a model.

``places``: the head, then two bodies a loop, then five integers a condition, then four a coupling. ``numbers``: the mechanism's
size, then two frames a loop (rotation and origin in body axes), a sign a condition, five coefficients a coupling, then workspace.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.denoc.recursion.tree import Array, Integers, Seat
from harness.system import Coupling, Frame, Loop, System
from harness.system.closure import coordinate, size
from harness.system.loop import SHIFTS, turn_pairs

# Head of ``places``. RANK: number of independent conditions in general. COLUMNS: not 0 where the mass matrix is made column by
# column.
LOOPS, CONDITIONS, COUPLINGS, N, NQ, RANK, COLUMNS = range(7)
HEAD = 7
# Of a condition: kind, number of its loop or coupling, axis of the first frame, axis of the second.
KIND, OF, AXIS, OTHER = range(4)
CONDITION = 4
SHIFT, TURN_AWAY, COUPLED = range(3)
# Of a coupling: places of position and velocity, and of those of its leader (-1: none).
COUPLING = 4

FRAME = 12  # rotation (9) and origin (3) of a frame in body axes
# Of a frame in base axes, in the workspace: rotation (9), origin (3), spin and velocity (6), angular and linear acceleration (6).
ROTATION, ORIGIN, TWIST, RATE = 0, 9, 12, 18
MOVING = 24
# Of a condition in the workspace: how far it is open, rate, acceleration, then what it weighs on both frames' twists: moment and
# force on the first (6) and on the second (6).
VALUE, VELOCITY, ACCELERATION, FIRST, SECOND = 0, 1, 2, 3, 9
STATE = 15


def tables(
    system: System, seats: Mapping[str, Seat], names: Mapping[Frame, str], rank: int, columns: bool
) -> tuple[Integers, Array]:
    """Places and numbers of the loops of a system; names: the link whose seat each frame has."""
    loops = [loop for loop in system.loops if isinstance(loop, Loop)]
    couplings = [loop for loop in system.loops if isinstance(loop, Coupling)]
    frames: list[float] = []
    bodies: list[int] = []
    for loop in loops:
        for frame in (loop.first, loop.second):
            seat = seats[names[frame]]
            carried = names[frame] != frame.link
            xyz, rotation = (np.zeros(3), np.eye(3)) if carried else (np.asarray(frame.xyz), np.asarray(frame.rotation))
            bodies.append(seat.body)
            frames += [*(seat.rotation @ rotation).ravel(), *(seat.origin + seat.rotation @ xyz)]
    conditions: list[int] = []
    signs: list[float] = []
    for k, loop in enumerate(loops):
        for motion in loop.conditions:
            if motion in SHIFTS:
                conditions += [SHIFT, k, SHIFTS.index(motion), 0]
                signs.append(1.0)
            else:
                i, j, sign = turn_pairs(loop.closed)[motion]
                conditions += [TURN_AWAY, k, i, j]
                signs.append(sign)
    led: list[int] = []
    terms: list[float] = []
    for k, coupling in enumerate(couplings):
        conditions += [COUPLED, k, 0, 0]
        signs.append(1.0)
        leader = (-1, -1) if coupling.leader is None else coordinate(system, coupling.leader)
        led += [*coordinate(system, coupling.joint), *leader]
        terms += coupling.coefficients
    c, n = len(signs), system.nv
    head = [len(loops), c, len(couplings), n, system.nq, rank, int(columns)]
    places = np.array([*head, *bodies, *conditions, *led], dtype=np.int64)
    numbers = np.array([size(system), *frames, *signs, *terms])
    return places, np.concatenate([numbers, np.zeros(workspace(len(loops), c, n, system.nq))])


def workspace(loops: int, c: int, n: int, nq: int) -> int:
    """Numbers of workspace: frames, conditions, rows and their copy, twists of frames by velocity, mass matrix, vectors, lists."""
    return 2 * loops * MOVING + c * STATE + 2 * c * (n + 1) + 12 * loops * n + n * n + 6 * n + nq + n + c
