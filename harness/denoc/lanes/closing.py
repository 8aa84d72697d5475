"""What the lanes know of a mechanism beyond its tree: loops, and joints that turn in space; as ``lanes.closed`` wants it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes import closed
from harness.denoc.lanes.nodes import PLAN as PLACE_OF_PLAN
from harness.errors import UnsupportedError
from harness.system import Coupling, Loop, System
from harness.system.closure import (
    CLOSED,
    close,
    closed_position,
    independent_conditions,
    opening,
    size,
    usual_rank,
    worst,
)
from harness.system.loop import SHIFTS, turn_pairs

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

GROUP_SLOTS = ("damping", "coulomb_torque", "quadratic_drag")
# A pin in a hole: steel on steel gives less, which no motion shows; a blow of it dies out in a few bounces.
GIVES, DAMPED = 1e-4, 0.2
_FREE_ENOUGH = 1e-3  # singular value of the dependent columns, of the largest, below which others are tried first
_TRIES = 5


@dataclass(frozen=True, eq=False)
class Beyond:
    """Integers for the kernels and where their numbers stand.

    plan: see ``lanes.closed``; without the tree's recursion. count: of numbers in a row. room: vectors of workspace.
    conditions: loop and motion of each that says something of its own. dependent: coordinates that follow (m,); jacobian: of the
    conditions (m, n), where these tell the others well; stated: positions (n,) that close the loops; length: of the mechanism [m].
    """

    plan: Integers
    count: int
    room: int
    conditions: tuple[tuple[Loop | Coupling, str], ...]
    dependent: Integers
    jacobian: Array
    stated: Array
    length: float

    def kept(self, system: System, parted: Collection[str]) -> tuple[Integers, Integers]:
        """The conditions that hold where some loops' frames go free of each other, and which coordinates follow by these."""
        held = [
            k for k, (loop, motion) in enumerate(self.conditions) if loop.name not in parted or motion not in SHIFTS
        ]
        rows = np.zeros((len(held), self.jacobian.shape[1]))
        rows[:, self.dependent] = self.jacobian[held][:, self.dependent]
        return np.array(held, dtype=np.int64), _followers(system, rows)

    @property
    def loops(self) -> bool:
        return bool(self.conditions)

    def for_recursion(self, recursion: int, tail: int) -> Integers:
        """The plan around one of the tree's recursions. tail: vectors of workspace before the numbers."""
        plan = self.plan.copy()
        plan[closed.RECURSION], plan[closed.TAIL] = recursion, tail
        return plan

    @property
    def loop_names(self) -> tuple[str, ...]:
        """The loops that close shifts, in the order of their numbers."""
        return tuple(dict.fromkeys(loop.name for loop, _ in self.conditions if isinstance(loop, Loop)))

    @property
    def before_loops(self) -> int:
        """Numbers in a row before those of the loops."""
        return self.count - closed.LOOP_NUMBERS * len(self.loop_names)

    def numbers(self, system: System) -> Array:
        """Numbers of a system of that topology, for a row."""
        found: list[Array] = [
            np.array([group.damping, group.friction, 0.0, 0.0]) for group in system.gimbals
        ]  # fmt: skip
        if self.loops:
            for joint in system.joints:
                found += [np.ravel(joint.rotation), np.asarray(joint.xyz), np.asarray(joint.axis)]
        loops = {loop.name: loop for loop in system.loops}
        for loop, motion in self.conditions:
            found.append(_numbers(loops[loop.name], motion))
        stiffness, damping = contact(system)
        found += [np.array([0.0, stiffness, damping, 0.0, 0.0, 0.0]) for _ in self.loop_names]
        return np.concatenate(found)


def marked(tree: Integers, plan: Integers) -> Integers:
    """A tree's table with the place of its plan."""
    out = tree.copy()
    out[0, PLACE_OF_PLAN] = plan.ctypes.data
    return out


def beyond(system: System) -> Beyond | None:
    """What a system of joints of one degree of freedom has beyond its tree; None if nothing.

    Raises UnsupportedError for loops beside links that bend.
    """
    if not system.loops and not system.gimbals:
        return None
    n = system.nv
    names = list(system.coordinate_names)
    conditions: tuple[tuple[Loop | Coupling, str], ...] = ()
    dependent, jacobian, stated, length = np.zeros(0, dtype=np.int64), np.zeros((0, n)), np.zeros(n), 1.0
    if system.loops:
        if system.flexible:
            raise UnsupportedError(
                "loops beside links that bend, in a computation of many copies at once",
                mend="take the loops or the beams out, or use harness.Denoc",
                source=system.source,
            )
        conditions, stated, dependent, jacobian = _independent(system)
        length = size(system)
    bodies = {joint.child: k for k, joint in enumerate(system.joints)} if conditions else {}
    names_of_loops = list(dict.fromkeys(loop.name for loop, _ in conditions if isinstance(loop, Loop)))
    plan = [0, 0, len(system.gimbals), len(bodies), len(conditions), n - len(conditions), 0, n, len(names_of_loops)]
    leading = [k for k in range(n) if k not in dependent]
    plan[closed.LEADING] = leading[0] if leading else 0
    for group in system.gimbals:
        plan += [names.index(group.coordinates[0]), closed.SHIFT if group.slides else closed.SPIN]
    if conditions:
        for joint in system.joints:
            kind = closed.FIXED if not joint.movable else closed.SLIDES if joint.prismatic else closed.TURNS
            plan += [bodies.get(joint.parent, -1), kind, names.index(joint.name) if joint.movable else -1]
    for loop, motion in conditions:
        if isinstance(loop, Coupling):
            plan += [
                closed.COUPLED,
                names.index(loop.joint),
                -1 if loop.leader is None else names.index(loop.leader),
                -1,
            ]
        else:
            kind = closed.ALONG if motion in SHIFTS else closed.ACROSS
            one, other = bodies.get(loop.first.link, -1), bodies.get(loop.second.link, -1)
            plan += [kind, one, other, names_of_loops.index(loop.name)]
    m = len(conditions)
    count = (
        closed.GROUP_NUMBERS * len(system.gimbals)
        + closed.BODY_NUMBERS * len(bodies)
        + closed.CONDITION_NUMBERS * m
        + closed.LOOP_NUMBERS * len(names_of_loops)
    )
    room = count + closed.MOTION * len(bodies) + 3 * m + 2 * m * n + m * (m + 1) + 8 * n + 2 * n * n + 8
    return Beyond(np.array(plan, dtype=np.int64), count, room, conditions, dependent, jacobian, stated, length)


