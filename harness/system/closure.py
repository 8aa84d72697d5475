"""Closing loops: how far they are open at a position, the nearest position where they are not, and which of them cannot be."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError, UnsupportedError
from harness.system.description import Array, System
from harness.system.kinematics import Pose, mass_matrix, poses
from harness.system.loop import SHIFTS, TURNS, Coupling, Frame, Loop, turn_pairs
from harness.system.lowering import lower, neutral_position
from harness.system.manifold import integrate

# Loops are closed where nothing is open by more than this share of the mechanism's size (m), or by this angle (rad).
CLOSED = 1e-10
# Singular values below this share of the largest count as none: positions are closed to 1e-10.
RANK = 1e-7
_STEPS = 200
_STARTS = 25


@dataclass(frozen=True, eq=False)
class Opening:
    """What conditions leave open, (c,) [m or rad], their Jacobian (c, nv), and the name of the loop and motion of each."""

    value: Array
    jacobian: Array
    names: tuple[tuple[str, str], ...]


def opening(system: System, q: Array, loops: Sequence[Loop | Coupling] | None = None) -> Opening:
    """How far loops (all unless given) are open at positions q (nq,); beams are undeformed."""
    rigid = system.rigid()
    lowered = lower(rigid)
    places = _rigid_places(system)
    short = q[places]
    at = poses(lowered, short)
    values: list[float] = []
    rows: list[Array] = []
    names: list[tuple[str, str]] = []
    for loop in system.loops if loops is None else loops:
        found = _coupling(rigid, short, loop) if isinstance(loop, Coupling) else _loop(at, loop)
        values += found[0]
        rows += found[1]
        names += [(loop.name, condition) for condition in loop.conditions]
    jacobian = np.zeros((len(rows), system.nv))
    if rows:
        rates = [system.coordinate_names.index(name) for name in rigid.coordinate_names]
        jacobian[:, rates] = np.array(rows)
    return Opening(np.array(values), jacobian, tuple(names))


def _rigid_places(system: System) -> list[int]:
    """Where the positions of the joints stand among those of the system."""
    names = system.position_names
    return [names.index(name) for name in system.rigid().position_names]


def _loop(at: Mapping[str, Pose], loop: Loop) -> tuple[list[float], list[Array]]:
    first, second = (_pose(at, frame) for frame in (loop.first, loop.second))
    apart = second.origin - first.origin
    moving = second.jacobian - first.jacobian
    values, rows = [], []
    for motion in loop.conditions:
        if motion in SHIFTS:
            axis = first.rotation[:, SHIFTS.index(motion)]
            values.append(float(axis @ apart))
            # The axis turns with the first frame.
            rows.append(axis @ moving[3:] + np.cross(axis, apart) @ first.jacobian[:3])
        else:
            i, j, sign = turn_pairs(loop.closed)[motion]
            one, other = first.rotation[:, i], second.rotation[:, j]
            values.append(sign * float(one @ other))
            rows.append(sign * np.cross(other, one) @ moving[:3])
    return values, rows


def _pose(at: Mapping[str, Pose], frame: Frame) -> Pose:
    return at[frame.link].at(np.asarray(frame.xyz), np.asarray(frame.rotation))


def _coupling(system: System, q: Array, coupling: Coupling) -> tuple[list[float], list[Array]]:
    place, rate = coordinate(system, coupling.joint)
    row = np.zeros(system.nv)
    row[rate] = 1.0
    if coupling.leader is None:
        return [float(q[place]) - coupling.coefficients[0]], [row]
    leading, led = coordinate(system, coupling.leader)
    value, slope, _ = coupling.value(float(q[leading]))
    row[led] -= slope
    return [float(q[place]) - value], [row]


def coordinate(system: System, joint: str) -> tuple[int, int]:
    """Where the position, and where the velocity, of a joint of one degree of freedom stands."""
    return system.position_names.index(joint), system.coordinate_names.index(joint)


def size(system: System) -> float:
    """A length of the mechanism [m], for judging distances: the longest offset of a joint, loop or mass, 1 m if there is none."""
    lengths = [float(np.linalg.norm(joint.xyz)) for joint in system.joints]
    lengths += [float(np.linalg.norm(link.com)) for link in system.links]
    lengths += [float(np.linalg.norm(f.xyz)) for l in system.loops if isinstance(l, Loop) for f in (l.first, l.second)]
    return max(lengths, default=0.0) or 1.0


def worst(system: System, found: Opening) -> float:
    """The largest opening, shifts over the mechanism's size."""
    if not len(found.value):
        return 0.0
    return float(np.abs(found.value / _units(system, found)).max())


