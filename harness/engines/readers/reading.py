"""What an engine made of a model file by itself, in our order of joints and our signs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.engines.folded import bodies
from harness.engines.protocol import Array
from harness.system import Joint, System


@dataclass(frozen=True, eq=False)
class Placed:
    """A joint and what moves rigidly with it, every joint position being zero, in base coordinates.

    kind: ``revolute``, ``prismatic``, ``ball`` or ``free``. axis: unit vector, shape (3,); zero of a joint that has none.
    origin: a point of the axis, or a ball's centre [m]. mass [kg], com [m], inertia about it [kg·m²] of all links carried on this
    joint and no further one.
    """

    joint: str
    link: str
    kind: str
    parent: int
    axis: Array
    origin: Array
    mass: float
    com: Array
    inertia: Array


class Reading(Protocol):
    """A model as an engine's own reader made it; q (nq,), qd (nv,) as in our system: its order, its signs, its conventions.

    names: the movable joints it read.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    def mass_matrix(self, q: Array) -> Array: ...

    def bias(self, q: Array, qd: Array) -> Array: ...

    def gravity(self, q: Array) -> Array: ...

    def placed(self) -> tuple[Placed, ...]:
        """Its joints and bodies in the order of ``names``."""
        ...

    def fields(self) -> Mapping[str, Mapping[str, float]]:
        """Numbers of each joint by name (``damping``, ``friction``, ``armature``, ``lower``, ``upper``), those it knows."""
        ...


def kind_of(joint: Joint) -> str:
    """What readers call a joint's kind."""
    if joint.turns_in_space:
        return str(joint.type)
    return "prismatic" if joint.prismatic else "revolute"


def placed_bodies(system: System) -> tuple[Placed, ...]:
    """The same of our own description."""
    found: list[Placed] = []
    turns: list[Array] = []
    for body in bodies(system)[0]:
        base = (np.eye(3), np.zeros(3)) if body.parent < 0 else (turns[body.parent], found[body.parent].origin)
        turn, origin = base[0] @ body.rotation, base[1] + base[0] @ body.xyz
        turns.append(turn)
        found.append(
            Placed(
                body.joint.name,
                body.joint.child,
                kind_of(body.joint),
                body.parent,
                np.zeros(3) if body.joint.turns_in_space else turn @ body.joint.axis,
                origin,
                body.mass,
                origin + turn @ body.com,
                turn @ body.inertia @ turn.T,
            )
        )
    return tuple(found)
