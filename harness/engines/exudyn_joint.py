"""What acts on the relative turn of two sections in Exudyn: rotor inertia, damper, spring and applied torque of a joint.

Exudyn has no such element for slope vectors; it is written here as a generic object whose coordinates are those of the
nodes on either side. With the relative turn α(x), its gradient g and speed α' = g·x':

    kinetic energy ½ I α'² gives the mass matrix I g gᵀ and the force -I g (g'·x');   damper -d g α';   torque g τ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.engines.protocol import Array


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a joint: a beam's node (x, y and slope vector) with the slope's reference value, or a rigid body's."""

    node: Any
    slope: Array | None

    @property
    def size(self) -> int:
        return 3 if self.slope is None else 4

    def turn(self, q: Array, qd: Array) -> tuple[float, Array, float]:
        """Turn [rad], its gradient by the node's coordinates, and the gradient's rate times the velocities."""
        if self.slope is None:
            return float(q[2]), np.array([0.0, 0.0, 1.0]), 0.0
        a, b = q[2] + self.slope[0], q[3] + self.slope[1]
        square = a * a + b * b
        speed = (a * qd[3] - b * qd[2]) / square
        stretch = 2.0 * (a * qd[2] + b * qd[3]) / square
        return float(np.arctan2(b, a)), np.array([0.0, 0.0, -b / square, a / square]), -float(speed * stretch)


def add_joint_element(
    items: Any,
    mbs: Any,
    parent: Side | None,
    child: Side,
    *,
    inertia: float,
    damping: float,
    torque: Callable[[float], float] | None = None,
) -> None:
    """Put rotor inertia [kg·m²], damping [N·m·s/rad] and a torque over time [N·m] on the turn of child less parent.

    parent: None for the base. The torque counts positive where it turns the child positive about z.
    """
    sides = [(child, 1.0)] if parent is None else [(parent, -1.0), (child, 1.0)]
    count = sum(side.size for side, _ in sides)

    def relative(q: Array, qd: Array) -> tuple[Array, float]:
        gradient, drift = np.empty(count), 0.0
        place = 0
        for side, sign in sides:
            own = slice(place, place + side.size)
            _, direction, rest = side.turn(q[own], qd[own])
            gradient[own] = sign * direction
            drift += sign * rest
            place += side.size
        return gradient, drift

    # Exudyn hands its own array types over; plain float arrays are much faster to index.
    def force(_mbs: Any, t: float, _item: int, q: Any, qd: Any) -> Array:
        rates = np.array(qd)
        gradient, drift = relative(np.array(q), rates)
        applied = torque(t) if torque is not None else 0.0
        result: Array = (applied - inertia * drift - damping * float(gradient @ rates)) * gradient
        return result

    def mass(_mbs: Any, t: float, _item: int, q: Any, qd: Any) -> Array:
        gradient, _ = relative(np.array(q), np.array(qd))
        return inertia * np.outer(gradient, gradient)

    given: dict[str, Any] = {"forceUserFunction": force}
    if inertia:
        given["massMatrixUserFunction"] = mass
    mbs.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=[side.node for side, _ in sides], massMatrix=np.zeros((count, count)), **given
        )
    )
