"""Recorded poses of bodies that turn in space as angles and shifts of the joints that a diagnosis works with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.conditioning.constants import NO_QUATERNION_LENGTH, UNIT_QUATERNION_ERROR
from harness.errors import InputError, UnsupportedError
from harness.recording import Recording
from harness.recording.recording import Channel, QualityNote
from harness.system import Joint, JointType, System
from harness.system.charted import SHIFTS, TURNS, Chart, chart_for, charted, turning
from harness.system.description import constant

Array = NDArray[np.float64]

QUATERNION = ("qw", "qx", "qy", "qz")


def in_charts(system: System, recordings: Sequence[Recording]) -> tuple[System, list[Recording]]:
    """The system with balls and free joints taken apart, and the recordings with their angles and shifts in place of poses.

    The same ones where no joint turns in space. Raises InputError where a pose is not recorded whole, or a quaternion has no
    length, and UnsupportedError for rotations that no chart holds.
    """
    found = list(recordings)
    charts: dict[str, Chart] = {}
    for joint in turning(system):
        rotations = [_rotations(recording, joint, system) for recording in found]
        chart = chart_for(np.concatenate(rotations))
        if chart is None:
            raise UnsupportedError(
                f"{joint.name!r} turns every way in the recordings, and no three angles hold that",
                mend="diagnose shorter parts of the recordings",
                source=system.source,
            )
        charts[joint.name] = chart
        found = [_with_angles(one, joint, chart, turns, system) for one, turns in zip(found, rotations, strict=True)]
    return charted(system, charts), found


def _kind(recording: Recording, joint: Joint) -> str:
    """Whether the body's pose or the joint's position is recorded."""
    seen = {c.quantity.partition(".")[0] for c in recording.channels if c.site == joint.name}
    return "position" if "position" in seen else "pose"


def _channel(recording: Recording, joint: Joint, component: str) -> Channel:
    kind = _kind(recording, joint)
    for channel in recording.channels:
        if channel.site == joint.name and channel.quantity == f"{kind}.{component}":
            return channel
    raise InputError(
        f"has no {component} of the pose of joint {joint.name!r}",
        mend=f"columns {joint.child}.pose.{component}, or {joint.name}.position.{component}",
        source=recording.source or None,
    )


def _seat(recording: Recording, joint: Joint, system: System) -> tuple[Array, Array]:
    """Rotation (3, 3) and origin (3,) of the frame in which the joint's coordinates are what is recorded, in the recording's."""
    turn, origin = np.eye(3), np.zeros(3)
    if _kind(recording, joint) == "position":
        return turn, origin
    below = joint
    while True:
        turn, origin = below.rotation @ turn, below.xyz + below.rotation @ origin
        if below.parent == system.base:
            return turn, origin
        below = system.carrier(below.parent)
        if below.movable:
            raise InputError(
                f"the pose of {joint.child!r} is one against the base, and joint {below.name!r} moves between them",
                mend=f"record {joint.name}.position.qw …, what the joint itself turns by",
                source=recording.source or None,
            )


def _rotations(recording: Recording, joint: Joint, system: System) -> Array:
    """Rotations (T, 3, 3) of the joint, nan where there is none."""
    columns = [_channel(recording, joint, component) for component in QUATERNION]
    q = np.stack([channel.values for channel in columns], axis=1)
    length = np.linalg.norm(q, axis=1)
    none = np.flatnonzero(length < NO_QUATERNION_LENGTH)
    if len(none):
        raise InputError(
            f"the quaternion of joint {joint.name!r} has length zero at {recording.time[none[0]]:.6g} s",
            mend="leave the cells empty where there is no pose, and name the scalar part qw",
            source=recording.source or None,
            column=columns[0].column or columns[0].name,
        )
    w, x, y, z = (q / length[:, None]).T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.asarray(_seat(recording, joint, system)[0].T @ np.moveaxis(np.array(rows), 2, 0))


def _with_angles(recording: Recording, joint: Joint, chart: Chart, rotations: Array, system: System) -> Recording:
    own = [c for c in recording.channels if c.site == joint.name]
    kept = [c for c in recording.channels if c.site != joint.name]
    angles = chart.angles(rotations)
    made = [_made(f"{joint.name}.{name}", "rad", angles[:, k]) for k, name in enumerate(TURNS)]
    if joint.type is JointType.FREE:
        turn, origin = _seat(recording, joint, system)
        place = np.stack([_channel(recording, joint, name).values for name in SHIFTS], axis=1)
        shifts = ((place - origin) @ turn).T
        made = [_made(f"{joint.name}.{name}", "m", s) for name, s in zip(SHIFTS, shifts, strict=True)] + made
    notes: list[QualityNote] = []
    length = np.linalg.norm([_channel(recording, joint, component).values for component in QUATERNION], axis=0)
    off = float(np.nanmax(np.abs(length - 1.0)))
    if off > UNIT_QUATERNION_ERROR:
        notes.append(
            QualityNote("pose", joint.name, f"quaternions differ from length 1 by up to {off:.2g}", "made so long")
        )
    rates = [c.name for c in own if c.quantity.startswith("velocity.")]
    if rates:
        notes.append(QualityNote("ignored_column", joint.name, "its pose is what is fitted", "velocities left out"))
    return replace(recording, channels=(*kept, *made), quality=(*recording.quality, *notes))


def _made(site: str, unit: str, values: Array) -> Channel:
    return Channel(f"{site}.position", site, "position", unit, constant(values), site)
