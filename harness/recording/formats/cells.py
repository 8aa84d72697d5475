"""Cells of a text table: numbers, stamps of the calendar, nothing."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.plain_numbers import is_plain, plain_number
from harness.recording.formats.stamps import is_stamp, nanoseconds, of_two_numbers
from harness.system.description import Array

ABSENT = {"", "nan", "na", "n/a", "null", "none", "-", "#n/a", "#nan", "nat"}
THOUSANDS = re.compile(r"^[+-]?[1-9]\d{0,2},\d{3}$")
EXACT = 2**53  # integers beyond are not held to the digit by a double


@dataclass(frozen=True, eq=False)
class Cells:
    """One column: values (rows,), the unit if the cells themselves tell it, what was taken off, and why it is no column.

    comma: the first number that was read with a decimal comma, as (row, cell).
    """

    values: Array
    unit: str = ""
    origin: float = 0.0
    fault: InputError | None = None
    comma: tuple[int, str] | None = None


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
    comma: tuple[int, str] | None = None
    for k, cell in enumerate(cells):
        found = float("nan") if is_absent(cell) else number(cell, delimiter)
        if comma is None and found is not None and "," in cell:
            comma = k, cell.strip()
        if found is None:
            if of_two_numbers(cell):
                what, mend = "may be hours and minutes, or minutes and seconds", "write hh:mm:ss, or seconds"
            else:
                stamps = _stamps(cells) if is_stamp(cell) else None
                if stamps is not None:
                    return stamps
                what, mend = "is not a number", "mend the cell, or leave it empty if there is no sample"
                if "," in cell:
                    mend = "write numbers with a decimal point, and with no mark between thousands"
            fault = InputError(f"{cell.strip()[:40]!r} {what}", mend=mend, source=path, line=lines[k], column=name)
            return Cells(np.full(len(cells), np.nan), fault=fault)
        values[k] = found
    if comma is not None and _by_thousands(cells):
        fault = _of_two_minds(comma[1], "others are whole numbers below a thousand", path, lines[comma[0]], name)
        return Cells(np.full(len(cells), np.nan), fault=fault)
    return Cells(values, comma=comma)


def _by_thousands(cells: Sequence[str]) -> bool:
    """Whether commas part thousands rather than decimals: 998, 999, 1,000, 1,001."""
    stripped = {cell.strip() for cell in cells if not is_absent(cell)}
    parted = {cell for cell in stripped if "," in cell}
    whole = {cell.lstrip("+-") for cell in stripped - parted}
    return (
        all(THOUSANDS.match(cell) for cell in parted)
        and all(cell.isdigit() and len(cell) <= 3 for cell in whole)
        and any(cell.strip("0") for cell in whole)
    )


def refuse_two_marks(
    path: Path, columns: Mapping[str, Cells], texts: Mapping[str, Sequence[str]], lines: Sequence[int]
) -> dict[str, InputError]:
    """A fault for every column read with decimal commas, if a column of numbers has decimal points; by name."""
    commas = {name: found.comma for name, found in columns.items() if found.comma is not None}
    if not commas:
        return {}
    numbers = (name for name, found in columns.items() if found.fault is None and not found.unit)
    point = next((cell.strip() for name in numbers for cell in texts[name] if "." in cell), None)
    if point is None:
        return {}
    return {
        name: _of_two_minds(cell, f"{point[:40]!r} has a point", path, lines[k], name)
        for name, (k, cell) in commas.items()
    }


def _of_two_minds(cell: str, others: str, path: Path, line: int, name: str) -> InputError:
    return InputError(
        f"{cell[:40]!r} has a comma where {others}: for decimals or thousands?",
        mend="write numbers with one decimal mark, and with no mark between thousands",
        source=path,
        line=line,
        column=name,
    )


def _stamps(cells: Sequence[str]) -> Cells | None:
    """Stamps of the calendar or the clock as seconds from the first; None if one of them is none."""
    present = [k for k, cell in enumerate(cells) if not is_absent(cell)]
    whole = nanoseconds([cells[k] for k in present])
    if whole is None:
        return None
    values = np.full(len(cells), np.nan)
    values[present] = [(ticks - whole[0]) * 1e-9 for ticks in whole]
    return Cells(values, unit="s", origin=whole[0] * 1e-9)
