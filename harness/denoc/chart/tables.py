"""What the chart's kernels read: where each lowered coordinate comes from, and where the balls are.

``places`` (integers): counts, then by lowered coordinate the position it is (-1: an angle of a ball), then by position the
velocity that is its rate (-1: part of a quaternion), then four of each ball. ``numbers`` (floats): by lowered coordinate factor
and shift, then 19 of each ball, then the rates' matrix (m, n), then workspace.
"""

from __future__ import annotations

import numpy as np

from harness.denoc.recursion.rows import FIRST, PLACE
from harness.denoc.recursion.tree import Array, Integers, Tree
from harness.system import System
from harness.system.lowering import Lowered, position_of_rate
from harness.system.rotation import along_z

# Counts, at the head of ``places``.
POSITIONS, VELOCITIES, LOWERED, BALLS = range(4)
HEAD = 4
# Of a ball, in ``places``: where its quaternion begins, its first lowered coordinate, the row of that body, its first velocity.
QUATERNION, COORDINATE, ROW, VELOCITY = range(4)
BALL_PLACES = 4
# Of a ball, in ``numbers``: rotation of its joint frame in the parent body's axes (9), axes of its first body in the joint's (9),
# armature.
FRAME, AXES, ARMATURE = 0, 9, 18
BALL_NUMBERS = 19


def tables(system: System, lowered: Lowered, tree: Tree) -> tuple[Integers, Array]:
    """Places and numbers of a system whose lowered form is compiled to ``tree``."""
    m, n, nq = len(lowered.take), system.nv, system.nq
    rate_of = np.full(nq, -1)
    for velocity, position in enumerate(position_of_rate(system)):
        if position >= 0:
            rate_of[position] = velocity
    balls: list[int] = []
    ball_numbers: list[Array] = []
    for quaternion, first in lowered.balls:
        row = int(np.flatnonzero(tree.topology[1:, FIRST] == first)[0]) + 1
        velocity = int(np.flatnonzero(lowered.rates[first])[0])
        balls += [int(quaternion), int(first), row, velocity]
        # The first turn is about the joint frame's x: its body's axes are a constant rotation of the joint's.
        axes = along_z([1.0, 0.0, 0.0])
        frame = tree.rows[row, PLACE : PLACE + 9].reshape(3, 3) @ axes.T
        ball_numbers.append(np.concatenate([frame.ravel(), axes.ravel(), [tree.joints[row - 1].armature]]))
    places = np.array([nq, n, m, len(lowered.balls), *lowered.take, *rate_of, *balls], dtype=np.int64)
    work = 6 * m + 4 * n + m * m + n * n + m * n
    numbers = np.concatenate([lowered.factor, lowered.shift, *ball_numbers, lowered.rates.ravel(), np.zeros(work)])
    return places, np.ascontiguousarray(numbers)
