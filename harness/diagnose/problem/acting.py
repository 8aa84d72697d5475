"""What of a model acts in a diagnosis: its actuators under recorded or held commands, limits that are reached, joints that follow.

Where a joint's effort is recorded, that is all that is applied there, and its actuators are left out. A recorded command comes as
the effort that it asks for; what the actuator then feeds back belongs to the mechanism.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.cases.acting import bounded, driven, has_range, idle
from harness.diagnose.problem.constants import HELD_EXTENT, NEAR_LIMIT_SHARE, PAST_LIMIT_SHARE
from harness.errors import InputError, UnsupportedError
from harness.recording import Recording
from harness.recording.recording import LINEAR_UNITS, UNITS, Channel, QualityNote
from harness.system import Actuator, Joint, JointType, System
from harness.system.description import constant
from harness.system.loop import Coupling, explicit
from harness.system.lowering import followed
from harness.system.rotation import about_axis

Array = NDArray[np.float64]
Polynomial = np.polynomial.Polynomial
Follower = tuple[str, str | None, Polynomial]


def acting(
    system: System, recordings: Sequence[Recording], *, actuators: bool = True, limits: bool = True
) -> tuple[System, list[Recording]]:
    """The system with its actuators and limits in it, as far as the recordings meet them, and the recordings with what drives them.

    The system's notes tell what acts and what does not. Raises InputError where commands are recorded in some of the recordings
    only, and UnsupportedError for several actuators with ranges of force at one joint and for weight carried of single bodies.
    """
    found = list(recordings)
    lifted = [link.name for link in system.links if link.gravcomp]
    if lifted:
        raise UnsupportedError(
            f"gravcomp carries weight of some bodies and not of others ({', '.join(lifted[:3])}), which a diagnosis does not hold",
            mend="simulate and validate do; give all that moves one gravcomp, or none",
            source=system.source,
        )
    if actuators and system.actuators:
        system, found = _driven(system, found)
    elif not actuators:
        system = idle(system)
    if limits:
        system = _limited(system, found)
    return system, found


def coupled(stated: System, system: System, recordings: Sequence[Recording]) -> tuple[System, list[Recording]]:
    """The system with joints that follow another coupled to it where they move, and fixed where all are still; notes tell.

    stated: the same as the file says which joint follows which, or is a polynomial of which; in ``system`` none mimics another.
    Raises UnsupportedError where a joint moves that the file locks.
    """
    found = list(recordings)
    followers = _followers(stated)
    moving = _that_move(system, followers, found)
    held: dict[str, float] = {}
    for name, leader, polynomial in followers:
        if name in moving:
            continue
        place = 0.0
        if leader is not None:
            known = held.get(leader)
            if known is None:
                known = _place(system.joint(leader), found)
            if known is None and (own := _place(system.joint(name), found)) is not None:
                known = _nearest_root(polynomial - own)
            place = held[leader] = 0.0 if known is None else known
        held[name] = float(polynomial(place))
    told = []
    for name, position in held.items():
        joint = system.joint(name)
        seen = any(c.site == name and c.quantity == "position" for r in found for c in r.channels)
        why = "is still in the recordings" if seen else "is in no recording"
        told.append(
            f"joint {name!r} {why}, of those that follow one another; it is held at {position:.4g} {_unit(joint)}"
        )
        system = system.replace_joint(_fixed(joint, position))
        found = [_without(recording, name) for recording in found]
    # Where all loops are such followers, those that are held are none any more.
    couplings = explicit(stated.loops)
    loops = [loop for loop in couplings if loop.joint in moving] if couplings else list(system.loops)
    by_loops = {loop.joint for loop in couplings}
    for name, leader, polynomial in followers:
        if name in moving - by_loops and leader is not None:
            loops.append(_coupling(name, leader, polynomial, {loop.name for loop in loops}))
    return replace(system, loops=tuple(loops), notes=(*stated.notes, *told)), found


def _that_move(system: System, followers: Sequence[Follower], recordings: Sequence[Recording]) -> set[str]:
    """Joints of those that follow one another, of which one moves; UnsupportedError where a locked one does."""
    together: dict[str, set[str]] = {}
    for name, leader, _ in followers:
        joined = together.get(name, {name}) | (together.get(leader, {leader}) if leader is not None else set())
        together |= dict.fromkeys(joined, joined)
    moving = {name for name in together if _moves(system.joint(name), recordings)}
    for name, leader, _ in followers:
        if leader is None and together[name] & moving:
            raise UnsupportedError(
                f"joint {name!r} is locked by the model, and {', '.join(sorted(together[name] & moving))} moves in the recordings",
                mend="give the model without that <equality>, or another joint's columns",
                source=system.source,
            )
    return set().union(*(together[name] for name in moving))


def _coupling(joint: str, leader: str, polynomial: Polynomial, taken: set[str]) -> Coupling:
    """A joint that follows another as a loop of its own, by the joint's name if no other loop has it."""
    name = joint
    while name in taken:
        name += "_"
    first, second, third, fourth, fifth = (float(value) for value in [*polynomial.coef, 0.0, 0.0, 0.0, 0.0][:5])
    return Coupling(name, joint, leader, (first, second, third, fourth, fifth))


