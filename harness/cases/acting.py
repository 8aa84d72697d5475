"""What of a model acts in a single run: its drives under the commands of a keyframe, and the limits that the motion reaches."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.cases.case import Array
from harness.denoc import Denoc
from harness.errors import InputError
from harness.system import Actuator, Joint, Keyframe, Stops, System
from harness.system.actuated import sprung
from harness.system.lowering import followed
from harness.system.magnitudes import check_start
from harness.system.soft_constraints import FAR, SOLIMP, SOLREF, limit_law
from harness.system.suggest import did_you_mean

SAME_PLACE = 1e-6  # [rad or m], of what files round


def keyframe(system: System, name: str) -> Keyframe:
    """The keyframe of that name; InputError if there is none, or it is beyond any mechanism. ``qpos0`` is zero but in an MJCF."""
    for frame in system.keyframes:
        if frame.name == name:
            check_start(system, frame.position, "", f"keyframe {name!r}", system.source)
            check_start(system, frame.velocity, "/s", f"keyframe {name!r}", system.source)
            return _without_followers(system, frame)
    if name == "qpos0":
        return Keyframe(name, {}, {}, {})
    left_out = next((note for note in system.notes if note.startswith(f"keyframe {name!r} left out: ")), None)
    if left_out is not None:
        raise InputError(
            left_out.replace(" left out: ", ": "), source=system.source, mend="mend the <key> of that name"
        )
    known = [frame.name for frame in system.keyframes] or ["qpos0"]
    raise InputError(f"no keyframe is named {name!r}", source=system.source, mend=did_you_mean(name, known))


def _without_followers(system: System, frame: Keyframe) -> Keyframe:
    """The keyframe of independent joints alone: those that follow others are where these have them."""
    position, velocity, told = dict(frame.position), dict(frame.velocity), []
    for joint in system.movable_joints:
        if joint.mimic is None or joint.name not in position:
            continue
        leader, multiplier, offset = followed(system, joint)
        stated, there = position.pop(joint.name), multiplier * frame.position.get(leader, 0.0) + offset
        velocity.pop(joint.name, None)
        if abs(stated - there) > SAME_PLACE:
            where = f"keyframe {frame.name!r} has joint {joint.name!r} at {stated:.4g} {joint.position_unit}"
            told.append(f"{where}; it follows joint {leader!r} and begins at {there:.4g}")
    return replace(frame, position=position, velocity=velocity, notes=tuple(told))


@dataclass(frozen=True)
class Driving:
    """How one actuator acts, or why it does not.

    held: its command where that is held, None where it is recorded or the actuator left out. said: that in words.
    """

    actuator: Actuator
    held: float | None
    said: str


def driven(
    system: System, command: Mapping[str, float], without: Collection[str] = (), recorded: Collection[str] = ()
) -> tuple[System, tuple[Driving, ...]]:
    """The system with its actuators acting under held commands, and how each does that acts, or would.

    command: by actuator, 0 where absent. without: joints whose effort is an input already. recorded: actuators whose command comes
    as the effort that it asks for: they keep their gain.
    A drive without a range of force is a spring and a damper of its joint.
    """
    told: list[Driving] = []
    drives, servos = [], []
    for stated in system.actuators:
        feedback = stated.feedback_in_words()
        where = f"actuator {stated.name!r} acts on joint {stated.joint!r}" + (f" with {feedback}" if feedback else "")
        acting, held = stated, None
        if stated.joint in without:
            said = f"actuator {stated.name!r} is left out: the effort of joint {stated.joint!r} is given"
            told.append(Driving(stated, None, said))
            continue
        if stated.name in recorded:
            said = f"{where} by its recorded command"
        else:
            asked = command.get(stated.name, 0.0)
            low, high = stated.commands
            acting, held = stated.commanded(asked), min(max(asked, low), high)
            if not (acting.offset or acting.stiffness or acting.damping):
                continue
            kept = "" if held == asked else f", where its range of {low:g} … {high:g} keeps {asked:g}"
            said = f"{where}, its command held at {held:g}{kept}"
        told.append(Driving(stated, held, said))
        if _is_spring(acting):
            system = system.replace_joint(sprung(system.joint(stated.joint), acting))
            servos.append(acting)
        else:
            drives.append(acting)
    return replace(system, drives=tuple(drives), servos=tuple(servos)), tuple(told)


def idle(system: System) -> System:
    """The system without its actuators, as asked; its notes say so of those that would act by themselves."""
    acting = {actuator.note: actuator for actuator in system.actuators if actuator.note}
    notes = (f"actuator {acting[n].name!r} is left out, as asked" if n in acting else n for n in system.notes)
    return replace(system, actuators=(), notes=tuple(notes))


def _is_spring(drive: Actuator) -> bool:
    bounded = np.isfinite([drive.lower, drive.upper, *drive.together]).any()
    return not bounded and drive.damping >= 0.0 and (drive.stiffness > 0.0 or (drive.stiffness == drive.offset == 0.0))


def bounded(system: System, only: Collection[str] | None = None) -> System:
    """The system with the limits of its joints acting, as softly as its file says or as MuJoCo's defaults are.

    only: the joints whose limits act; all by default.
    """
    stated = {stop.joint: stop for stop in system.limits}
    stops = []
    inverse = None
    for joint in system.movable_joints:
        ends = _ends(joint)
        if ends is None or (only is not None and joint.name not in only):
            continue
        if joint.name in stated:
            stops.append(stated[joint.name])
            continue
        if inverse is None:
            model = Denoc(system)
            inverse = np.linalg.inv(model.mass_matrix(model.neutral))
        k = system.coordinate_names.index(joint.name)
        law = limit_law(SOLREF, SOLIMP[:2], float(inverse[k, k]))
        stops.append(Stops(joint.name, *ends, *law))
    return replace(system, stops=tuple(stops))


def has_range(joint: Joint) -> bool:
    """Whether a joint has limits at both ends, one position and one below the other."""
    own = len(joint.position_names) == 1
    return bool(own and np.isfinite(joint.lower) and np.isfinite(joint.upper) and joint.lower < joint.upper)


def _ends(joint: Joint) -> tuple[float, float] | None:
    """Where the range of a joint of its own ends [rad or m], far away at an end that has no limit; None without any."""
    if len(joint.position_names) != 1 or not _limited(joint):
        return None
    return max(joint.lower, -FAR), min(joint.upper, FAR)


def _limited(joint: Joint) -> bool:
    return bool((np.isfinite(joint.lower) or np.isfinite(joint.upper)) and joint.lower < joint.upper)


def can_be_reached(system: System) -> bool:
    """Whether any joint, of its own or following another, has a limit."""
    return any(_ends(joint) or (joint.mimic is not None and _limited(joint)) for joint in system.movable_joints)


def without_room(system: System) -> tuple[str, ...]:
    """One line for each joint whose limits are one position: as in MuJoCo they do not act."""
    shut = (joint for joint in system.movable_joints if np.isfinite(joint.lower) and joint.lower == joint.upper)
    return tuple(
        f"joint {joint.name!r}: its limits leave no room ({joint.lower:g} … {joint.upper:g}) and do not act"
        for joint in shut
    )


def reached(system: System, names: tuple[str, ...], time: Array, position: Array) -> tuple[str, ...]:
    """One line for each joint that a motion takes to its limits, and when; position (T, n), columns by ``names``."""
    lines: list[str] = []
    for joint in system.movable_joints:
        if _ends(joint) is not None:
            lines += _first_beyond(joint, time, position[:, names.index(joint.name)])
    if not system.limits_act:
        lines = [f"{line}, and runs through it: the file switches limits off" for line in lines]
    return tuple(lines)


def passed(system: System, names: tuple[str, ...], time: Array, position: Array) -> tuple[str, ...]:
    """The same of joints that follow others, whose limits do not act."""
    lines = []
    for joint in system.movable_joints:
        if joint.mimic is not None and _limited(joint):
            leader, multiplier, offset = followed(system, joint)
            course = multiplier * position[:, names.index(leader)] + offset
            told = f", and runs through it: it follows joint {leader!r}, whose limits alone act"
            lines += [line + told for line in _first_beyond(joint, time, course)]
    return tuple(lines)


def _first_beyond(joint: Joint, time: Array, course: Array) -> list[str]:
    """When a course of positions first leaves the joint's range; nothing where it does not."""
    beyond = (course > joint.upper) | (course < joint.lower)
    if not beyond.any():
        return []
    first = int(np.argmax(beyond))
    limit = joint.upper if course[first] > joint.upper else joint.lower
    return [f"joint {joint.name!r} reaches its limit of {limit:.4g} {joint.position_unit} at {time[first]:.4g} s"]
