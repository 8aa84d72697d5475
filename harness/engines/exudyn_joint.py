"""What acts on the relative turn of two sections in Exudyn: rotor inertia, damper and applied torque of a joint.

Exudyn has no such element for slope vectors, and none of a rotor's inertia at all; it is written here as a generic object
whose coordinates are those of the nodes on either side. With the relative turn α(x), its gradient g and speed α' = g·x':

    kinetic energy ½ I α'² gives the mass matrix I g gᵀ and the force -I g (g'·x');   damper -d g α';   torque g τ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from harness.engines.planar import PlanarChain
from harness.engines.protocol import Array


class Side(Protocol):
    """One side of a joint: the nodes whose coordinates turn its section, and how many coordinates they have."""

    @property
    def nodes(self) -> tuple[Any, ...]: ...

    @property
    def size(self) -> int: ...

    def turn(self, q: Array, qd: Array) -> tuple[Array, float]:
        """Gradient of the turn about z by the nodes' coordinates, and the gradient's rate times the velocities."""
        ...


@dataclass(frozen=True, eq=False)
class SlopeSide:
    """The end of an ANCF beam: x and y and slope vector, with the slope's reference value."""

    node: Any
    slope: Array
    size: int = 4

    @property
    def nodes(self) -> tuple[Any, ...]:
        return (self.node,)

    def turn(self, q: Array, qd: Array) -> tuple[Array, float]:
        a, b = q[2] + self.slope[0], q[3] + self.slope[1]
        square = a * a + b * b
        speed = (a * qd[3] - b * qd[2]) / square
        stretch = 2.0 * (a * qd[2] + b * qd[3]) / square
        return np.array([0.0, 0.0, -b / square, a / square]), -float(speed * stretch)


@dataclass(frozen=True, eq=False)
class PlanarBodySide:
    """A rigid body in the plane: x, y and its turn."""

    node: Any
    size: int = 3

    @property
    def nodes(self) -> tuple[Any, ...]:
        return (self.node,)

    def turn(self, q: Array, qd: Array) -> tuple[Array, float]:
        return np.array([0.0, 0.0, 1.0]), 0.0


@dataclass(frozen=True, eq=False)
class FrameSide:
    """A body on Euler parameters, with their reference values (4,), that turns about z only.

    modes: the node of modal coordinates by which the section turns further, and the turn of each [rad], (m,).
    """

    node: Any
    parameters: Array
    modes: tuple[Any, Array] | None = None

    @property
    def nodes(self) -> tuple[Any, ...]:
        return (self.node,) if self.modes is None else (self.node, self.modes[0])

    @property
    def size(self) -> int:
        return 7 if self.modes is None else 7 + len(self.modes[1])

    def turn(self, q: Array, qd: Array) -> tuple[Array, float]:
        # The angular velocity is 2 E(e) e', and E(e') e' is zero.
        e = self.parameters + q[3:7]
        gradient = np.zeros(self.size)
        gradient[3:7] = -2.0 * e[3], -2.0 * e[2], 2.0 * e[1], 2.0 * e[0]
        if self.modes is not None:
            gradient[7:] = self.modes[1]
        return gradient, 0.0


def held_torques(chain: PlanarChain, since: Array, forces: Array | None) -> dict[int, Callable[[float], float]]:
    """Torque about z over time [N·m] on each link's joint that has one, by the link's index; held between samples.

    forces: by coordinate, (T, n); since: times of the samples from the start [s].
    """
    found: dict[int, Callable[[float], float]] = {}
    margin = 1e-9 * float(since[-1])
    if forces is None:
        return found
    for k, link in enumerate(chain.links):
        if link.coordinate < 0 or not np.any(forces[:, link.coordinate]):
            continue
        held = link.sign * forces[:, link.coordinate]

        def torque(t: float, held: Array = held) -> float:
            # Exudyn's steps end with the force there, and take the mean of both ends: where a sample falls on the end of a
            # step, the mean of what is held before and after gives every step its own on the whole.
            before, after = (
                held[max(0, int(np.searchsorted(since, t + shift, side="right")) - 1)] for shift in (-margin, margin)
            )
            return 0.5 * float(before + after)

        found[k] = torque
    return found


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
            direction, rest = side.turn(q[own], qd[own])
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
            nodeNumbers=[node for side, _ in sides for node in side.nodes], massMatrix=np.zeros((count, count)), **given
        )
    )
