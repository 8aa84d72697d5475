"""Readings that no instrument gives: marks for "no value" of some format, damaged bytes, or a unit mistaken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.recording.columns import unit_stated
from harness.recording.recording import QualityNote
from harness.system.description import Array

# In SI (rad, m, rad/s, N·m, m/s², strain). Formats mark absent readings by 1e20, 9.97e36 or 3.4e38.
MOST = 1e12
# What all readings of a channel together vary by at least, or it stands still: squares of less are lost in rounding.
LEAST = 1e-18
# Of a recording [s]: thirty years, and the light's way over a foot.
LONGEST, SHORTEST = 1e9, 1e-9
# Seconds since 1970 between which recordings were made: 1980 and 2100; fractions of them by unit.
YEARS = (3.2e8, 4.2e9)
FRACTIONS = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}
# Days since 1900 of the same years, and steps of them [day] that would be rates above 50 kHz if they were seconds.
DAYS, DAY_STEP = (29_000.0, 74_000.0), 2e-5
UNITS_OF_TIME = {
    "ms": "milliseconds since 1970",
    "us": "microseconds since 1970",
    "ns": "nanoseconds since 1970",
    "day": "days of a spreadsheet",
}


def without_absurd(
    name: str, unit: str, values: Array, header: str, lines: tuple[int, ...] | None, source: Path
) -> tuple[Array, list[QualityNote]]:
    """Values (rows,) of a channel, nan where they are beyond any measurement, and a note of it.

    Raises InputError, naming the first such cell, where that is most of them.
    """
    absurd = np.abs(values) > MOST
    count = int(absurd.sum())
    if count == 0:
        return values, []
    first = int(np.argmax(absurd))
    told = f"{values[first]:.3g} {unit} is beyond any measurement"
    if 2 * count > int(np.isfinite(values).sum()):
        raise InputError(
            told,
            mend="check the column and its unit",
            source=source,
            line=lines[first] if lines is not None else None,
            column=header,
        )
    many = (
        f"{count} values are beyond any measurement, the first" if count > 1 else "one value is beyond any measurement,"
    )
    note = QualityNote("absurd", name, f"{many} {values[first]:.3g} {unit}", "left open; not fitted", count)
    return np.where(absurd, np.nan, values), [note]


def check_span(stamps: Array, rows: NDArray[np.intp], lines: tuple[int, ...] | None, source: Path) -> None:
    """Refuse time stamps [s] whose span is that of no recording; rows: of the file that they stand in."""
    with np.errstate(over="ignore"):
        span = float(np.ptp(stamps))
    if SHORTEST <= span <= LONGEST:
        return
    line = None
    if span > LONGEST and lines is not None:
        with np.errstate(over="ignore"):
            line = lines[int(rows[int(np.argmax(np.abs(stamps - np.median(stamps))))])]
    raise InputError(
        f"time spans {span:.3g} s, which no recording does",
        mend="check the column and its unit, as in time [ns]",
        source=source,
        line=line,
        column="time",
    )


def check_clock(stamps: Array, origin: float, header: str, unit: str, source: Path) -> None:
    """Refuse stamps that count from 1970 in less than seconds, or in days from 1900, and are taken for seconds.

    stamps: (rows,), the origin taken off them, both [s]. unit: of the column as the file or the user says, "" if none does.
    """
    present = stamps[np.isfinite(stamps)]
    if len(present) < 2:
        return
    first, step = origin + float(present[0]), float(np.ptp(present)) / (len(present) - 1)
    small = next((name for name, size in FRACTIONS.items() if YEARS[0] < first * size < YEARS[1]), None)
    days = not unit and DAYS[0] < first < DAYS[1] and 0.0 < step < DAY_STEP
    if small is None and not days:
        return
    name = small or "day"
    raise InputError(
        f"begins at {first:.15g}, which are {UNITS_OF_TIME[name]}, not seconds",
        mend=unit_stated(header, "time", name),
        source=source,
        column=header,
    )