def _followers(stated: System) -> list[Follower]:
    """Joints that follow others, by whom, and as which polynomial of its position; who is followed comes first."""
    found: list[Follower] = [
        (coupling.joint, coupling.leader, Polynomial(coupling.coefficients)) for coupling in explicit(stated.loops)
    ]
    for joint in stated.movable_joints:
        if joint.mimic is not None:
            leader, multiplier, offset = followed(stated, joint)
            found.append((joint.name, leader, Polynomial([offset, multiplier])))
    return found


def _nearest_root(polynomial: Polynomial) -> float | None:
    """The real root nearest to zero, if there is one."""
    roots = np.asarray(polynomial.trim().roots(), dtype=np.complex128)
    real = [float(root.real) for root in roots if abs(root.imag) < 1e-6 * (1.0 + abs(root))]
    return min(real, key=abs, default=None)


def feedback(system: System, q: Array, qd: Array, effort: Array | None) -> Array:
    """What actuators with ranges of force apply at the joints beside ``effort``, (T, n), along a motion q, qd (T, n)."""
    total = np.zeros_like(q)
    for drive in system.drives:
        k = system.joint_names.index(drive.joint)
        asked = effort[:, k] if drive.gain and effort is not None else 0.0
        total[:, k] += (
            _within(drive, asked + drive.offset - drive.stiffness * q[:, k] - drive.damping * qd[:, k]) - asked
        )
    return total


def _driven(system: System, recordings: list[Recording]) -> tuple[System, list[Recording]]:
    applied = {effort.site for recording in recordings for effort in recording.efforts}
    commanded: dict[str, Actuator] = {}
    held: dict[str, float] = {}
    for actuator in system.actuators:
        having = [recording for recording in recordings if _command(recording, actuator) is not None]
        if not having or actuator.joint in applied:
            continue
        if len(having) < len(recordings):
            lacking = next(recording for recording in recordings if recording not in having)
            raise InputError(
                f"has no command of actuator {actuator.name!r}, which {having[0].name} has",
                mend=f"give it as {actuator.joint}.command, or leave the actuators out: --no-actuators",
                source=lacking.source,
            )
        if actuator.varying:
            held[actuator.name] = _constant_command(having, actuator, system)
        else:
            commanded[actuator.name] = actuator
    whole, driving = driven(system, held, applied, commanded)
    several = [drive.joint for drive in whole.drives]
    for joint in several:
        if several.count(joint) > 1:
            raise UnsupportedError(
                f"several actuators of joint {joint!r} have ranges of force, which a diagnosis does not hold",
                mend="record the joint's effort, or leave the actuators out: --no-actuators",
                source=system.source,
            )
    told = tuple(
        f"{each.said}: no recording has its command ({each.actuator.joint}.command); --no-actuators if it was off"
        if each.held is not None and each.actuator.name not in held
        else each.said
        for each in driving
    )
    found = [_pushed(recording, system, list(commanded.values())) for recording in recordings]
    # A command is in the effort now; a drive without feedback is no more than that.
    drives = tuple(d for d in whole.drives if d.stiffness or d.damping or d.name not in commanded)
    return replace(whole, drives=drives, notes=(*_still_true(system), *told)), found


def _constant_command(recordings: Sequence[Recording], actuator: Actuator, system: System) -> float:
    """The one command that an actuator with a gain that changes with the motion has; UnsupportedError if it has several."""
    channels = [_command(recording, actuator) for recording in recordings]
    values = np.concatenate([channel.values for channel in channels if channel is not None])
    if np.ptp(values):
        raise UnsupportedError(
            f"the gain of actuator {actuator.name!r} changes with the motion, and its command with time: a diagnosis holds such a "
            "drive under one constant command alone",
            mend=f"record the effort of joint {actuator.joint!r}, or leave the actuators out: --no-actuators",
            source=system.source,
        )
    return float(values[0])


def _still_true(system: System) -> tuple[str, ...]:
    """Notes of reading without those that say of an actuator what acts here otherwise."""
    otherwise = {actuator.note for actuator in system.actuators}
    return tuple(note for note in system.notes if note not in otherwise)


