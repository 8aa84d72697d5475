"""A recording as the rest of the project sees it: SI, one time axis, channels by name, and what was found in the file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.notebook import frame, html_table
from harness.system.description import Array

JOINT_QUANTITIES = ("position", "velocity", "link_position", "effort", "command")
GIVEN = ("effort", "command")  # inputs, not measured
POSITIONS = ("position", "link_position")  # by the encoder of a joint or its drive, and by one behind the gear
LINK_QUANTITIES = ("tip_deflection", "root_strain", "tip_acceleration")
QUANTITIES = JOINT_QUANTITIES + LINK_QUANTITIES

UNITS = {
    "position": "rad",
    "velocity": "rad/s",
    "link_position": "rad",
    "effort": "N*m",
    "command": "1",
    "tip_deflection": "m",
    "root_strain": "1",
    "tip_acceleration": "m/s**2",
}
# Of joints that turn in space, a column each: the pose of the body against the base, the joint's own coordinates, and velocities.
SHIFTED, TURNED = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
SPATIAL_UNITS = {
    **{f"{kind}.{name}": "m" for kind in ("pose", "position") for name in SHIFTED},
    **{f"{kind}.{name}": "1" for kind in ("pose", "position") for name in TURNED},
    **{f"velocity.v{name}": "m/s" for name in SHIFTED},
    **{f"velocity.w{name}": "rad/s" for name in SHIFTED},
}
UNITS |= SPATIAL_UNITS
LINEAR_UNITS = {"position": "m", "velocity": "m/s", "link_position": "m", "effort": "N"}  # at a prismatic joint


@dataclass(frozen=True, eq=False)
class Channel:
    """One measured or applied signal.

    name: ``site.quantity``; site: joint or link; quantity: one of ``QUANTITIES``; unit: SI, spelt as ``pint`` reads it.
    values: shape (T,), read-only; nan where there is no sample.
    column: header of the column it was read from.
    """

    name: str
    site: str
    quantity: str
    unit: str
    values: Array
    column: str = ""


@dataclass(frozen=True)
class QualityNote:
    """Something found in a recording.

    kind: ``uneven_sampling``, ``gap``, ``unordered_time``, ``repeated_time``, ``rounded_time``, ``missing``, ``outlier``,
        ``wrapped_angle``, ``folded``, ``quantisation``, ``saturation``, ``constant``, ``ignored_column``, ``empty_column``,
        ``cut_off``, ``not_read``, ``packed``, ``fill_value``, ``other_clock``, ``idle_effort``, ``short_effort``,
        ``timing_jitter``, ``stale``, ``carried_start``, ``held_start``, ``carried_end``, ``outside_push``,
        ``rezeroed``, ``other_zero``, ``held_effort``, ``absurd``, ``stamp_pattern``, ``unit``, ``segments``.
    channel: its name, or ``time``. where: windows [s] from the first sample; empty if everywhere.
    count: samples concerned. done: what was done about it. size: a number that goes with it (step, limit, …), SI or nan.
    """

    kind: str
    channel: str
    what: str
    done: str
    count: int = 0
    where: tuple[tuple[float, float], ...] = ()
    size: float = float("nan")

    def words(self) -> str:
        """The note as one line: ``pivot.position: 20 jumps by a turn; made continuous``."""
        place = f"{self.channel}: " if self.channel else ""
        return f"{place}{self.what}; {self.done}" if self.done else f"{place}{self.what}"


@dataclass(frozen=True, eq=False)
class Recording:
    """Measured channels and known efforts over time.

    name: of the file without its endings. source: the file.
    time: [s] from the first sample, ascending, not necessarily even, shape (T,). start: time of the first sample in the file [s].
    clock: the file's column of the time.
    channels: what was measured. efforts: what was applied; an input, not a measurement. commands: what actuators were asked for,
    in the unit of their control.
    """

    name: str
    source: str
    time: Array
    channels: tuple[Channel, ...]
    efforts: tuple[Channel, ...] = ()
    commands: tuple[Channel, ...] = ()
    quality: tuple[QualityNote, ...] = ()
    start: float = 0.0
    clock: str = "time"

    def __repr__(self) -> str:
        names = ", ".join(c.name for c in self.signals)
        return f"<Recording {self.name!r}: {self.samples} samples over {self.duration:.4g} s, {names}>"

    def _repr_html_(self) -> str:
        """Channels with their extent, for notebooks."""
        rows = [
            (
                c.name,
                c.unit,
                float(np.nanmin(c.values)),
                float(np.nanmax(c.values)),
                int(np.isfinite(c.values).sum()),
                c.column,
            )
            for c in self.signals
        ]
        heads = ("channel", "unit", "least", "most", "samples", "column of the file")
        found = "; ".join(f"{note.channel}: {note.what}" for note in self.quality)
        return html_table(
            heads, rows, title=f"{self.name}: {self.samples} samples over {self.duration:.4g} s", note=found
        )

    def to_frame(self) -> Any:
        """A ``pandas.DataFrame``, a column a channel or effort in SI, indexed by time [s]; ImportError where pandas is missing."""
        return frame({"time": self.time, **{c.name: c.values for c in self.signals}}, index="time")

    @property
    def signals(self) -> tuple[Channel, ...]:
        """Everything over time: what was measured, applied and commanded."""
        return (*self.channels, *self.efforts, *self.commands)

    @property
    def samples(self) -> int:
        return len(self.time)

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def interval(self) -> float:
        """Median sampling interval [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def channel_names(self) -> tuple[str, ...]:
        return tuple(channel.name for channel in self.channels)

    def only(self, keep: NDArray[np.bool_], note: QualityNote) -> Recording:
        """The samples to keep (T,), counted from the first of them; the note tells why, and gets the number of the others."""
        first = float(self.time[keep][0])
        return replace(
            self,
            time=self.time[keep] - first,
            channels=tuple(replace(c, values=c.values[keep]) for c in self.channels),
            efforts=tuple(replace(c, values=c.values[keep]) for c in self.efforts),
            commands=tuple(replace(c, values=c.values[keep]) for c in self.commands),
            quality=(*self.quality, replace(note, count=int(np.count_nonzero(~keep)))),
            start=self.start + first,
        )

    def channel(self, name: str) -> Channel:
        """The measured channel, effort or command of that name; KeyError if there is none."""
        for channel in self.signals:
            if channel.name == name:
                return channel
        raise KeyError(name)