def _units(system: System, found: Opening) -> Array:
    length = size(system)
    sliding = {joint.name for joint in system.joints if joint.prismatic}
    led = {loop.name for loop in system.loops if isinstance(loop, Coupling) and loop.joint in sliding}
    return np.array([length if motion in SHIFTS or name in led else 1.0 for name, motion in found.names])


def close(
    system: System, q: Array, *, held: Collection[str] = (), loops: Sequence[Loop | Coupling] | None = None
) -> tuple[Array, Opening]:
    """Positions (nq,) near q where loops are closed, by damped least squares, and what is left open there.

    held: names of velocities whose positions stay. The damping keeps steps short where the closed position is far or singular.
    """
    free = _free(system, held)
    found = opening(system, q, loops)
    units = _units(system, found)
    damping = 1e-3
    for _ in range(_STEPS):
        value = found.value / units
        norm = float(np.linalg.norm(value))
        if norm < 1e-15:
            break
        jacobian = found.jacobian[:, free] / units[:, None]
        step = np.zeros(system.nv)
        # Rows of the damping below make short steps.
        stacked = np.vstack([jacobian, damping * np.eye(int(free.sum()))])
        step[free] = np.linalg.lstsq(stacked, np.concatenate([-value, np.zeros(int(free.sum()))]), rcond=None)[0]
        longest = float(np.abs(step).max(initial=0.0))
        if longest > 0.5:
            step *= 0.5 / longest
        tried = integrate(system, q, step)
        after = opening(system, tried, loops)
        change = float(np.linalg.norm(after.value / units))
        if change < norm:
            q, found, damping = tried, after, max(0.2 * damping, 1e-14)
        elif norm < 1e-13 or damping > 1e6:
            break
        else:
            damping = max(10.0 * damping, 1e-12)
    return q, found


def _free(system: System, held: Collection[str]) -> NDArray[np.bool_]:
    """Which velocities may move while loops are closed: not those that are held, nor bending."""
    rigid = set(system.rigid().coordinate_names)
    return np.array([name in rigid and name not in held for name in system.coordinate_names])


def stated_position(system: System) -> Array:
    """Positions that the file places the mechanism at: all zero, or an MJCF's ``qpos0``, shape (nq,)."""
    q = neutral_position(system)
    for frame in system.keyframes:
        if frame.name == "qpos0":
            names = system.position_names
            for name, value in frame.position.items():
                if name in names:
                    q[names.index(name)] = value
    return q


def closed_position(system: System, q: Array | None = None, *, held: Collection[str] = ()) -> Array:
    """Positions where all loops are closed, the nearest to q (the file's zero if None) that is found; joints ``held`` stay.

    Raises InputError naming the loop that cannot close, or the loops that contradict one another.
    """
    start = stated_position(system) if q is None else q
    best, found = close(system, start, held=held)
    if worst(system, found) <= CLOSED:
        return _unwound(system, best, start)
    other = _from_elsewhere(system, start, held, None)
    if isinstance(other, np.ndarray):
        return _unwound(system, other, start)
    left = min(worst(system, found), other)
    if held:
        raise InputError(
            f"with {', '.join(held)} as given the loops cannot close: {_how_far(system, left)} stays open",
            mend="give other positions, or fewer",
            source=system.source,
        )
    _blame(system, start, left)


def _unwound(system: System, q: Array, start: Array) -> Array:
    """The same place without whole turns away from ``start`` (nq,): from where it stood stretched the way may go round."""
    names = system.position_names
    turning = [
        names.index(joint.name) for joint in system.movable_joints if joint.name in names and not joint.prismatic
    ]
    turns = np.zeros(len(q))
    turns[turning] = np.round((q - start)[turning] / (2.0 * np.pi))
    if not turns.any():
        return q
    back = q - 2.0 * np.pi * turns
    return back if worst(system, opening(system, back)) <= CLOSED else q


