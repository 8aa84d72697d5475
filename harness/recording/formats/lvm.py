"""LabVIEW measurement files (``.lvm``): text, with a header for the file and one for each segment of samples.

Source: Specification for the LabVIEW Measurement File (National Instruments).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.formats.cells import is_absent, number, read_cells
from harness.recording.formats.table import Table, left_out
from harness.recording.recording import QualityNote
from harness.system.description import Array

FIRST = "LabVIEW Measurement"
END = "***End_of_Header***"
SPECIAL = ("***Start_Special***", "***End_Special***")
HEAD = 40  # lines that the first header fits in
CLOCK = "X_Value"
KEYS = (
    "Channels",
    "Samples",
    "Date",
    "Time",
    "X_Dimension",
    "X_Unit_Label",
    "X0",
    "Delta_X",
    "Y_Dimension",
    "Y_Unit_Label",
)


@dataclass
class _Segment:
    """What one segment's header says by key, a value a channel; the names over its samples, and their lines and cells."""

    told: dict[str, list[str]]
    line: int = 0
    names: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)


def is_lvm(text: str) -> bool:
    return text.startswith(FIRST)


def read_lvm(path: Path, text: str) -> Table:
    """Columns ``time`` and one for each channel, with its unit.

    Raises InputError, naming the line, for a damaged header, rows of another length, segments of different channels, and
    channels that each have a time of their own.
    """
    lines = text.splitlines()
    # The line that tells what parts cells is parted by it.
    comma = any(line.replace(" ", "").lower().startswith("separator,") for line in lines[:HEAD])
    delimiter = "," if comma else "\t"
    general, start = _header(lines, 0, delimiter)
    told = {key: (values[0] if values else "") for key, values in general.items()}
    if start < 0:
        raise _damaged(path, f"has no line {END!r}", len(lines))
    segments = _segments(path, lines, start, delimiter)
    first = segments[0]
    for other in segments[1:]:
        if other.names != first.names:
            what = f"begins a segment of other channels than the first, {', '.join(first.names)}"
            raise InputError(what, mend="give each segment as a file", source=path, line=other.line)
    notes = [QualityNote("segments", "", f"{len(segments)} segments", "joined by their times")] if segments[1:] else []
    if segments[-1].rows and len(segments[-1].rows[-1]) < len(first.names):
        notes.append(QualityNote("cut_off", "", f"line {segments[-1].lines[-1]}, the last, is cut off", "left out"))
        del segments[-1].rows[-1], segments[-1].lines[-1]
    return _table(path, segments, told.get("X_Columns", "One").lower(), delimiter, notes)


def _header(lines: Sequence[str], start: int, delimiter: str) -> tuple[dict[str, list[str]], int]:
    """Keys and values from a line to the end of the header, and the line behind it; −1 where there is no end."""
    told: dict[str, list[str]] = {}
    for k in range(start, len(lines)):
        cells = [cell.strip() for cell in lines[k].split(delimiter)]
        if cells[0].startswith(END):
            return told, k + 1
        if cells[0]:
            told[cells[0]] = cells[1:]
    return told, -1


def _segments(path: Path, lines: Sequence[str], start: int, delimiter: str) -> list[_Segment]:
    found: list[_Segment] = []
    k, special = start, False
    while k < len(lines):
        cells = lines[k].split(delimiter)
        key = cells[0].strip()
        special = (special or key == SPECIAL[0]) and key != SPECIAL[1]
        if special or key == SPECIAL[1] or not lines[k].strip():
            k += 1
        elif key in KEYS:
            told, after = _header(lines, k, delimiter)
            if after < 0:
                raise _damaged(path, "begins a header that has no end", k + 1)
            found.append(_Segment(told, k + 1))
            k = after
        else:
            if not found:
                found.append(_Segment({}, k + 1))
            _take(path, found[-1], k + 1, cells)
            k += 1
    if not found or not found[-1].names:
        raise InputError("has a header but no samples", mend="record again or name another file", source=path)
    return found