def _command(recording: Recording, actuator: Actuator) -> Channel | None:
    for site in (actuator.name, actuator.joint):
        for channel in recording.commands:
            if channel.site == site:
                return channel
    return None


def _pushed(recording: Recording, system: System, commanded: Sequence[Actuator]) -> Recording:
    """The recording with the efforts that the commands of some actuators ask for, summed by joint."""
    efforts: dict[str, Array] = {}
    for actuator in commanded:
        channel = _command(recording, actuator)
        assert channel is not None
        asked = actuator.gain * np.clip(channel.values, *actuator.commands)
        if not (actuator.stiffness or actuator.damping):
            asked = _within(actuator, asked + actuator.offset)
        efforts[actuator.joint] = efforts.get(actuator.joint, 0.0) + asked
    if not efforts:
        return recording
    channels = tuple(
        Channel(
            f"{joint}.effort",
            joint,
            "effort",
            (LINEAR_UNITS if system.joint(joint).prismatic else UNITS)["effort"],
            constant(values),
            f"{joint}.command",
        )
        for joint, values in efforts.items()
    )
    return replace(recording, efforts=(*recording.efforts, *channels))


def _within(actuator: Actuator, force: Array) -> Array:
    low, high = max(actuator.lower, actuator.together[0]), min(actuator.upper, actuator.together[1])
    return np.asarray(np.clip(force, low, high))


def _limited(system: System, recordings: Sequence[Recording]) -> System:
    """The system with those limits acting that the file states as stops and that a recording meets; notes tell of all it meets."""
    stated = {stop.joint for stop in system.limits}
    acting, through, told = [], set(), []
    for joint in system.movable_joints:
        if not has_range(joint):
            continue
        courses = _courses(joint, recordings)
        if not courses:
            continue
        low, high = (float(f([f(values) for values in courses])) for f in (np.nanmin, np.nanmax))
        extent = joint.upper - joint.lower
        for end, beyond in ((joint.lower, joint.lower - low), (joint.upper, high - joint.upper)):
            if beyond < -NEAR_LIMIT_SHARE * extent:
                continue
            where = f"joint {joint.name!r}, recorded from {low:.4g} to {high:.4g} {_unit(joint)}"
            if beyond > PAST_LIMIT_SHARE * extent:
                through.add(joint.name)
                told.append(f"{where}, runs through its limit of {end:.4g}: it does not act")
            elif joint.name in stated:
                acting.append(joint.name)
                told.append(f"{where}, meets its limit of {end:.4g}, which acts as the file says")
            else:
                told.append(f"{where}, meets its limit of {end:.4g}: the file says of no stop there, none acts")
    system = replace(system, notes=(*system.notes, *told))
    reached = [name for name in acting if name not in through]
    return bounded(system, reached) if reached else system


def _courses(joint: Joint, recordings: Sequence[Recording]) -> list[Array]:
    """A joint's recorded positions, recording by recording."""
    return [c.values for r in recordings for c in r.channels if c.site == joint.name and c.quantity == "position"]


def _place(joint: Joint, recordings: Sequence[Recording]) -> float | None:
    courses = _courses(joint, recordings)
    return float(np.nanmedian(np.concatenate(courses))) if courses else None


def _moves(joint: Joint, recordings: Sequence[Recording]) -> bool:
    courses = _courses(joint, recordings)
    pushed = any(np.any(c.values) for r in recordings for c in (*r.efforts, *r.commands) if c.site == joint.name)
    return pushed or any(np.nanmax(values) - np.nanmin(values) > HELD_EXTENT[_unit(joint)] for values in courses)


def _unit(joint: Joint) -> str:
    return "m" if joint.prismatic else "rad"


def _fixed(joint: Joint, position: float) -> Joint:
    """The joint welded where it is."""
    welded = replace(joint, type=JointType.FIXED, mimic=None, armature=0.0, damping=0.0, friction=0.0, stiffness=0.0)
    if joint.prismatic:
        return replace(welded, xyz=constant(joint.xyz + joint.rotation @ joint.axis * position))
    return replace(welded, rotation=constant(joint.rotation @ about_axis(joint.axis, position)))


def _without(recording: Recording, joint: str) -> Recording:
    """The recording without the columns of a joint that is fixed."""
    lost = [c.name for c in recording.signals if c.site == joint]
    if not lost:
        return recording
    notes = tuple(QualityNote("ignored_column", name, "is of a joint that is held", "left out") for name in lost)
    return replace(
        recording,
        channels=tuple(c for c in recording.channels if c.site != joint),
        efforts=tuple(c for c in recording.efforts if c.site != joint),
        commands=tuple(c for c in recording.commands if c.site != joint),
        quality=(*recording.quality, *notes),
    )