def _from_elsewhere(
    system: System, start: Array, held: Collection[str], loops: Sequence[Loop | Coupling] | None
) -> Array | float:
    """A closed position from other starts, or the least opening that is left."""
    rng = np.random.default_rng(51)
    free = _free(system, held)
    reach = np.full(system.nv, np.pi)
    sliding = [k for k, name in enumerate(system.coordinate_names) if _slides(system, name)]
    reach[sliding] = size(system)
    least = np.inf
    for _ in range(_STARTS):
        tried, found = close(
            system, integrate(system, start, rng.uniform(-1.0, 1.0, system.nv) * reach * free), held=held, loops=loops
        )
        left = worst(system, found)
        if left <= CLOSED:
            return tried
        least = min(least, left)
    return least


def _slides(system: System, name: str) -> bool:
    for joint in system.joints:
        if name in joint.velocity_names:
            return joint.prismatic or name.rpartition(".")[2] in ("x", "y", "vx", "vy", "vz")
    return False


def _how_far(system: System, left: float) -> str:
    return f"{left * size(system):.3g} m (or {left:.3g} rad)"


def _blame(system: System, start: Array, left: float) -> NoReturn:
    """Raise for the loop that cannot close by itself, or for those that cannot together."""

    def remains(loops: Sequence[Loop | Coupling]) -> float:
        found = close(system, start, loops=loops)[1]
        now = worst(system, found)
        if now <= CLOSED:
            return 0.0
        other = _from_elsewhere(system, start, (), loops)
        return 0.0 if isinstance(other, np.ndarray) else min(now, other)

    for loop in system.loops:
        open_by = remains([loop])
        if open_by > 0.0:
            raise InputError(
                f"loop {loop.name!r} cannot close: at best {_how_far(system, open_by)} stays open",
                mend="check its two frames, and the lengths between them",
                source=system.source,
            )
    # The fewest loops that do not go together: leave out what can be left out.
    kept = list(system.loops)
    for loop in system.loops:
        fewer = [other for other in kept if other is not loop]
        if len(fewer) > 1 and remains(fewer) > 0.0:
            kept = fewer
    names = ", ".join(repr(loop.name) for loop in kept)
    raise InputError(
        f"loops {names} contradict one another: each closes by itself, together {_how_far(system, left)} stays open",
        mend="take one out, or check their frames",
        source=system.source,
    )


def rank(system: System, q: Array) -> int:
    """Number of independent conditions at closed positions q, by QR with column pivoting of the scaled Jacobian."""
    from scipy.linalg import qr  # slow to import, and most systems are trees

    rows = _scaled(opening(system, q))
    if not np.any(rows):
        return 0
    diagonal = np.abs(np.diag(qr(rows.T, mode="r", pivoting=True)[0]))
    return int((diagonal > RANK * diagonal[0]).sum())


def _scaled(found: Opening) -> Array:
    """The Jacobian with the longest row of the shifts, and of the turns, of every loop as long as one.

    Not every row: one that vanishes at a singular position is to be seen to.
    """
    lengths = np.linalg.norm(found.jacobian, axis=1)
    groups = [(name, motion in SHIFTS) for name, motion in found.names]
    longest = {group: max(x for x, g in zip(lengths, groups, strict=True) if g == group) for group in groups}
    return found.jacobian / np.array([longest[group] or 1.0 for group in groups]).reshape(-1, 1)


def closed_velocity(system: System, q: Array, qd: Array, *, held: Collection[str] = ()) -> Array:
    """The velocities nearest to qd (n,) that keep loops closed at closed positions q; coordinates ``held`` keep theirs.

    Raises InputError where they cannot.
    """
    found = opening(system, q)
    free = np.array([name not in held for name in system.coordinate_names])
    rows = found.jacobian / _units(system, found)[:, None]
    moved = qd.copy()
    moved[free] += np.linalg.lstsq(rows[:, free], -rows @ qd, rcond=RANK)[0]
    left = np.abs(rows @ moved)
    if left.max(initial=0.0) > 1e-9 * (1.0 + np.abs(qd).max(initial=0.0)):
        name = found.names[int(np.argmax(left))][0]
        raise InputError(
            f"with the velocities of {', '.join(held)} as given loop {name!r} opens",
            mend="give fewer of them, or such as go together",
            source=system.source,
        )
    return moved


