"""Kinematic loops: where a tree of joints is cut, and what the cut holds together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Relative motions of two frames: shifts along, and turns about, the axes of the first.
SHIFTS = ("x", "y", "z")
TURNS = ("rx", "ry", "rz")
MOTIONS = (*SHIFTS, *TURNS)


BALL = SHIFTS
WELD = MOTIONS
#: By its axis: what a revolute joint closes.
REVOLUTE = {turn: (*SHIFTS, *(other for other in TURNS if other != turn)) for turn in TURNS}


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame fixed to a link.

    link: its name, or the base's. xyz: origin in the link frame [m], shape (3,); on a flexible link it rides on the section nearest
    to it, as joints do. rotation: frame to link axes, shape (3, 3).
    """

    link: str
    xyz: NDArray[np.float64]
    rotation: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Loop:
    """A cut joint: two frames whose relative motions ``closed`` do not happen.

    closed: of ``MOTIONS``. All three shifts: a ball joint; with rx and ry: a revolute joint about z; all six: a weld.
    """

    name: str
    first: Frame
    second: Frame
    closed: tuple[str, ...]

    @property
    def conditions(self) -> tuple[str, ...]:
        """What it holds, by name, in the order of ``MOTIONS``."""
        return tuple(motion for motion in MOTIONS if motion in self.closed)


@dataclass(frozen=True, eq=False)
class Coupling:
    """A joint of one degree of freedom whose position is a polynomial of another's; itself a loop with one condition.

    leader: the other joint; None: the position is the constant. coefficients: ascending, [rad or m over powers of the same].
    """

    name: str
    joint: str
    leader: str | None
    coefficients: tuple[float, float, float, float, float]

    @property
    def conditions(self) -> tuple[str, ...]:
        """The one thing that it holds."""
        return ("coupling",)

    def value(self, x: float) -> tuple[float, float, float]:
        """Polynomial, first and second derivative at the leader's position."""
        polynomial = np.polynomial.Polynomial(self.coefficients)
        first = polynomial.deriv()
        return float(polynomial(x)), float(first(x)), float(first.deriv()(x))


def explicit(loops: Sequence[Loop | Coupling]) -> tuple[Coupling, ...]:
    """Loops in an order in which each follows from what is known by then; none where they are not all of that kind.

    They are where all are couplings, each of another joint, and none in a circle.
    """
    left = [loop for loop in loops if isinstance(loop, Coupling)]
    followers = [coupling.joint for coupling in left]
    if len(left) < len(loops) or len(set(followers)) < len(followers):
        return ()
    order: list[Coupling] = []
    while left:
        waiting = {coupling.joint for coupling in left}
        ready = [coupling for coupling in left if coupling.leader not in waiting]
        if not ready:
            return ()
        order += ready
        left = [coupling for coupling in left if coupling not in ready]
    return tuple(order)


# Axes (of the first frame, of the second) whose cosine is zero while a turn is closed, and the sign that makes the cosine's rate
# the rate of that turn where the frames coincide. About one free axis, the pair of conditions is that both axes are the same.
_PAIRS = {"rx": (1, 2, -1.0), "ry": (0, 2, 1.0), "rz": (0, 1, -1.0)}
_FREE_ABOUT_Y = {"rx": (2, 1, 1.0), "rz": (0, 1, -1.0)}


def turn_pairs(closed: tuple[str, ...]) -> dict[str, tuple[int, int, float]]:
    """For every closed turn: axis of the first frame, axis of the second that it stays orthogonal to, and a sign.

    A turn alone is that of a universal joint's: one axis of each frame stays orthogonal to one of the other.
    """
    turns = [turn for turn in TURNS if turn in closed]
    pairs = _FREE_ABOUT_Y if turns == ["rx", "rz"] else _PAIRS
    return {turn: pairs[turn] for turn in turns}


# A revolute cut is two connections, this far apart along its axis [m].
APART = 0.1


@dataclass(frozen=True, eq=False)
class Connection:
    """Two frames whose origins coincide, and whose axes do too where they are welded: what other engines hold together."""

    first: Frame
    second: Frame
    welded: bool


def connections(loop: Loop) -> tuple[Connection, ...]:
    """A ball, revolute or welded cut as connections: a revolute one as two along its axis."""
    turns = [turn for turn in TURNS if turn in loop.closed]
    found = [Connection(loop.first, loop.second, len(turns) == 3)]
    if len(turns) == 2:
        (axis,) = (k for k, turn in enumerate(TURNS) if turn not in loop.closed)
        first, second = (
            Frame(frame.link, frame.xyz + APART * frame.rotation[:, axis], frame.rotation)
            for frame in (loop.first, loop.second)
        )
        found.append(Connection(first, second, False))
    return tuple(found)
