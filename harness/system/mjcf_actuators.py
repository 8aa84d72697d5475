"""What MuJoCo's actuators do at a joint: by their own, and when they are commanded.

Whatever an actuator's kind, its force is asked of the compiled model: at rest, moved, moving and commanded. What is affine in
position and velocity under every command, and in the command, becomes an ``Actuator``; all else (activations, muscles, delays,
tendons, sites) is told. Armature and damping of an actuator act whether it is commanded or not, and belong to its joint. Source:
MuJoCo's documentation, Computation: actuation model.

An actuator has any number of commands and of forces, so that ``nu`` does not count the actuators: ``ctrl`` and what goes with it
begin at ``actuator_ctrladr``, gears and forces at ``actuator_outadr``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.system.description import Actuator, Array

# Small enough for no force range to be reached from rest, large enough for rounding to be far below it.
_PROBE = 1e-3
_STRAIGHT = 1e-6  # relative change of a slope from one probe to a larger one that still counts as none


@dataclass(frozen=True)
class Reflected:
    """What the actuators of a joint add to it without a command: armature, and damping −(a v + b v|v| + c v³)."""

    armature: float = 0.0
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)


def reflected(model: Any, k: int) -> Reflected:
    """Armature and damping at joint k of the actuators that drive it directly.

    Every coefficient of the damping counts with the gear squared, in the joint's own velocity, the quadratic and the cubic too.
    """
    armature, damping = 0.0, np.zeros(3)
    for i in _at_joint(model, k):
        gear = _gear(model, i)
        armature += gear**2 * float(model.actuator_armature[i])
        damping += gear**2 * np.array([model.actuator_damping[i], *model.actuator_dampingpoly[i]])
    return Reflected(armature, (float(damping[0]), float(damping[1]), float(damping[2])))


def _at_joint(model: Any, k: int) -> list[int]:
    """Actuators that drive a joint of one degree of freedom, by number; none of a free or ball joint."""
    import mujoco

    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    if int(model.jnt_type[k]) not in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)):
        return []
    return [
        i
        for i in range(model.nactuator)
        if int(model.actuator_trntype[i]) in kinds and int(model.actuator_trnid[i, 0]) == k
    ]


def _gear(model: Any, i: int) -> float:
    return float(model.actuator_gear[int(model.actuator_outadr[i]), 0])


def actuators(model: Any, names: list[str]) -> tuple[tuple[Actuator, ...], tuple[str, ...]]:
    """The actuators affine in a joint's position and velocity and in the command, and one line for each that is there.

    names: of the joints, in MuJoCo's order.
    """
    import mujoco

    count = int(model.nactuator)
    if not count or model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION):
        return (), (f"{count} actuator(s) left out; actuation is disabled",) if count else ()
    data = mujoco.MjData(model)
    found, notes, silent = [], [], []
    for i in range(count):
        name = model.actuator(i).name or f"actuator{i + 1}"
        k = next((k for k in range(model.njnt) if i in _at_joint(model, k)), None)
        if k is not None and (own := _own_terms(model, i)):
            notes.append(
                f"actuator {name!r} acts on joint {names[k]!r} without a command too, with {own} of its own; the model keeps it"
            )
        if k is None or model.actuator_actnum[i] or model.actuator_ctrlnum[i] > 1 or _delayed(model, i):
            notes.append(f"actuator {name!r} left out: {_why(model, i, k)}")
            continue
        actuator = _affine(mujoco, model, data, i, name, k, names[k])
        if actuator is None:
            notes.append(
                f"actuator {name!r} left out: its force at joint {names[k]!r} is not affine in position, velocity and command"
            )
            continue
        feedback, changing = actuator.feedback_in_words(), actuator.gain_in_words()
        said = " and ".join(
            [f"feedback, acting without a command too: {feedback}"] * bool(feedback) + [changing] * bool(changing)
        )
        if said:
            line = (
                f"actuator {name!r} at joint {actuator.joint!r} has {said}; it acts in `denoc simulate` and `denoc diagnose`, "
                "nowhere else"
            )
            notes.append(line)
            actuator = replace(actuator, note=line)
        elif not _own_terms(model, i):
            silent.append(repr(name))
        found.append(actuator)
    if silent:
        notes.append(f"actuator(s) {', '.join(silent)} do nothing without a command; joint effort is an input here")
    return tuple(found), tuple(notes)


def _own_terms(model: Any, i: int) -> str:
    """What actuator i adds at its joint by damping and armature of its own, in words; empty if nothing."""
    gear = _gear(model, i)
    damping = gear**2 * np.array([model.actuator_damping[i], *model.actuator_dampingpoly[i]])
    terms = [f"{-c:+.4g} · {v}" for c, v in zip(damping, ("v", "v|v|", "v³"), strict=True) if c]
    armature = gear**2 * float(model.actuator_armature[i])
    said = [f"damping {', '.join(terms)} (v: velocity of the joint)"] if terms else []
    return " and ".join(said + ([f"armature {armature:.4g}"] if armature else []))


def _delayed(model: Any, i: int) -> bool:
    return bool(np.any(np.asarray(getattr(model, "actuator_delay", np.zeros(model.nactuator))[i]) != 0.0))


def _why(model: Any, i: int, k: int | None) -> str:
    if k is None:
        return "it acts on no joint of one degree of freedom alone (but a tendon, site, body, free or ball joint)"
    if _delayed(model, i):
        return "it has a delay"
    if model.actuator_actnum[i]:
        return "it has a state of its own (activation, filter, current, integrator)"
    return f"it takes {int(model.actuator_ctrlnum[i])} commands at once"


def _affine(mujoco: Any, model: Any, data: Any, i: int, name: str, k: int, joint: str) -> Actuator | None:
    dof, coordinate = int(model.jnt_dofadr[k]), int(model.jnt_qposadr[k])
    gear, output, commands = _gear(model, i), int(model.actuator_outadr[i]), _commands(model, i)
    at = _unbounded(model, i)

    def force(position: float = 0.0, velocity: float = 0.0, command: float = 0.0) -> float:
        mujoco.mj_resetData(at, data)
        data.qpos[coordinate], data.qvel[dof] = position, velocity
        data.ctrl[commands] = command
        mujoco.mj_forward(at, data)
        return gear * float(data.actuator_force[output])

    offset = force()
    slopes = {}
    for axis in ("position", "velocity", "command"):
        near, far = ((force(**{axis: x}) - offset) / x for x in (_PROBE, 1.0))
        if abs(near - far) > _STRAIGHT * max(abs(near), abs(far)) + 1e-9:
            return None
        slopes[axis] = far
    crossed = {
        axis: force(**{axis: 1.0}, command=1.0) - offset - slopes[axis] - slopes["command"]
        for axis in ("position", "velocity")
    }
    # What rounding leaves of a product that is not there.
    size = _STRAIGHT * (abs(offset) + sum(map(abs, slopes.values())))
    found = Actuator(
        name,
        joint,
        slopes["command"],
        offset,
        -slopes["position"],
        -slopes["velocity"],
        *_range(model, i, gear),
        _command_range(model, i),
        _together(model, k),
        gear=gear,
        gain_position=crossed["position"] if abs(crossed["position"]) > size else 0.0,
        gain_velocity=crossed["velocity"] if abs(crossed["velocity"]) > size else 0.0,
    )
    for position, velocity, command in ((0.7, -0.4, 0.3), (-1.3, 0.9, -0.6)):
        held = replace(found, commands=(-np.inf, np.inf)).commanded(command)
        straight = held.offset - held.stiffness * position - held.damping * velocity
        if abs(force(position, velocity, command) - straight) > size + _STRAIGHT * sum(map(abs, crossed.values())):
            return None
    return found


def _command_range(model: Any, i: int) -> tuple[float, float]:
    """What MuJoCo keeps the command within."""
    import mujoco

    for c in range(model.nu)[_commands(model, i)]:
        if model.actuator_ctrllimited[c] and not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL):
            return float(model.actuator_ctrlrange[c, 0]), float(model.actuator_ctrlrange[c, 1])
    return -np.inf, np.inf


def _together(model: Any, k: int) -> tuple[float, float]:
    """Least and greatest force of all actuators of joint k together."""
    if not model.jnt_actfrclimited[k]:
        return -np.inf, np.inf
    return float(model.jnt_actfrcrange[k, 0]), float(model.jnt_actfrcrange[k, 1])


def _commands(model: Any, i: int) -> slice:
    """Where actuator i has its commands in ``ctrl``; empty for a passive one."""
    first = int(model.actuator_ctrladr[i])
    return slice(first, first + int(model.actuator_ctrlnum[i]))


def _unbounded(model: Any, i: int) -> Any:
    """A copy of the model whose actuator has no range of force or command, nor its joints one of force."""
    import copy

    free = copy.copy(model)
    free.actuator_forcelimited[i] = 0
    free.actuator_ctrllimited[_commands(model, i)] = 0
    free.jnt_actfrclimited[:] = 0
    return free


def _range(model: Any, i: int, gear: float) -> tuple[float, float]:
    """Least and greatest force [N·m or N] of the actuator at its joint."""
    ends: Array = np.array([-np.inf, np.inf])
    if model.actuator_forcelimited[i] and gear != 0.0:
        ends = np.sort(gear * np.asarray(model.actuator_forcerange[i], dtype=np.float64))
    return float(ends[0]), float(ends[1])
