"""What every reader gives: named columns of numbers, whatever the format."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.recording import QualityNote
from harness.system.description import Array

NOT_READ = "not_read"


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of equal length by header, nan where a cell is empty.

    units: by header, where the format itself states them. lines: line of each row in a text file, else None.
    faults: by header, why a column is none of numbers; it matters only if the column is wanted.
    aliases: by header, another name that does. interleaved: whether rows of several clocks follow one another.
    origins: by header, what was taken off every value of a column of time stamps, which a double does not hold to the digit.
    notes: what reading had to do.
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    lines: tuple[int, ...] | None = None
    faults: Mapping[str, InputError] = field(default_factory=dict)
    origins: Mapping[str, float] = field(default_factory=dict)
    aliases: Mapping[str, str] = field(default_factory=dict)
    interleaved: bool = False
    notes: tuple[QualityNote, ...] = ()

    @property
    def rows(self) -> int:
        return max((len(values) for values in self.columns.values()), default=0)

    @property
    def unread(self) -> dict[str, str]:
        """What else the file holds by name, and why it is no column."""
        return {note.channel: note.what for note in self.notes if note.kind == NOT_READ and note.channel}

    def numbers(self, header: str) -> Array:
        """Values of a column, shape (rows,); raises InputError if it holds anything but numbers."""
        if header in self.faults:
            raise self.faults[header]
        return self.columns[header]


def left_out(channel: str, what: str) -> QualityNote:
    """A note that something in the file was not read."""
    return QualityNote(NOT_READ, channel, what, "left out")


def stated_twice(path: Path, name: str) -> InputError:
    """The fault of a column of which one message states two numbers."""
    return InputError(
        "is stated twice in one message",
        mend=f"have it published once, or leave it out: --map '{name}=ignore'",
        source=path,
        column=name,
    )


TWICE = "is the name of two columns"


def take(columns: dict[str, Array], found: Mapping[str, Array], notes: list[QualityNote]) -> None:
    """Add columns to those that a file has; of two that have one name neither is read, with a note."""
    for name, values in found.items():
        if name in columns:
            del columns[name]
            notes.append(left_out(name, TWICE))
        elif not any(note.channel == name and note.what == TWICE for note in notes):
            columns[name] = values


def as_column(values: object) -> Array | None:
    """A vector of numbers as float64, shape (T,), or None if it is none; rows and columns of a matrix count as vectors."""
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        return None
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    return array.astype(np.float64) if array.ndim == 1 else None


def as_columns(name: str, values: object) -> dict[str, Array]:
    """A vector as one column, a matrix as one for each of its shorter side, ``name[0]``, …; nothing if it is neither."""
    vector = as_column(values)
    if vector is not None:
        return {name: vector}
    array = np.asarray(values)
    if array.dtype.kind not in "biuf" or array.ndim < 2:
        return {}
    # Simulink stores samples along the last axis of (1, 1, T) or (n, 1, T).
    array = np.squeeze(array)
    if array.ndim == 1:
        return {name: array.astype(np.float64)}
    if array.ndim != 2:
        return {}
    rows = array if array.shape[0] < array.shape[1] else array.T
    return {f"{name}[{k}]": row.astype(np.float64) for k, row in enumerate(rows)}


def equal_lengths(path: Path, columns: dict[str, Array], units: dict[str, str], notes: list[QualityNote]) -> Table:
    """The columns that are as long as time; a common group above all of them is taken off the names.

    Raises InputError if there is none, or no sample in them.
    """
    if not columns:
        told = f": {notes[0].channel!r} {notes[0].what}".replace("'' ", "it ") if notes else ""
        raise InputError(f"holds no vector of numbers{told}", mend="store each column as one", source=path)
    columns, units = _without_common_group(columns, units)
    lengths = [len(values) for name, values in columns.items() if name == "time" or name.startswith("time ")]
    sizes = [len(values) for values in columns.values()]
    length = lengths[0] if lengths else max(set(sizes), key=sizes.count)
    kept = {name: values for name, values in columns.items() if len(values) == length}
    notes = notes + [
        left_out(name, f"has {len(values)} values beside {length} samples")
        for name, values in columns.items()
        if len(values) != length
    ]
    if length == 0:
        raise InputError("has columns but no samples", mend="record again or name another file", source=path)
    return Table(kept, {name: unit for name, unit in units.items() if name in kept}, notes=tuple(notes))


def _without_common_group(columns: dict[str, Array], units: dict[str, str]) -> tuple[dict[str, Array], dict[str, str]]:
    if "time" in columns:
        return columns, units
    homes = [name[: -len("time")] for name in columns if name.endswith(".time")]
    if len(homes) != 1:
        return columns, units
    home = homes[0]
    inside = {name[len(home) :]: values for name, values in columns.items() if name.startswith(home)}
    return inside, {name[len(home) :]: unit for name, unit in units.items() if name.startswith(home)}
