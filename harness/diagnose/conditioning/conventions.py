"""Recordings in other units than they say, or counted from another zero than the model's: seen in how the mechanism accelerates.

Degrees that pass for radians, or milliseconds for seconds, make nonsense of every fit, and so does an angle counted from upright in
a model that hangs at zero. Accelerations read off the recordings tell at once: they follow the model's under one convention, and
under no other. A unit is for the user to state, so a wrong one is refused; a zero that is off by quarter turns is taken off, and a
quality note tells.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.conditioning.constants import (
    ALIKE_ACCELERATIONS,
    DEGREE,
    DOUBTED_COSINE,
    FEWEST_SWINGS,
    FOLLOWED_COSINE,
    MOST_TURNED_JOINTS,
    QUARTER_TURN,
    SAMPLES_A_SWING,
    SMOOTHING_SAMPLES,
)
from harness.diagnose.conditioning.free_motion import motion
from harness.effects.scale import swings
from harness.errors import InputError
from harness.recording.columns import unit_stated
from harness.recording.recording import Channel, QualityNote, Recording
from harness.system import System

Array = NDArray[np.float64]

TIMES = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}
QUARTERS = {1.0: "a quarter turn", 2.0: "half a turn", -1.0: "a quarter turn back"}


@dataclass(frozen=True)
class Convention:
    """Readings times ``angle`` are radians [1], stamps times ``time`` are seconds [1], and zeros (n,) are to be taken off [rad]."""

    angle: float
    time: float
    zeros: tuple[float, ...]


def conventional(system: System, recordings: Sequence[Recording]) -> list[Recording]:
    """Recordings with their angles counted from the model's zero; the same ones where they follow the model as they are.

    Recordings that lack the position of a joint are not judged, nor are mechanisms that nothing pulls back.
    Raises InputError where the readings follow the model in another unit only.
    """
    rigid = system.rigid()
    joints = rigid.joint_names
    turning = [not rigid.joint(name).prismatic for name in joints]
    complete = all(_position(recording, name) is not None for recording in recordings for name in joints)
    stated = Convention(1.0, 1.0, (0.0,) * len(joints))
    if (
        not complete
        or system.loops
        or system.gimbals
        or not any(turning)
        or follows(rigid, recordings, stated) > DOUBTED_COSINE
    ):
        return list(recordings)
    others = list(_others(turning))
    scores = [follows(rigid, recordings, other) for other in others]
    found = others[int(np.argmax(scores))]
    if max(scores) < FOLLOWED_COSINE:
        return list(recordings)
    _refuse_units(recordings[0], joints[turning.index(True)], found)
    return [_counted(recording, dict(zip(joints, found.zeros, strict=True))) for recording in recordings]


def follows(system: System, recordings: Sequence[Recording], convention: Convention) -> float:
    """Cosine between the recordings' accelerations and a rigid model's under a convention; 0 where their sizes are unlike.

    Every joint counts alike. 0, too, where recordings are too short or too coarse to read accelerations off.
    """
    model = Denoc(system)
    turning = np.array([not system.joint(name).prismatic for name in system.joint_names])
    scale = np.where(turning, convention.angle, 1.0)
    period = 2.0 * np.pi / min(swings(system))
    seen, expected = [], []
    for recording in recordings:
        timed = replace(recording, time=recording.time * convention.time)
        step = max(period / SAMPLES_A_SWING, timed.interval)
        if timed.duration < FEWEST_SWINGS * period or period / step < SMOOTHING_SAMPLES:
            continue
        grid = np.arange(0.0, timed.duration, step)
        channels = (_position(timed, name) for name in system.joint_names)
        parts = (motion(timed, channel, grid) for channel in channels if channel is not None)
        q, qd, qdd = (np.stack(part, axis=1) * scale for part in zip(*parts, strict=True))
        tau = np.zeros_like(q)
        for effort in timed.efforts:
            good = np.isfinite(effort.values)
            tau[:, system.joint_names.index(effort.site)] = np.interp(grid, timed.time[good], effort.values[good])
        seen.append(qdd)
        expected.append(model.forward_dynamics_batch(q - np.array(convention.zeros), qd, tau))
    if not seen:
        return 0.0
    a, m = np.concatenate(seen), np.concatenate(expected)
    size = np.linalg.norm(a, axis=0)
    if not (size.all() and np.isfinite(m).all() and m.any()):
        return 0.0
    a, m = a / size, m / size
    ratio = float(np.linalg.norm(m) / np.linalg.norm(a))
    cosine = float(np.sum(a * m)) / float(np.linalg.norm(a) * np.linalg.norm(m))
    return cosine if ALIKE_ACCELERATIONS[0] < ratio < ALIKE_ACCELERATIONS[1] else 0.0


def _others(turning: Sequence[bool]) -> Iterator[Convention]:
    """Conventions that people use, the likelier first."""
    none = (0.0,) * len(turning)
    yield Convention(DEGREE, 1.0, none)
    for factor in TIMES.values():
        yield Convention(1.0, factor, none)
        yield Convention(DEGREE, factor, none)
    if sum(turning) <= MOST_TURNED_JOINTS:
        choices = [(0.0, *(k * QUARTER_TURN for k in QUARTERS)) if turns else (0.0,) for turns in turning]
        for zeros in product(*choices):
            if any(zeros):
                yield Convention(1.0, 1.0, zeros)


def _refuse_units(recording: Recording, joint: str, found: Convention) -> None:
    """Raise InputError if the convention found is one of units."""
    source = recording.source or None
    if found.time != 1.0:
        (unit,) = (name for name, factor in TIMES.items() if factor == found.time)
        raise InputError(
            f"accelerations follow the model if time is in {unit}, and do not if it is in s",
            mend=unit_stated(recording.clock, "time", unit),
            source=source,
            column=recording.clock,
        )
    if found.angle != 1.0:
        channel = _position(recording, joint)
        assert channel is not None
        column = channel.column or channel.name
        raise InputError(
            "accelerations follow the model if the angle is in degrees, and do not if it is in radians",
            mend=unit_stated(column, channel.name, "deg"),
            source=source,
            column=column,
        )


def _position(recording: Recording, joint: str) -> Channel | None:
    """The measured position of a joint."""
    found = (c for c in recording.channels if c.quantity == "position" and c.site == joint)
    return next(found, None)


def _counted(recording: Recording, zeros: Mapping[str, float]) -> Recording:
    """The recording with zeros [rad] taken off its positions; a quality note tells of each."""
    channels, notes = [], []
    for channel in recording.channels:
        zero = zeros.get(channel.site, 0.0) if channel.quantity == "position" else 0.0
        channels.append(replace(channel, values=channel.values - zero) if zero else channel)
        if zero:
            notes.append(
                QualityNote(
                    "other_zero",
                    channel.name,
                    f"accelerations follow the model only with {QUARTERS[zero / QUARTER_TURN]} taken off the angle: it is "
                    "counted from elsewhere, or the base is mounted so",
                    f"{zero:.4g} rad taken off",
                    len(channel.values),
                    size=zero,
                )
            )
    return replace(recording, channels=tuple(channels), quality=(*recording.quality, *notes))
