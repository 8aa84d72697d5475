"""Experiments that could be done next on a mechanism: releases, known forces, a further sensor, and what is measured directly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.experiment.constants import (
    DRIVE_FREQUENCIES,
    DRIVE_SHARE,
    LONGER_RATIO,
    RELEASE_ANGLES,
    RELEASE_SHARES,
    SAMPLE_TIME,
    STAYING_ACCELERATION,
    USUAL_AMPLITUDE,
)
from harness.effects.effect import Family
from harness.effects.scale import references
from harness.system import Joint, System

Array = NDArray[np.float64]


# What to measure without the mechanism moving freely, where no recording of it parts rivals.
DIRECTLY = {
    Family.DISSIPATION: "measure the force that just sets the joint moving, and those that keep it moving slowly and fast",
    Family.STIFFNESS: "hold the joint still at several positions and measure the force that this takes",
    Family.INERTIA: "weigh the parts and balance them for their centres of mass",
    Family.BASE: "measure the base's inclination, and whether it gives when it is pushed",
    Family.ELASTICITY: "load the mechanism with a known weight and measure where it gives, and by how much",
    Family.SENSOR: "hold the sensor against a reference: its zero, scale, delay and clock",
    Family.INPUT: "measure the force of the drive by itself",
}


@dataclass(frozen=True, eq=False)
class Trial:
    """An experiment in words, and as the joints' initial positions and velocities (2n,), known forces (T, n) every ``SAMPLE_TIME``
    seconds or none, duration [s], and the link whose tip gets an accelerometer, if any.

    site: the joint that is moved. far: from where it is let go [rad or m], or how fast it is pushed [rad/s or m/s]; 0 if driven.
    """

    what: str
    state: Array
    effort: Array | None
    duration: float
    link: str = ""
    site: str = ""
    far: float = 0.0


def trials(system: System, site: str, duration: float, period: float, extent: float, speed: float) -> list[Trial]:
    """Experiments that move a joint: releases at small, middle and large positions, longer ones, known forces, a further sensor.

    site: the joint. duration: of the recordings at hand [s]; period: of the slowest swing [s]; extent, speed: the largest position
    and velocity of the joint in the recordings. A joint that would stay where it is let go is pushed instead. Nothing goes
    beyond the limits of position and effort that the model states.
    """
    joint = system.joint(site)
    return [
        *_let_go(system, joint, duration, extent, speed),
        *_driven(system, joint, duration, period),
        _with_accelerometer(system, joint, duration, extent),
    ]


def directly(families: Iterable[Family]) -> str:
    """What to measure apart from the mechanism's motion to part effects of these families."""
    return "; or ".join(dict.fromkeys(DIRECTLY[family] for family in families))


def _let_go(system: System, joint: Joint, duration: float, extent: float, speed: float) -> list[Trial]:
    model, found = Denoc(system), []
    for position in _within(joint, [s * extent for s in RELEASE_SHARES] if joint.prismatic else RELEASE_ANGLES):
        if _falls(model, joint, position):
            what = f"release{_of(system, joint)} from {position:.2g} {joint.position_unit}"
            found.append((what, position, _state(system, joint, position, 0.0)))
    if not found:
        for velocity in np.multiply(RELEASE_SHARES, speed):
            what = f"push{_of(system, joint)} by hand to about {velocity:.2g} {joint.position_unit}/s, let go"
            found.append((what, velocity, _state(system, joint, 0.0, velocity)))
    return _recorded(found, joint.name, duration)


def _falls(model: Denoc, joint: Joint, position: float) -> bool:
    """Whether a joint that is let go at rest begins to move."""
    if model.system.loops:
        return True
    names, sizes = model.system.coordinate_names, references(model.system, joint.name)
    at, q = names.index(joint.name), np.zeros(len(names))
    q[at] = position
    acceleration = model.forward_dynamics(q, np.zeros(len(q)))[at]
    return bool(abs(acceleration) > STAYING_ACCELERATION * sizes.torque / sizes.inertia)


def _recorded(begun: Sequence[tuple[str, float, Array]], site: str, duration: float) -> list[Trial]:
    """Each for as long as the recordings at hand, and every other one for longer."""
    longer = LONGER_RATIO * duration
    found = [
        Trial(f"{what} and record for {duration:.0f} s", state, None, duration, site=site, far=far)
        for what, far, state in begun
    ]
    for what, far, state in begun[1::2]:
        found.append(
            Trial(f"{what} and record for {longer:.0f} s, or until rest", state, None, longer, site=site, far=far)
        )
    return found


def _driven(system: System, joint: Joint, duration: float, period: float) -> list[Trial]:
    time = np.arange(0.0, duration + SAMPLE_TIME, SAMPLE_TIME)
    force = min(DRIVE_SHARE * references(system, joint.name).torque, joint.effort)
    kind, unit = ("force", "N") if joint.prismatic else ("torque", "N·m")
    found = []
    for frequency in np.divide(DRIVE_FREQUENCIES, period):
        effort = np.zeros((len(time), len(system.joint_names)))
        effort[:, system.joint_names.index(joint.name)] = force * np.sin(2.0 * np.pi * frequency * time)
        what = f"drive {joint.name} with a known {kind} of {force:.2g} {unit} at {frequency:.2g} Hz"
        found.append(Trial(what, _state(system, joint, 0.0, 0.0), effort, duration, site=joint.name))
    return found


def _with_accelerometer(system: System, joint: Joint, duration: float, extent: float) -> Trial:
    position = float(np.clip(extent if joint.prismatic else USUAL_AMPLITUDE, joint.lower, joint.upper))
    last = system.links[-1].name
    what = (
        f"mount an accelerometer at the tip of {last}, release{_of(system, joint)} from {position:.2g} {joint.position_unit}, "
        f"record {duration:.0f} s"
    )
    return Trial(what, _state(system, joint, position, 0.0), None, duration, last, joint.name, abs(position))


def _of(system: System, joint: Joint) -> str:
    return f" {joint.name}" if len(system.joint_names) > 1 else ""


def _state(system: System, joint: Joint, position: float, velocity: float) -> Array:
    n, at = len(system.joint_names), system.joint_names.index(joint.name)
    state = np.zeros(2 * n)
    state[at], state[n + at] = position, velocity
    return state


def _within(joint: Joint, positions: Iterable[float]) -> list[float]:
    return [p for p in positions if joint.lower <= p <= joint.upper]
