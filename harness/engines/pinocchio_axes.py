"""Our positions and velocities as Pinocchio has them: its order, quaternions with w last, a free flyer's velocity in its own axes.

All there is to that transform stands here, for models that we build and for those that Pinocchio reads.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.engines.protocol import Array
from harness.system import JointType, System
from harness.system.rotation import from_quaternion


@dataclass(frozen=True, eq=False)
class Axes:
    """Where coordinates stand, and which have other axes.

    order: [k] is our index of Pinocchio's velocity k, places: of its position k. free: where a free joint's velocities begin among
    ours, and its quaternion among our positions. circles: Pinocchio's positions that are a cosine, its sine behind it.
    """

    order: NDArray[np.intp]
    places: NDArray[np.intp]
    free: tuple[tuple[int, int], ...]
    circles: tuple[int, ...]

    def position(self, q: Array) -> Array:
        """Pinocchio's positions of ours."""
        found = np.array(q[self.places])
        for at in self.circles:
            found[at], found[at + 1] = np.cos(found[at]), np.sin(found[at])
        return found

    def turned(self, q: Array, value: Array, *, back: bool = False) -> Array:
        """Velocities or forces in Pinocchio's axes from ours, or back: linear parts of free joints are turned to the child's."""
        if not self.free:
            return value
        result = np.array(value)
        for at, quaternion in self.free:
            turn = from_quaternion(q[quaternion : quaternion + 4])
            result[at : at + 3] = (turn if back else turn.T) @ result[at : at + 3]
        return result

    def turning(self, q: Array, qd: Array) -> Array:
        """w × Rᵀ v of free joints, zero elsewhere: in axes that turn, d(Rᵀ v) = Rᵀ v̇ - w × Rᵀ v."""
        result = np.zeros_like(qd)
        turned = self.turned(q, qd)
        for at, _ in self.free:
            result[at : at + 3] = np.cross(qd[at + 3 : at + 6], turned[at : at + 3])
        return result

    def into(self, q: Array, value: Array) -> Array:
        """Pinocchio's velocities of ours."""
        return np.asarray(self.turned(q, value)[self.order])

    def out(self, q: Array, value: Array) -> Array:
        """Generalized forces from Pinocchio's."""
        result = np.empty_like(value)
        result[self.order] = value
        return self.turned(q, result, back=True)

    def acceleration_into(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Accelerations for Pinocchio."""
        return np.asarray((self.turned(q, qdd) - self.turning(q, qd))[self.order])

    def acceleration_out(self, q: Array, qd: Array, value: Array) -> Array:
        """Accelerations from Pinocchio's."""
        result = np.empty_like(value)
        result[self.order] = value
        return self.turned(q, result + self.turning(q, qd), back=True)

    def mass_out(self, q: Array, upper: Array) -> Array:
        """The mass matrix from Pinocchio's upper triangle, which is all that ``crba`` fills in some releases."""
        upper = np.triu(upper)
        result = np.empty_like(upper)
        result[np.ix_(self.order, self.order)] = upper + np.triu(upper, 1).T
        return self.turned(q, self.turned(q, result, back=True).T, back=True)


def axes_of(model: Any, system: System) -> Axes:
    """The axes of a ``pinocchio.Model`` whose joints are the movable ones of a rigid system, by name."""
    names, positions = system.coordinate_names, system.position_names
    order = np.empty(model.nv, dtype=np.intp)
    places = np.empty(model.nq, dtype=np.intp)
    joints = {joint.name: joint for joint in system.movable_joints}
    free, circles = [], []
    for k in range(1, model.njoints):
        joint, theirs = joints[model.names[k]], model.joints[k]
        first = names.index(joint.velocity_names[0])
        order[theirs.idx_v : theirs.idx_v + theirs.nv] = np.arange(first, first + theirs.nv)
        at = positions.index(joint.position_names[0])
        where = np.arange(at, at + len(joint.position_names))
        if joint.turns_in_space:
            # w first to w last.
            where = np.concatenate([where[:-4], np.roll(where[-4:], -1)])
        if joint.type is JointType.FREE:
            free.append((first, at + 3))
        if theirs.nq == 2:
            where = np.repeat(where, 2)
            circles.append(int(theirs.idx_q))
        places[theirs.idx_q : theirs.idx_q + theirs.nq] = where
    return Axes(order, places, tuple(free), tuple(circles))
