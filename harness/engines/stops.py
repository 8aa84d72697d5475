"""Joints with two ends in the native lanes, which know one stop a joint: the end on whose side of the middle the joint is.

A run is taken in stretches; where a joint crosses the middle of its range, the stop is put at its other end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.engines.protocol import Array, EngineError
from harness.errors import UnsupportedError
from harness.system import Stops, System
from harness.system.description import constant
from harness.system.rotation import about_axis

# Positions, velocities and accelerations (T, n) of a run: (sides of the stops (s,), state q and qd, times, forces) -> ...
Run = Callable[[Array, Array, Array, Array, Array | None], tuple[Array, Array, Array]]

# Samples a stretch, at most; and into how many parts the time between two samples may be cut.
_STRETCH, _FINEST = 4096, 4096
# How far beyond the middle a joint has to be for its other stop, and how far it may go between two instants, as a share of half its
# range: both together are less than one, so that no stop is met unseen.
_BEYOND = 0.25
# Laws of a joint that know where it is: moving its zero would move them.
_PLACED = ("cubic_stiffness", "cogging_torque", "end_stop", "backlash", "stop_inertia")
# A stretch begins anew from position and velocity; these laws remember more.
_REMEMBER = ("dahl_friction",)


def refusal(system: System) -> str | None:
    """Why the native runs cannot have this system's stops, or None."""
    for stop in system.stops:
        beside = [a.effect for a in system.attachments if a.site == stop.joint]
        if "end_stop" in beside:
            return f"joint {stop.joint} has an end_stop beside its limits"
        if not stop.lower < 0.0 < stop.upper and any(effect in _PLACED for effect in beside):
            return f"limits of joint {stop.joint}, which do not enclose zero, beside a law of its position"
    for attachment in system.attachments:
        if system.stops and attachment.effect in _REMEMBER:
            return f"limits of joints beside {attachment.effect}"
    return None


def enclosing_zero(system: System) -> tuple[System, Array]:
    """The system with the zeros of joints moved to the middle of their range where that does not enclose zero; by how much, (n,).

    A stop of the lanes bounds the side that its sign points to.
    """
    reason = refusal(system)
    if reason is not None:
        raise UnsupportedError(
            f"the native dynamics has no {reason}", source=system.source, mend="simulate with mujoco"
        )
    shift = np.zeros(len(system.coordinate_names))
    stops: list[Stops] = []
    for stop in system.stops:
        if stop.lower < 0.0 < stop.upper:
            stops.append(stop)
            continue
        middle = 0.5 * (stop.lower + stop.upper)
        shift[system.coordinate_names.index(stop.joint)] = middle
        joint = system.joint(stop.joint)
        if joint.prismatic:
            joint = replace(joint, xyz=constant(joint.xyz + joint.rotation @ joint.axis * middle))
        else:
            joint = replace(joint, rotation=constant(joint.rotation @ about_axis(joint.axis, middle)))
        system = system.replace_joint(replace(joint, rest_position=joint.rest_position - middle))
        stops.append(replace(stop, lower=stop.lower - middle, upper=stop.upper - middle))
    drives = []
    for drive in system.drives:
        moved = shift[system.coordinate_names.index(drive.joint)]
        drives.append(replace(drive, offset=drive.offset - drive.stiffness * moved))
    return replace(system, stops=tuple(stops), drives=tuple(drives)), shift


def run_between(
    run: Run, stops: tuple[Stops, ...], places: Array, q0: Array, qd0: Array, time: Array, tau: Array | None
) -> tuple[Array, Array, Array]:
    """Positions, velocities and accelerations at ``time``, each (T, n), with every joint between its two ends.

    places: column of each stop's joint, shape (s,). EngineError where a joint crosses half its range between two instants.
    """
    middle = np.array([0.5 * (stop.lower + stop.upper) for stop in stops])
    half = np.array([0.5 * (stop.upper - stop.lower) for stop in stops])
    found = [np.empty((len(time), len(q0))) for _ in range(3)]
    at, q, qd, parts = 0, np.array(q0), np.array(qd0), 1
    for kept, value in zip(found, (q, qd), strict=False):
        kept[0] = value
    while at < len(time) - 1 or at == 0:
        last = min(at + max(1, _STRETCH // parts), len(time) - 1)
        sides = np.where(q[places] >= middle, 1.0, -1.0)
        fine = _cut(time[at : last + 1], parts)
        forces = None if tau is None else np.vstack([np.repeat(tau[at:last], parts, axis=0), tau[last : last + 1]])
        position, velocity, acceleration = run(sides, q, qd, fine, forces)
        if not np.all(np.isfinite(position)):
            raise EngineError("denoc: the motion is not finite any more")
        # A joint well beyond the middle has its other end to meet; up to there the stretch holds.
        crossed = ((sides * (position[:, places] - middle)) < -_BEYOND * half).any(axis=1)
        end = int(np.argmax(crossed)) if crossed.any() else len(fine) - 1
        steps = np.abs(np.diff(position[: end + 1][:, places], axis=0))
        if np.any(steps > _BEYOND * half) and parts < _FINEST:
            parts *= 4
            continue
        if np.any(steps > (1.0 - _BEYOND) * half):
            raise EngineError("denoc: a joint crosses half its range between two instants: start more gently")
        whole = -(-end // parts) if end else 0  # the sample at or after the crossing
        reach = min(whole * parts, len(fine) - 1)
        if reach > end:
            # From the crossing on, within one interval of samples, the other end counts.
            tail = run(
                np.where(position[end, places] >= middle, 1.0, -1.0),
                position[end],
                velocity[end],
                fine[end : reach + 1],
                None if forces is None else forces[end : reach + 1],
            )
            for values, rest in zip((position, velocity, acceleration), tail, strict=True):
                values[end : reach + 1] = rest
        for kept, values in zip(found, (position, velocity, acceleration), strict=True):
            kept[at : at + whole + 1] = values[: reach + 1 : parts]
        q, qd = position[reach].copy(), velocity[reach].copy()
        at += whole
        if len(time) == 1:
            break
    return found[0], found[1], found[2]


def _cut(time: Array, parts: int) -> Array:
    """Every interval of the times in equal parts, the times themselves kept exactly."""
    if parts == 1 or len(time) < 2:
        return time
    shares = np.arange(parts) / parts
    inner = time[:-1, None] + np.diff(time)[:, None] * shares[None, :]
    return np.append(inner.ravel(), time[-1])