def contact(system: System) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N·s/m] of a pin in its hole: the mechanism's weight presses it in by ``GIVES`` of its size."""
    mass = sum(link.mass for link in system.links) or 1.0
    weight = mass * (float(np.linalg.norm(system.gravity)) or 9.81)
    stiffness = weight / (GIVES * size(system))
    return stiffness, 2.0 * DAMPED * float(np.sqrt(stiffness * mass))


def _independent(system: System) -> tuple[tuple[tuple[Loop | Coupling, str], ...], Array, Integers, Array]:
    """Conditions of which none says what others do, a position that closes them, which coordinates then follow, by what rows."""
    # Stretched or folded, a mechanism may be open where its file places it and know no way from there.
    stated = closed_position(system)
    rank = usual_rank(system, stated)
    at = stated
    rng = np.random.default_rng(3)
    best: tuple[tuple[int, float], tuple[tuple[Loop | Coupling, str], ...], Integers, Array] | None = None
    by_name = {loop.name: loop for loop in system.loops}
    least = max(rank - (system.nv - _led(system, np.arange(system.nv))), 0)
    for _ in range(_TRIES):
        told = independent_conditions(system, at)
        if len(told) == rank:
            found = opening(system, at)
            keep = [k for k, name in enumerate(found.names) if name in told]
            jacobian = found.jacobian[keep]
            dependent = _followers(system, jacobian)
            clear = _clearness(jacobian, dependent)
            conditions = tuple((by_name[found.names[k][0]], found.names[k][1]) for k in keep)
            # At a dead point of what is to lead it follows; elsewhere it need not.
            needless = _led(system, dependent) - least
            if best is None or (-needless, clear) > best[0]:
                best = (-needless, clear), conditions, dependent, jacobian
            if clear > _FREE_ENOUGH and needless <= 0:
                break
        near, left = close(system, stated + 0.3 * rng.standard_normal(system.nv))
        at = near if worst(system, left) <= CLOSED else at
    assert best is not None
    return best[1], stated, best[2], best[3]


def _followers(system: System, jacobian: Array) -> Integers:
    """As many coordinates as there are conditions, that the others leave nothing free of; those ``system.leading`` last."""
    names = system.coordinate_names
    leading = [names.index(name) for name in system.leading if name in names]
    others = [k for k in range(len(names)) if k not in leading]
    # Of those that may as well lead, the ones nearest to the base do.
    left = jacobian / np.maximum(np.abs(jacobian).max(axis=1, keepdims=True), 1e-300)
    taken: list[int] = []
    for pool in (others, leading[::-1]):
        pool = list(pool)
        while pool and len(taken) < len(jacobian):
            sizes = np.array([np.linalg.norm(left[:, k]) for k in pool])
            if sizes.max() < 1e-6:
                break
            k = pool.pop(int(np.flatnonzero(sizes > 0.3 * sizes.max())[-1]))
            taken.append(k)
            direction = left[:, k] / np.linalg.norm(left[:, k])
            left = left - np.outer(direction, direction @ left)
    return np.array(taken, dtype=np.int64)


def _led(system: System, places: Integers) -> int:
    """How many of some coordinates are to lead."""
    names = system.coordinate_names
    return sum(names[k] in system.leading for k in places)


def _clearness(jacobian: Array, dependent: Integers) -> float:
    """The smallest singular value of the dependent columns over the Jacobian's largest."""
    if len(dependent) < len(jacobian):
        return 0.0
    scaled = jacobian / np.abs(jacobian).max(axis=1, keepdims=True)
    own = np.linalg.svd(scaled[:, dependent], compute_uv=False)
    return float(own[-1] / np.linalg.svd(scaled, compute_uv=False)[0])


def _numbers(loop: Loop | Coupling, motion: str) -> Array:
    if isinstance(loop, Coupling):
        return np.array([*loop.coefficients, *[0.0] * (closed.CONDITION_NUMBERS - 5)])
    first, second = loop.first, loop.second
    if motion in SHIFTS:
        return np.concatenate([first.rotation[:, SHIFTS.index(motion)], first.xyz, second.xyz])
    i, j, _ = turn_pairs(loop.closed)[motion]
    return np.concatenate([first.rotation[:, i], first.xyz, second.rotation[:, j]])
