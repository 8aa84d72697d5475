"""Text tables: comma, semicolon, tab or blanks between cells, one header line, ``#`` comments."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.table import Table

ABSENT = {"", "nan", "na", "n/a", "null", "none", "-", "#n/a", "#nan"}


def read_csv(path: Path, text: str) -> Table:
    """Columns of a text table with their line numbers.

    Raises InputError, naming line and column, for a missing header, rows of another length and cells that are no number.
    """
    lines = text.splitlines()
    first = next((k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if first is None:
        raise InputError("holds comments only", mend="a header line and samples are needed", source=path)
    delimiter = _delimiter(lines[first])
    rows, numbers = _rows(lines, first, delimiter)
    header = [cell.strip() for cell in rows[0]]
    # A delimiter at the end of every line makes an empty last column.
    if len(header) > 1 and not header[-1] and all(len(r) < len(header) or not r[-1].strip() for r in rows[1:]):
        header = header[:-1]
        rows = [row[: len(header)] for row in rows]
    if all(_number(cell, delimiter) is not None for cell in header):
        raise InputError(
            "the first line is numbers, not a header",
            mend="name the columns there, as time,pivot.position",
            source=path,
            line=numbers[0],
        )
    _refuse_bad_header(path, header, numbers[0])
    body, body_lines = rows[1:], numbers[1:]
    if not body:
        raise InputError("has a header but no samples", mend="record again or name another file", source=path)
    remarks: list[str] = []
    if len(body) > 1 and len(body[-1]) < len(header):
        remarks.append(f"line {body_lines[-1]}, the last, is cut off and was left out")
        body, body_lines = body[:-1], body_lines[:-1]
    for row, line in zip(body, body_lines, strict=True):
        if len(row) != len(header):
            raise InputError(
                f"has {len(row)} cells where the header has {len(header)}",
                mend="mend or remove the line",
                source=path,
                line=line,
            )
    columns = {
        name: _column(path, name, [row[k] for row in body], body_lines, delimiter) for k, name in enumerate(header)
    }
    return Table(columns, lines=tuple(body_lines), remarks=tuple(remarks))


def _delimiter(header: str) -> str:
    # Brackets may hold commas or blanks of their own; a delimiter is what is left outside them.
    outside, depth = "", 0
    for letter in header:
        depth += letter in "[("
        if depth == 0:
            outside += letter
        depth -= letter in "])"
    for mark in ("\t", ";", ","):
        if mark in outside:
            return mark
    return " " if len(outside.split()) > 1 else ","


def _rows(lines: list[str], first: int, delimiter: str) -> tuple[list[list[str]], list[int]]:
    rows: list[list[str]] = []
    numbers: list[int] = []
    for k in range(first, len(lines)):
        line = lines[k]
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = line.split() if delimiter == " " else next(csv.reader(io.StringIO(line), delimiter=delimiter))
        rows.append(cells)
        numbers.append(k + 1)
    return rows, numbers


def _refuse_bad_header(path: Path, header: list[str], line: int) -> None:
    seen: set[str] = set()
    for k, name in enumerate(header):
        if not name:
            raise InputError("a column has no name", mend="name it or remove it", source=path, line=line, column=k + 1)
        if name in seen:
            raise InputError(f"two columns are named {name!r}", mend="rename one", source=path, line=line, column=k + 1)
        seen.add(name)


def _number(cell: str, delimiter: str) -> float | None:
    text = cell.strip()
    if text.lower() in ABSENT:
        return float("nan") if text else None
    if delimiter != "," and "," in text and "." not in text:
        text = text.replace(",", ".")  # decimal comma
    if "_" in text:
        return None  # Python reads 1_000; a table does not mean it
    try:
        return float(text)
    except ValueError:
        return None


def _column(path: Path, name: str, cells: list[str], lines: list[int], delimiter: str) -> np.ndarray:
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        pass
    values = np.empty(len(cells))
    for k, cell in enumerate(cells):
        number = float("nan") if cell.strip().lower() in ABSENT else _number(cell, delimiter)
        if number is None:
            raise InputError(
                f"{cell.strip()[:40]!r} is not a number",
                mend="mend the cell, or leave it empty if there is no sample",
                source=path,
                line=lines[k],
                column=name,
            )
        values[k] = number
    return values
