"""All effects by name, and where in a system and a recording each can sit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache

import numpy as np

from harness.effects.effect import Effect, SiteKind
from harness.effects.lines import lines_of
from harness.effects.measured import Measured
from harness.effects.scale import zero_poses
from harness.errors import InputError
from harness.registered import registered
from harness.system import Actuator, Coupling, Joint, Link, Loop, System
from harness.system.closure import pins
from harness.system.suggest import did_you_mean

NAMES = (
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "load_dependent_friction",
    "quadratic_drag",
    "polynomial_damping",
    "dahl_friction",
    "friction_creep",
    "friction_softness",
    "joint_stiffness",
    "cubic_stiffness",
    "polynomial_stiffness",
    "constant_torque",
    "cogging_torque",
    "end_stop",
    "stop_inertia",
    "backlash",
    "joint_flexibility",
    "loop_clearance",
    "payload_mass",
    "added_inertia",
    "com_offset",
    "com_side_offset",
    "link_inertia",
    "com_displacement",
    "imbalance",
    "transmission_ratio",
    "base_tilt",
    "base_excitation",
    "base_compliance",
    "link_flexibility",
    "modal_damping",
    "higher_mode",
    "flexural_rigidity",
    "geometric_stiffening",
    "sensor_offset",
    "sensor_zero",
    "sensor_gain",
    "sensor_delay",
    "sensor_lowpass",
    "sensor_highpass",
    "sensor_nonlinearity",
    "sensor_drift",
    "sensor_saturation",
    "sensor_hum",
    "encoder_interpolation",
    "clock_skew",
    "late_release",
    "actuator_gain",
    "servo_gain",
    "servo_torque",
    "actuator_delay",
    "actuator_deadzone",
    "actuator_saturation",
)

BENDING_QUANTITIES = ("tip_deflection", "root_strain", "tip_acceleration")
ROUNDING = 1e-9  # m and of a distance; a centre of mass nearer to an axis is on it but for what a file's digits leave
PLUMB = 1e-6  # of gravity; what acts across an axis that stands plumb but for rounding
# Slots of laws that act on a body in space along its velocity or angular velocity.
IN_SPACE = frozenset({"damping", "coulomb_torque", "quadratic_drag"})


@cache
def catalogue() -> Mapping[str, Effect]:
    """Every effect by name, in the order of the documentation; one file of this package each."""
    return registered("harness.effects", NAMES, Effect)


# Effects of the user's own that this process has been given: what a model file says of them is understood from then on.
_OWN: dict[str, Effect] = {}


def register(effects: Iterable[Effect]) -> None:
    """Make effects of the user's own known by name beside the catalogue, for as long as the process lasts."""
    _OWN.update({effect.name: effect for effect in effects if effect.user is not None})


def understood() -> Mapping[str, Effect]:
    """Every effect that this process knows by name: the catalogue and what has been registered."""
    return {**_OWN, **catalogue()}


def effect(name: str) -> Effect:
    """The effect of that name, of the catalogue or registered; InputError, with the nearest name, if there is none."""
    known = understood()
    if name not in known:
        near = did_you_mean(name, known)
        own = "if it is one of your own, load its file: denoc simulate MODEL --effects FILE"
        raise InputError(f"there is no effect {name!r}", mend=f"{near} {own}" if near.endswith("?") else own)
    return known[name]


def sites(effect: Effect, system: System, recording: Measured | None = None) -> tuple[str, ...]:
    """Where the effect can sit: joints, links, channels or ``base``; empty where the recording could not show it.

    Without a recording, dynamics effects are given every site that the system has, sensor and input effects none.
    """
    if not all(_met(need, system, recording) for need in effect.needs):
        return ()
    if effect.site is SiteKind.BASE:
        return ("base",) if system.movable_joints else ()
    if effect.site is SiteKind.JOINT:
        if effect.input is not None:
            driven = {channel.site for channel in recording.efforts} if recording is not None else set()
            return tuple(n for n in system.joint_names if n in driven and _has_servo(effect, system.servos_of(n)))
        return _joints(effect, system)
    if effect.site is SiteKind.LOOP:
        return _followers(system) if "coupling" in effect.needs else _cuts(system)
    if effect.site is SiteKind.LINK:
        return _links(effect, system)
    return _channels(effect, system, recording)


def _has_servo(effect: Effect, servos: Sequence[Actuator]) -> bool:
    """Whether a joint has the servo that an effect needs."""
    if "damped servo" in effect.needs:
        # Without damping, or without stiffness, all that it feeds back is the loop that it is commanded by.
        return any(servo.stiffness and servo.damping for servo in servos)
    return bool(servos) or "servo" not in effect.needs


