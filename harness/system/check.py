"""Whether a system has dynamics at all: possible bodies, and inertia against every joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.system.description import Array, Joint, Link, System, constant
from harness.system.inertia import about_origin, impossible, rounded_away
from harness.system.lowering import followed, lower
from harness.system.magnitudes import check_magnitudes
from harness.system.rotation import about_axis, skew

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


def check_dynamics(system: System, *, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse a system without coordinates, or a movable joint with nothing down the tree that resists its motion.

    The articulated-body inertia of every joint (its D of the U D Uᵀ factors, beams frozen) is computed in three poses.
    Raises InputError naming the joint if it is not positive in any, or negative in one.
    """
    check_finite(system, lines=lines)
    check_magnitudes(system, lines=lines)
    if not system.simple:
        # Balls too, as three turns: what moves no inertia does not in any pose.
        system = lower(system).system
    if not system.coordinate_names:
        raise InputError(
            "nothing can move: there is no movable joint and no flexible link",
            mend="add a revolute, continuous or prismatic joint",
            source=system.source,
        )
    rng = np.random.default_rng(20)
    best = {joint.name: -np.inf for joint in system.movable_joints}
    for pose in range(_POSES):
        q = np.zeros(len(best)) if pose == 0 else rng.uniform(-1.0, 1.0, len(best))
        for name, share in _articulated(system, q).items():
            best[name] = -np.inf if share < -_ROUNDING else max(best[name], share)
            if share < -_ROUNDING:
                raise _no_inertia(system, name, "is negative", lines)
    # The outermost one is named: joints nearer the base have none because it has none.
    for name, share in reversed(best.items()):
        if share <= _ROUNDING:
            raise _no_inertia(system, name, "is zero", lines)


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
    inertia = [_spatial_inertia(link) for link in system.links]
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


def _spatial_inertia(link: Link) -> Array:
    """Generalized inertia matrix of a link about its origin, (angular, linear), shape (6, 6)."""
    first = link.mass * skew(link.com)
    return np.block([[about_origin(link), first], [first.T, link.mass * np.eye(3)]])


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
