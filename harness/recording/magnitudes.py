"""Readings that no instrument gives: marks for "no value" of some format, damaged bytes, or a unit mistaken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.recording.recording import QualityNote
from harness.system.description import Array

# In SI (rad, m, rad/s, N·m, m/s², strain). Formats mark absent readings by 1e20, 9.97e36 or 3.4e38.
MOST = 1e12
# What all readings of a channel together vary by at least, or it stands still: squares of less are lost in rounding.
LEAST = 1e-18
# Of a recording [s]: thirty years, and the light's way over a foot.
LONGEST, SHORTEST = 1e9, 1e-9


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
