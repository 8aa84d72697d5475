"""Whether a system has dynamics at all: possible bodies, and inertia against every joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.system.description import Array, Joint, Link, System, constant
from harness.system.inertia import impossible, rounded_away
from harness.system.kinematics import spatial_inertia
from harness.system.loop import Coupling, Loop
from harness.system.lowering import followed, lower
from harness.system.magnitudes import check_magnitudes
from harness.system.rotation import about_axis, skew
from harness.system.suggest import did_you_mean

# Below this share of the body's inertia, what is left about an axis is rounding.
_ROUNDING = 1e-13
# Configurations tried [rad or m]: three massless axes that cross may be singular in one pose and sound in all others.
_POSES = 3


def check_bodies(
    links: tuple[Link, ...],
    *,
    physical: bool = True,
    source: Path | None = None,
    lines: Mapping[tuple[str, str], int] | None = None,
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Links, and notes on them; refuses those that no body can be, with ``physical=False`` tells so in a note instead.

    Inertia that is only rounding becomes that of a point, with a note.
    Raises InputError naming the link. A negative mass is refused always.
    """
    notes, kept = [], []
    for link in links:
        if rounded_away(link):
            moment = float(np.linalg.eigvalsh(np.asarray(link.inertia))[0])
            notes.append(
                f"link {link.name!r}: principal moment of inertia {moment:.3g} kg·m² is rounding; taken as a point mass"
            )
            link = replace(link, inertia=constant(np.zeros((3, 3))))
        kept.append(link)
        why = impossible(link.mass, np.asarray(link.inertia))
        if why is None:
            continue
        if physical or link.mass < 0.0:
            raise InputError(
                f"link {link.name!r}: {why}",
                mend="inertia is meant about the centre of mass; an unphysical model is taken as it stands by "
                "--allow-unphysical and by harness.load(path, physical=False)"
                if link.mass >= 0.0
                else "give a positive mass",
                source=source,
                line=(lines or {}).get(("link", link.name)),
            )
        notes.append(f"link {link.name!r}: {why}; taken as it stands")
    return tuple(kept), tuple(notes)


def check_joints(
    joints: tuple[Joint, ...],
    *,
    physical: bool = True,
    source: Path | None = None,
    lines: Mapping[tuple[str, str], int] | None = None,
) -> tuple[str, ...]:
    """Refuse negative armature, damping and dry friction; with ``physical=False`` tell so in notes instead."""
    notes = []
    for joint in joints:
        for key in ("armature", "damping", "friction"):
            value = getattr(joint, key)
            if value >= 0.0 or np.isnan(value):
                continue
            what = f"joint {joint.name!r}: {key} {value:g} is negative"
            if physical:
                line = (lines or {}).get(("joint", joint.name))
                raise InputError(what, mend="none of these can be", source=source, line=line)
            notes.append(f"{what}; taken as it stands")
    return tuple(notes)


