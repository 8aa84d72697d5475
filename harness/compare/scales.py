"""How large the terms are that a generalized force or an energy is the sum of, whether they cancel or not.

What is left of terms that cancel has no size of its own: a turntable's gravity torque is zero, and what an engine's rounding makes
of it is a share of weight times arm. So a difference of forces is held against the terms, never against their sum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.system import System
from harness.system.rotation import about_axis

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Terms:
    """Sums of magnitudes at one state.

    gravity: weight times arm, shape (n,) [N·m, or N of a sliding joint]. motion: inertia times velocity products, and mass times
    their acceleration times arm, shape (n,). potential: weight times distance from the origin [J].
    """

    gravity: Array
    motion: Array
    potential: float


def terms(system: System, q: Array, qd: Array) -> Terms:
    """The terms of a rigid system at positions q and velocities qd, each shape (n,).

    Arms are whole distances between a joint's origin and a centre of mass, not their shares across the axis.
    """
    n = len(q)
    fall = float(np.linalg.norm(system.gravity))
    # Of each link's frame: rotation, origin, angular velocity, velocity of the origin, accelerations with qdd = 0.
    still = np.zeros(3)
    frames = {system.base: (np.eye(3), still, still, still, still)}
    carried: dict[str, tuple[tuple[int, Array, bool], ...]] = {system.base: ()}
    gravity, motion, potential = np.zeros(n), np.zeros(n), 0.0
    k = 0
    for joint, link in zip(system.joints, system.links, strict=True):
        turn, origin, omega, alpha, acceleration = frames[joint.parent]
        place = turn @ joint.xyz
        # Of a point fixed to the parent.
        acceleration = acceleration + np.cross(alpha, place) + np.cross(omega, np.cross(omega, place))
        turn, origin = turn @ joint.rotation, origin + place
        above = carried[joint.parent]
        if joint.movable:
            axis = turn @ joint.axis
            if joint.prismatic:
                slid = axis * q[k]
                acceleration = acceleration + np.cross(alpha, slid) + np.cross(omega, np.cross(omega, slid))
                acceleration = acceleration + 2.0 * np.cross(omega, axis * qd[k])
                origin = origin + slid
            else:
                turn = turn @ about_axis(joint.axis, float(q[k]))
                alpha = alpha + np.cross(omega, axis * qd[k])
                omega = omega + axis * qd[k]
            above = (*above, (k, origin, joint.prismatic))
            k += 1
        frames[joint.child] = (turn, origin, omega, alpha, acceleration)
        carried[joint.child] = above
        if not above or (link.mass == 0.0 and not np.any(link.inertia)):
            continue
        lever = turn @ link.com
        com = origin + lever
        pull = acceleration + np.cross(alpha, lever) + np.cross(omega, np.cross(omega, lever))
        # The terms of ω × (ω × r) and of the products of inertia cancel in their turn.
        spin = float(omega @ omega)
        inertial = link.mass * (float(np.linalg.norm(pull)) + spin * float(np.linalg.norm(lever)))
        turning = float(np.linalg.norm(link.inertia)) * (spin + float(np.linalg.norm(alpha)))
        potential += link.mass * fall * float(np.linalg.norm(com))
        for index, anchor, prismatic in above:
            arm = 1.0 if prismatic else float(np.linalg.norm(com - anchor))
            gravity[index] += link.mass * fall * arm
            motion[index] += inertial * arm + (0.0 if prismatic else turning)
    return Terms(gravity, motion, potential)
