"""What was read behind the gears, recording by recording, apart from what the drives read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from harness.diagnose.transmission.twist import SECOND
from harness.errors import InputError
from harness.recording.recording import Channel, Recording
from harness.system.description import constant

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SecondEncoders:
    """Channels of second encoders, and where they say that links are, by recording.

    motion: positions of links by joint, from the drives' zeros and less the second encoders' own errors, where a joint gives.
    late: by how much each joint's second encoder is, as far as known [s]. cutoff: up to which twists are compared [Hz]; 0 before
    ``links_apart``.
    """

    channels: Sequence[tuple[Channel, ...]]
    motion: Sequence[Mapping[str, Channel]]
    late: Mapping[str, float]
    cutoff: float = 0.0

    def __bool__(self) -> bool:
        return any(self.channels)

    def giving(
        self, recordings: Sequence[Recording], late: Mapping[str, float], gains: Mapping[str, float]
    ) -> SecondEncoders:
        """The same with links where they read; late: of each joint [s]. gains: of the second encoders of those that give."""
        motion = [
            {c.site: _place(r, c, late[c.site], gains[c.site]) for c in channels if c.site in gains}
            for r, channels in zip(recordings, self.channels, strict=True)
        ]
        return replace(self, motion=motion, late=late)


def parted(recordings: Sequence[Recording]) -> tuple[list[Recording], SecondEncoders]:
    """Recordings without what second encoders read, and that.

    Raises InputError where a joint has a second encoder alone.
    """
    for recording in recordings:
        for channel in recording.channels:
            if channel.quantity == SECOND and f"{channel.site}.position" not in recording.channel_names:
                raise InputError(
                    f"{channel.name} is read behind the gear, and nothing says what the drive of {channel.site} reads",
                    mend=f"name it {channel.site}.position, if the joint has one encoder alone",
                    source=recording.source,
                    column=channel.column or channel.name,
                )
    second = tuple(tuple(c for c in r.channels if c.quantity == SECOND) for r in recordings)
    kept = [replace(r, channels=tuple(c for c in r.channels if c.quantity != SECOND)) for r in recordings]
    return kept, SecondEncoders(second, [{} for _ in recordings], {})


def _place(recording: Recording, second: Channel, late: float, gain: float) -> Channel:
    """Where a link is by its encoder, counted from the drive's zero: what it will have read so much later, over its gain."""
    drive = recording.channel(f"{second.site}.position")
    good = np.isfinite(second.values)
    time = np.clip(recording.time + late, recording.time[good][0], recording.time[good][-1])
    values = CubicSpline(recording.time[good], second.values[good])(time) / gain
    values = values + np.nanmean(drive.values - values)
    return replace(drive, values=constant(np.where(np.isfinite(drive.values), values, np.nan)))