def _take(path: Path, segment: _Segment, line: int, cells: list[str]) -> None:
    """A line of a segment: its names, which come first, or a sample, whose last cell may be a comment."""
    if not segment.names:
        names = [cell.strip() for cell in cells]
        while names and names[-1] in ("", "Comment"):
            names.pop()
        if not names or any(number(name, "\t") is not None for name in names if name):
            raise _damaged(path, "should name the columns", line)
        segment.names, segment.line = names, segment.line or line
        return
    if segment.rows and len(segment.rows[-1]) < len(segment.names):
        what = f"has {len(segment.rows[-1])} cells where the header has {len(segment.names)}"
        raise InputError(what, mend="mend or remove the line", source=path, line=segment.lines[-1])
    segment.rows.append(cells[: len(segment.names)])
    segment.lines.append(line)


def _table(path: Path, segments: list[_Segment], clocks: str, delimiter: str, notes: list[QualityNote]) -> Table:
    """clocks: ``no``, ``one`` or ``multi``, as the header's X_Columns."""
    names, told = segments[0].names, segments[0].told
    lines = tuple(line for segment in segments for line in segment.lines)
    if not lines:
        raise InputError("has a header but no samples", mend="record again or name another file", source=path)
    read = [
        read_cells(path, name, [row[k] for segment in segments for row in segment.rows], lines, delimiter)
        for k, name in enumerate(names)
    ]
    at = [k for k, name in enumerate(names) if name == CLOCK and (clocks != "no" or k > 0)]
    axes = {axis.lower() for axis in told.get("X_Dimension", []) if axis} or {"time"}
    columns: dict[str, Array] = {}
    faults: dict[str, InputError] = {}
    units: dict[str, str] = {}
    clock = at[0] if at and clocks != "no" else None
    if axes == {"time"}:
        if clock is not None:
            columns["time"] = read[clock].values
            if (fault := read[clock].fault) is not None:
                faults["time"] = fault
        elif clocks == "no":
            columns["time"] = np.concatenate([_counted(path, segment) for segment in segments])
    for other in at[1:] if clock is not None else []:
        same = np.allclose(read[other].values, read[at[0]].values, rtol=1e-9, atol=0.0, equal_nan=True)
        if not same:
            what = "every channel has a time of its own"
            raise InputError(what, mend="write the file with one X column", source=path, line=segments[0].line)
    channel = 0
    for k, name in enumerate(names):
        if name == CLOCK:
            continue
        unit = _nth(told.get("Y_Unit_Label", []), channel)
        channel += 1
        if not name:
            notes.append(left_out("", f"column {k + 1} has no name"))
            continue
        if name in columns:
            faults[name] = InputError(
                f"two columns are named {name!r}", mend="rename one", source=path, line=segments[0].line, column=k + 1
            )
            continue
        columns[name] = read[k].values
        if unit:
            units[name] = unit
        if (fault := read[k].fault) is not None:
            faults[name] = fault
    return Table(
        columns, units, lines, faults, aliases={"time": CLOCK} if clock is not None else {}, notes=tuple(notes)
    )


def _counted(path: Path, segment: _Segment) -> Array:
    """Time of samples that have none in the file [s]: from X0, a Delta_X apart."""
    steps = [
        [number(cell, "\t") for cell in segment.told.get(key, []) if not is_absent(cell)] for key in ("X0", "Delta_X")
    ]
    starts, steps_ = steps
    if not starts or not steps_ or None in starts or None in steps_:
        raise _damaged(path, "begins a segment without X0 and Delta_X, so that its samples have no time", segment.line)
    if any(a != b for values in steps for a, b in pairwise(values)):
        raise InputError(
            "every channel has a time of its own",
            mend="write the file with one X column",
            source=path,
            line=segment.line,
        )
    start, step = starts[0], steps_[0]
    assert start is not None and step is not None
    times: Array = np.float64(start) + np.float64(step) * np.arange(len(segment.rows), dtype=np.float64)
    return times


def _nth(values: Sequence[str], k: int) -> str:
    return values[k] if k < len(values) else ""


def _damaged(path: Path, what: str, line: int) -> InputError:
    return InputError(f"damaged LabVIEW measurement file: {what}", mend="export it again", source=path, line=line)
