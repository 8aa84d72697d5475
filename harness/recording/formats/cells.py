"""Cells of a text table: numbers, stamps of the calendar, nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.plain_numbers import is_plain, plain_number
from harness.recording.formats.stamps import is_stamp, nanoseconds
from harness.system.description import Array

ABSENT = {"", "nan", "na", "n/a", "null", "none", "-", "#n/a", "#nan", "nat"}
EXACT = 2**53  # integers beyond are not held to the digit by a double


@dataclass(frozen=True, eq=False)
class Cells:
    """One column: values (rows,), the unit if the cells themselves tell it, what was taken off, and why it is no column."""

    values: Array
    unit: str = ""
    origin: float = 0.0
    fault: InputError | None = None


def is_absent(cell: str) -> bool:
    return cell.strip().lower() in ABSENT


def number(cell: str, delimiter: str) -> float | None:
    """The number in a cell, nan for a word that stands for none, None for an empty cell and for text."""
    text = cell.strip()
    if text.lower() in ABSENT:
        return float("nan") if text else None
    if delimiter != "," and "," in text and "." not in text:
        text = text.replace(",", ".")  # decimal comma
    try:
        return plain_number(text)
    except ValueError:
        return None


def is_number(cell: str, delimiter: str) -> bool:
    """Whether a cell is written as a number, ``nan`` included, rather than as a word for none."""
    return number(cell, delimiter) is not None and (not is_absent(cell) or cell.strip().lower() == "nan")


def read_cells(path: Path, name: str, cells: Sequence[str], lines: Sequence[int], delimiter: str) -> Cells:
    """A column of numbers, or of calendar stamps as seconds from the first; any other has a fault that names the cell."""
    try:
        # As Python reads them: what only that takes is looked at cell by cell.
        values = np.array(cells, dtype=np.float64) if is_plain("".join(cells)) else None
    except ValueError:
        values = None
    if values is not None:
        largest = float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
        if largest > EXACT and all(cell.strip().lstrip("+-").isdigit() for cell in cells):
            whole = [int(cell) for cell in cells]
            return Cells(np.array([value - whole[0] for value in whole], dtype=np.float64), origin=float(whole[0]))
        return Cells(values)
    values = np.empty(len(cells))
    for k, cell in enumerate(cells):
        found = float("nan") if is_absent(cell) else number(cell, delimiter)
        if found is None:
            stamps = _stamps(cells) if is_stamp(cell) else None
            if stamps is not None:
                return stamps
            fault = InputError(
                f"{cell.strip()[:40]!r} is not a number",
                mend="mend the cell, or leave it empty if there is no sample",
                source=path,
                line=lines[k],
                column=name,
            )
            return Cells(np.full(len(cells), np.nan), fault=fault)
        values[k] = found
    return Cells(values)


def _stamps(cells: Sequence[str]) -> Cells | None:
    """Stamps of the calendar or the clock as seconds from the first; None if one of them is none."""
    present = [k for k, cell in enumerate(cells) if not is_absent(cell)]
    whole = nanoseconds([cells[k] for k in present])
    if whole is None:
        return None
    values = np.full(len(cells), np.nan)
    values[present] = [(ticks - whole[0]) * 1e-9 for ticks in whole]
    return Cells(values, unit="s", origin=whole[0] * 1e-9)