def _cuts(system: System) -> tuple[str, ...]:
    """Loops that a pin could close."""
    return tuple(loop.name for loop in system.loops if isinstance(loop, Loop) and len(loop.closed) > 1)


def _followers(system: System) -> tuple[str, ...]:
    """Loops by which a joint follows another."""
    return tuple(loop.name for loop in system.loops if isinstance(loop, Coupling) and loop.leader is not None)


def _joints(effect: Effect, system: System) -> tuple[str, ...]:
    """The joints; those that are one in space together as one, and where loops are cut, by laws that act along their velocity."""
    single = tuple(name for name in system.joint_names if system.gimbal_of(name) is None)
    whole = effect.law is not None and set(effect.law.slots) <= IN_SPACE
    return single + ((*(gimbal.name for gimbal in system.gimbals), *pins(system)) if whole else ())


def _met(need: str, system: System, recording: Measured | None) -> bool:
    if need == "stated":
        return False
    if need == "rigid":
        return any(not link.flexible and link.mass > 0.0 for link in system.links)
    if need == "flexible":
        return system.flexible
    if need == "coupling":
        return bool(_followers(system))
    if need == "space":
        return bool(system.gimbals)
    if need == "unstiffened":
        return any(link.beam is not None and not link.beam.geometric_stiffening for link in system.links)
    if need == "exact shapes":
        return any(link.beam is not None and link.beam.shapes != "samples" for link in system.links)
    if recording is None or need in ("axis", "balanced", "servo", "damped servo"):
        return True
    if need == "effort":
        return bool(recording.efforts)
    if need == "free":
        return not recording.efforts
    if need == "deflection":
        return any(channel.quantity in BENDING_QUANTITIES for channel in recording.channels)
    if need in ("motion", "channel", "angle", "line", "several"):
        return bool(recording.channels)
    raise ValueError(f"unknown need {need!r}")


def _links(effect: Effect, system: System) -> tuple[str, ...]:
    found = []
    moving = False
    in_space = {gimbal.child for gimbal in system.gimbals}
    carried: dict[str, bool] = {system.base: False}
    for joint, link in zip(system.joints, system.links, strict=True):
        moving = joint.movable or carried[joint.parent] or link.flexible
        carried[link.name] = moving
        if not moving or link.mass <= 0.0:
            continue
        if ("flexible" in effect.needs and not link.flexible) or ("rigid" in effect.needs and link.flexible):
            continue
        if "unstiffened" in effect.needs and link.beam is not None and link.beam.geometric_stiffening:
            continue
        if "exact shapes" in effect.needs and link.beam is not None and link.beam.shapes == "samples":
            continue
        if ("space" in effect.needs and link.name not in in_space) or (
            "axis" in effect.needs and link.name in in_space
        ):
            continue
        if "balanced" in effect.needs and not _balanced(system, joint, link):
            continue
        found.append(link.name)
    return tuple(found)


def _balanced(system: System, joint: Joint, link: Link) -> bool:
    """Whether a link turns about its own centre of mass by the drawing, and would feel that it does not.

    Beside an axis that stands plumb on what never moves, a weight pulls nowhere.
    """
    if not joint.movable or joint.prismatic or system.gimbal_of(joint.name) is not None:
        return False
    com, axis = np.asarray(link.com), np.asarray(joint.axis)
    if np.linalg.norm(np.cross(axis, com)) > ROUNDING * max(float(np.linalg.norm(com)), ROUNDING):
        return False
    carriers = {j.child: j for j in system.joints}
    behind = joint.parent
    while behind in carriers:
        if carriers[behind].movable or system.link(behind).flexible:
            return True
        behind = carriers[behind].parent
    pull = zero_poses(system)[link.name][0].T @ system.gravity
    return bool(np.linalg.norm(np.cross(axis, pull)) > PLUMB * np.linalg.norm(pull))


def _channels(effect: Effect, system: System, recording: Measured | None) -> tuple[str, ...]:
    if recording is None:
        return ()
    names = []
    for channel in recording.channels:
        if system.gimbal_of(channel.site) is not None and not (effect.sensor and effect.sensor.clock):
            # An angle of a chart is no sensor's reading.
            continue
        if "angle" in effect.needs and (
            channel.quantity != "position"
            or channel.site not in system.joint_names
            or system.joint(channel.site).prismatic
        ):
            continue
        if "line" in effect.needs and not lines_of(system, channel, recording.time):
            continue
        names.append(channel.name)
    if effect.sensor is not None and effect.sensor.every_channel:
        return tuple(names[:1])
    return tuple(names)