def check_finite(system: System, *, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse NaN anywhere and infinities anywhere but in limits. Raises InputError naming joint or link."""
    lines = lines or {}
    for joint in system.joints:
        followed_by = (joint.axis2, joint.pitch, *((joint.mimic.multiplier, joint.mimic.offset) if joint.mimic else ()))
        values = (*followed_by, joint.xyz, joint.rotation, joint.axis, joint.armature, joint.damping, joint.friction)
        finite = all(np.all(np.isfinite(value)) for value in (*values, joint.stiffness, joint.rest_position))
        if not finite or np.any(np.isnan([joint.lower, joint.upper, joint.effort, joint.velocity])):
            raise _not_finite(system, "joint", joint.name, lines)
    for link in system.links:
        if not all(np.all(np.isfinite(value)) for value in (link.mass, link.com, link.inertia)):
            raise _not_finite(system, "link", link.name, lines)
    if not np.all(np.isfinite(system.gravity)):
        raise InputError("gravity is not finite", mend="give three finite numbers", source=system.source)


def _not_finite(system: System, kind: str, name: str, lines: Mapping[tuple[str, str], int]) -> InputError:
    return InputError(
        f"{kind} {name!r}: a number is NaN or infinite",
        mend="give finite numbers",
        source=system.source,
        line=lines.get((kind, name)),
    )


def check_mimics(system: System, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse joints that follow none, or one another in a circle. Raises InputError naming the joint."""
    for joint in system.joints:
        try:
            followed(system, joint)
        except InputError as error:
            line = (lines or {}).get(("joint", joint.name))
            raise InputError(error.what, mend=error.mend, source=system.source, line=line) from None


def check_loops(system: System, lines: Mapping[tuple[str, str], int] | None = None) -> tuple[str, ...]:
    """Refuse loops that cannot close, contradict one another or leave nothing to move; notes on those that say things twice.

    Raises InputError naming the loop.
    """
    if not system.loops:
        return ()
    # Slow to import, and most systems are trees.
    from harness.system.closure import closed_position, usual_rank

    lines = lines or {}
    names = {link.name for link in system.links} | {system.base}
    taken: set[str] = set()
    for loop in system.loops:
        why, mend = _unfit(system, loop, names, taken)
        if why:
            line = lines.get(("loop", loop.name))
            raise InputError(f"loop {loop.name!r}: {why}", mend=mend, source=system.source, line=line)
        taken.add(loop.name)
    try:
        closed = closed_position(system)
    except InputError as error:
        named = next((loop.name for loop in system.loops if repr(loop.name) in error.what), "")
        line = lines.get(("loop", named))
        raise InputError(error.what, mend=error.mend, source=system.source, line=line) from None
    conditions = sum(len(loop.conditions) for loop in system.loops)
    independent = usual_rank(system, closed)
    if independent >= system.nv:
        last = next(
            loop.name
            for k, loop in enumerate(system.loops)
            if usual_rank(replace(system, loops=system.loops[: k + 1]), closed) >= independent
        )
        raise InputError(
            f"the loops hold everything: {independent} independent conditions on {system.nv} degrees of freedom, of which loop "
            f"{last!r} takes the last",
            mend="leave a motion of it open, or take a loop out",
            source=system.source,
            line=lines.get(("loop", last)),
        )
    counted = f"{len(system.loops)} loop{'s' * (len(system.loops) > 1)}: {conditions} condition{'s' * (conditions > 1)}"
    freedom = system.nv - independent
    moving = f"{freedom} of {system.nv} degrees of freedom {'are' if freedom > 1 else 'is'} left"
    if independent == conditions:
        return (f"{counted}, {'all ' * (conditions > 1)}independent; {moving}",)
    return (
        f"{counted}, {independent} of them independent (rank of their Jacobian); {moving}; what the other "
        f"{conditions - independent} say is said already: motion does not depend on them, constraint forces are the least ones",
    )


def _unfit(system: System, loop: Loop | Coupling, links: set[str], taken: set[str]) -> tuple[str, str]:
    """Why a loop cannot be, and how to mend it; empty if it can."""
    if loop.name in taken:
        return "two loops have this name", "names must be unique; rename one"
    if isinstance(loop, Loop):
        for frame in (loop.first, loop.second):
            if frame.link not in links:
                return f"{frame.link!r} is not a link of this model", did_you_mean(frame.link, sorted(links))
            if not (np.isfinite(frame.xyz).all() and np.isfinite(frame.rotation).all()):
                return "a number is NaN or infinite", "give finite numbers"
        if loop.first.link == loop.second.link:
            return f"both frames are on {loop.first.link!r}", "a loop joins two links"
        return ("", "") if loop.conditions else ("nothing is closed", 'add closed = ["x", "y", "z"]')
    names = [loop.joint] if loop.leader is None else [loop.joint, loop.leader]
    if len(set(names)) < len(names):
        return f"joint {loop.joint!r} is coupled to itself", "name another joint"
    for name in names:
        try:
            joint = system.joint(name)
        except KeyError:
            return f"{name!r} is no joint of this model", did_you_mean(name, list(system.joint_names))
        if joint.mimic is not None:
            return f"joint {name!r} mimics {joint.mimic.joint!r}", f"couple {joint.mimic.joint!r}"
        if len(joint.velocity_names) != 1:
            return f"joint {name!r} has not one degree of freedom", "couple joints that turn or slide"
    return "", ""


def check_dynamics(system: System, *, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse a system without coordinates, or a movable joint with nothing down the tree that resists its motion.

    The articulated-body inertia of every joint (its D of the U D Uᵀ factors, beams frozen) is computed in three poses.
    Raises InputError naming the joint if it is not positive in any, or negative in one.
    """
    check_finite(system, lines=lines)
    check_magnitudes(system, lines=lines)
    if system.loops:
        from harness.system.closure import closed_position, unresisted

        # A massless strut between two bodies resists as they do.
        idle = unresisted(system, closed_position(system))
        if idle is not None:
            raise InputError(
                f"{idle!r} moves no inertia, with the loops closed, so its acceleration is not determined",
                mend="give the links that it moves mass and inertia, or the joint an armature",
                source=system.source,
                line=(lines or {}).get(("joint", idle)),
            )
        return
    if not system.simple:
        # Balls too, as three turns: what moves no inertia does not in any pose.
        system = lower(system).system
    if not system.coordinate_names:
        raise InputError(
            "nothing can move: there is no movable joint and no flexible link",
            mend="add a revolute, continuous or prismatic joint, or let the root of a URDF float by --floating",
            source=system.source,
        )
    found = idle_joint(system)
    if found is not None:
        raise _no_inertia(system, *found, lines)


def idle_joint(system: System) -> tuple[str, str] | None:
    """A joint of a tree of simple joints that moves no inertia, and whether that is zero or negative; None if there is none."""
    rng = np.random.default_rng(20)
    best = {joint.name: -np.inf for joint in system.movable_joints}
    for pose in range(_POSES):
        q = np.zeros(len(best)) if pose == 0 else rng.uniform(-1.0, 1.0, len(best))
        for name, share in _articulated(system, q).items():
            best[name] = -np.inf if share < -_ROUNDING else max(best[name], share)
            if share < -_ROUNDING:
                return name, "is negative"
    # The outermost one is named: joints nearer the base have none because it has none.
    for name, share in reversed(best.items()):
        if share <= _ROUNDING:
            return name, "is zero"
    return None


def _no_inertia(system: System, name: str, how: str, lines: Mapping[tuple[str, str], int] | None) -> InputError:
    joint = system.joint(name)
    along = "along" if joint.prismatic else "about"
    return InputError(
        f"joint {name!r}: inertia {along} its axis {how}, so its acceleration is not determined",
        mend=f"give link {joint.child!r} or what it carries mass and inertia, or the joint an armature",
        source=system.source,
        line=(lines or {}).get(("joint", name)),
    )


def _articulated(system: System, q: Array) -> dict[str, float]:
    """Articulated-body inertia about (along) each movable joint's axis, as a share of its body's inertia."""
    index = {link.name: k for k, link in enumerate(system.links)}
    inertia = [spatial_inertia(link) for link in system.links]
    shares: dict[str, float] = {}
    coordinate = len(q)
    for k in range(len(system.joints) - 1, -1, -1):
        joint = system.joints[k]
        position = 0.0
        body = inertia[k]
        if joint.movable:
            coordinate -= 1
            position = q[coordinate]
            subspace = np.zeros(6)
            rows = slice(3, 6) if joint.prismatic else slice(0, 3)
            subspace[rows] = joint.axis
            u = body @ subspace
            d = float(subspace @ u) + joint.armature
            scale = float(np.trace(body[rows, rows])) + joint.armature
            share = d / scale if scale > 0.0 else (0.0 if d == 0.0 else -np.inf)
            shares[joint.name] = share
            if share > _ROUNDING:
                body = body - np.outer(u, u) / d
        if joint.parent in index:
            x = _to_child(joint, position)
            inertia[index[joint.parent]] = inertia[index[joint.parent]] + x.T @ body @ x
    return shares


def _to_child(joint: Joint, position: float) -> Array:
    """Twist transform from the parent's link frame to the child's, (angular, linear), shape (6, 6)."""
    rotation = np.asarray(joint.rotation)
    origin = np.asarray(joint.xyz)
    if joint.prismatic:
        origin = origin + rotation @ (np.asarray(joint.axis) * position)
    elif joint.movable:
        rotation = rotation @ about_axis(joint.axis, position)
    zero = np.zeros((3, 3))
    return np.block([[rotation.T, zero], [-rotation.T @ skew(origin), rotation.T]])