def independent_conditions(system: System, q: Array) -> frozenset[tuple[str, str]]:
    """Loop and motion of conditions that say all there is to say at closed positions q, none of them twice."""
    from scipy.linalg import qr

    found = opening(system, q)
    rows = _scaled(found)
    order = qr(rows.T, mode="r", pivoting=True)[1]
    return frozenset(found.names[k] for k in order[: rank(system, q)])


def usual_rank(system: System, q: Array) -> int:
    """The rank that the conditions have in general: the largest at q and at closed positions near it."""
    most = rank(system, q)
    rng = np.random.default_rng(5)
    for _ in range(3):
        near, found = close(system, integrate(system, q, 0.1 * rng.standard_normal(system.nv)))
        if worst(system, found) <= CLOSED:
            most = max(most, rank(system, near))
    return most


def turning(system: System, q: Array, loop: Loop) -> Array:
    """Angular velocity of a cut joint's second frame against its first at positions q, by every velocity (3, nv)."""
    rigid = system.rigid()
    at = poses(lower(rigid), q[_rigid_places(system)])
    first, second = (_pose(at, frame) for frame in (loop.first, loop.second))
    rows = np.zeros((3, system.nv))
    rates = [system.coordinate_names.index(name) for name in rigid.coordinate_names]
    rows[:, rates] = second.jacobian[:3] - first.jacobian[:3]
    return rows


@lru_cache(maxsize=16)
def pins(system: System) -> tuple[str, ...]:
    """Cut joints of which no joint has the name and whose frames turn against one another where all loops stay closed."""
    cuts = [loop for loop in system.loops if isinstance(loop, Loop) and set(TURNS) - set(loop.closed)]
    taken = {joint.name for joint in system.joints} | {gimbal.name for gimbal in system.gimbals}
    cuts = [loop for loop in cuts if loop.name not in taken]
    if not cuts:
        return ()
    q = closed_position(system)
    _, sizes, rows = np.linalg.svd(_scaled(opening(system, q)))
    ways = rows[int((sizes > RANK * sizes.max(initial=0.0)).sum()) :]
    return tuple(loop.name for loop in cuts if np.abs(turning(system, q, loop) @ ways.T).max(initial=0.0) > RANK)


def completed(system: System, kinds: Sequence[tuple[str, ...]]) -> tuple[Loop, ...]:
    """The cut joints with conditions added that the others hold already, until each closes what one of ``kinds`` closes.

    A planar loop that closes x and z closes y as well where nothing can move along y. Raises UnsupportedError naming the loop that
    no kind says.
    """
    q = closed_position(system)
    independent = usual_rank(system, q)
    found: list[Loop] = []
    for k, loop in enumerate(system.loops):
        if isinstance(loop, Coupling):
            continue
        for kind in sorted(kinds, key=len):
            if not set(loop.closed) <= set(kind):
                continue
            wider = replace(loop, closed=kind)
            tried = replace(system, loops=(*system.loops[:k], wider, *system.loops[k + 1 :]))
            if worst(tried, opening(tried, q)) <= 10.0 * CLOSED and usual_rank(tried, q) == independent:
                found.append(wider)
                break
        else:
            raise UnsupportedError(
                f"loop {loop.name!r} closes {', '.join(loop.conditions)}, and no more holds by itself",
                mend="cut the loop at a ball, a revolute joint or a weld",
                source=system.source,
            )
    return tuple(found)


def unresisted(system: System, q: Array) -> str | None:
    """Name of a velocity that moves no inertia while loops stay closed, None if there is none.

    M + JᵀJ has the same motions as M within the loops, and is positive definite there exactly where M is.
    """
    found = opening(system, q)
    rows = found.jacobian / _units(system, found)[:, None]
    mass = mass_matrix(system.rigid(), q[_rigid_places(system)])
    rigid_rates = [system.coordinate_names.index(name) for name in system.rigid().coordinate_names]
    rows = rows[:, rigid_rates]
    held = mass + float(np.trace(mass)) / len(mass) * rows.T @ rows
    scale = np.sqrt(np.maximum(np.diag(held), 1e-300))
    values, vectors = np.linalg.eigh(held / np.outer(scale, scale))
    if values[0] > 1e-13:
        return None
    return system.rigid().coordinate_names[int(np.argmax(np.abs(vectors[:, 0])))]
