"""Where in a text table the header is, and what it says: titles, rows of units, headers of several rows, none at all."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import NamedTuple

from harness.errors import InputError
from harness.recording.formats.cells import is_absent, is_number, number
from harness.recording.formats.stamps import is_stamp
from harness.recording.units import is_unit

MARKS = ("\t", ";", ",", " ")
PARTED = {"\t": "tabs", ";": "semicolons", ",": "commas", " ": "blanks"}
COMMENTS = ("#", "%", "//")
SAMPLE = 40  # rows that are looked at
BRACKETED = re.compile(r"^[\[(].*[\])]$")


class Row(NamedTuple):
    """A line of the file and its cells."""

    line: int
    cells: tuple[str, ...]
    comment: bool = False


@dataclass(frozen=True)
class Layout:
    """names: of the columns, "" where there is none. units: by column, "" where not told. body: the samples.

    skipped: lines before the header that are titles and the like.
    """

    delimiter: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    line: int
    body: tuple[Row, ...]
    skipped: tuple[int, ...]


def find_layout(path: Path, lines: list[str]) -> Layout:
    """The layout of a text table.

    Raises InputError if there are comments only, no header, no samples, or rows of another length than the header.
    """
    plain = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not plain:
        raise InputError("holds comments only", mend="a header line and samples are needed", source=path)
    delimiter = _delimiter(plain)
    rows = [row for k, line in enumerate(lines) if line.strip() for row in [_row(k + 1, line, delimiter)]]
    samples = [row for row in rows if not row.comment]
    sizes = Counter(len(row.cells) for row in samples[max(0, len(samples) // 2 - SAMPLE) :])
    width = max(sizes, key=lambda size: (sizes[size], size))
    middle = [row for row in samples[len(samples) // 2 :] if len(row.cells) == width][:SAMPLE]
    usual = sorted(_numbers(row, delimiter) for row in middle)[len(middle) // 2] if middle else 0

    def fits(row: Row) -> bool:
        return not row.comment and len(row.cells) == width and _is_sample(row, delimiter, usual)

    # A row of numbers among those of the header (identifiers of markers) has none below it.
    first = next((k for k in range(len(rows)) if fits(rows[k]) and (k + 1 == len(rows) or fits(rows[k + 1]))), None)
    if first is None or usual == 0:
        if len(samples) == 1:
            raise InputError("has a header but no samples", mend="record again or name another file", source=path)
        first = rows.index(samples[1])  # no number anywhere: the columns' own faults say more
        width = len(samples[0].cells)
    head = rows[:first]
    body = [row for row in rows[first:] if not row.comment]
    # A spreadsheet's empty rows are delimiters alone.
    head = [row for row in head if any(cell.strip() for cell in row.cells)]
    # A header has no numbers; a row with some is a sample whose other cells are at fault.
    last = max((k for k, row in enumerate(head) if not row.comment and not _numbers(row, delimiter)), default=None)
    if last is not None:
        body = [row for row in head[last + 1 :] if not row.comment and len(row.cells) == width] + body
        head = head[: last + 1]
    return _with_header(path, delimiter, head, body, width)


def _with_header(path: Path, delimiter: str, head: list[Row], body: list[Row], width: int) -> Layout:
    trailing = all(not row.cells[-1].strip() for row in body[:-1] or body if row.cells)
    fitting = [row for row in head if not row.comment and len(row.cells) == width]
    if not fitting:
        # np.savetxt writes the header as a comment; write.table of R has no name over the names of its rows.
        fitting = [row for row in head if row.comment and len(row.cells) == width][-1:]
    names_of_rows = False
    if not fitting:
        fitting = [row for row in head if not row.comment and len(row.cells) == width - 1][-1:]
        names_of_rows = bool(fitting) and not trailing and _are_names(row.cells[0] for row in body)
        fitting = fitting if names_of_rows or trailing else []
    if not fitting:
        above = [row for row in reversed(head) if not row.comment]
        wrong = next((row for row in above if len(row.cells) > 1), above[0] if above else None)
        if wrong is not None:
            many = len(wrong.cells)
            mend = "mend or remove the line" if many > 1 else "part the header and the samples by one mark"
            if delimiter == "," and width == 2 * many:
                mend = "commas part cells, and decimals too: write decimal points, or part cells by semicolons"
            raise InputError(
                f"has {width} cells{'' if many > 1 else f', parted by {PARTED[delimiter]},'} where the header has {many}",
                mend=mend,
                source=path,
                line=body[0].line,
            )
        raise InputError(
            "the first line is numbers, not a header",
            mend="name the columns there, as time,pivot.position",
            source=path,
            line=body[0].line,
        )
    units = [""] * width
    header = fitting[-1]
    if len(fitting) > 1 and _is_units(header):
        units = ["" if is_absent(cell) else _bare(cell) for cell in header.cells]
        fitting = fitting[:-1]
        header = fitting[-1]
    names = [cell.strip().lstrip("﻿") for cell in header.cells]
    if names_of_rows:
        names = ["", *names]
    names, above = _whole(names, fitting[:-1])
    names, further = _unique(names, fitting[: len(fitting) - 1 - len(above)])
    above += further
    part = {row.line for row in above}
    skipped = tuple(row.line for row in head if not row.comment and row.line < header.line and row.line not in part)
    if trailing and len(names) == width and not names[-1]:
        names = names[:-1]
    return Layout(delimiter, tuple(names), tuple(units[: len(names)]), header.line, tuple(body), skipped)


def _row(line: int, text: str, delimiter: str) -> Row:
    stripped = text.lstrip()
    mark = next((mark for mark in COMMENTS if stripped.startswith(mark)), "") if stripped[:1] in "#%/" else ""
    content = stripped[len(mark) :].lstrip("#% ") if mark else text
    if delimiter != " " and '"' not in content:
        return Row(line, tuple(content.split(delimiter)), bool(mark))
    if delimiter == " ":
        content = " ".join(content.split())
        if '"' not in content:
            return Row(line, tuple(content.split(" ")), bool(mark))
    return Row(line, tuple(next(csv.reader(io.StringIO(content), delimiter=delimiter), ())), bool(mark))


def _numbers(row: Row, delimiter: str) -> int:
    return sum(is_stamp(cell) or is_number(cell, delimiter) for cell in row.cells)


def _is_sample(row: Row, delimiter: str, usual: int) -> bool:
    """Whether a row has as many numbers as most have, cells that are left empty included."""
    numbers = _numbers(row, delimiter)
    absent = sum(is_absent(cell) and not is_number(cell, delimiter) for cell in row.cells)
    return numbers >= 1 and numbers + absent >= usual


def _delimiter(plain: list[str]) -> str:
    """The mark that parts the most rows into equally many cells that are numbers."""
    middle = len(plain) // 2
    sample = plain[middle : middle + SAMPLE]
    if len(sample) > 1:
        sample = sample[:-1]  # the last line of a file may be cut off
    best, found = 0.0, ""
    for mark in MARKS:
        rows = [_row(0, line, mark) for line in sample]
        sizes = Counter(len(row.cells) for row in rows)
        size, many = sizes.most_common(1)[0]
        if size < 2:
            continue
        cells = sum(len(row.cells) for row in rows)
        fit = (
            sum(_numbers(row, mark) + sum(not c.strip() for c in row.cells) for row in rows) / cells * many / len(rows)
        )
        if fit > best + 1e-9:
            best, found = fit, mark
    return found or _header_delimiter(plain[0])


def _header_delimiter(header: str) -> str:
    # Brackets may hold commas or blanks of their own; a delimiter is what is left outside them.
    outside, depth = "", 0
    for letter in header:
        depth += letter in "[("
        if depth == 0:
            outside += letter
        depth -= letter in "])"
    for mark in MARKS[:3]:
        if mark in outside:
            return mark
    return " " if len(outside.split()) > 1 else ","


def _are_names(cells: Iterable[str]) -> bool:
    """Whether cells may be names of rows: words, or whole numbers that ascend."""
    numbers = [number(cell, " ") for cell in cells]
    counted = [value for value in numbers if value is not None]
    whole = all(value == round(value) for value in counted if isfinite(value))
    return not counted or (len(counted) == len(numbers) and whole and all(a < b for a, b in pairwise(counted)))


def _bare(cell: str) -> str:
    text = cell.strip()
    return text[1:-1].strip() if BRACKETED.match(text) else text


def _is_units(row: Row) -> bool:
    told = [cell.strip() for cell in row.cells if not is_absent(cell)]
    return bool(told) and all(BRACKETED.match(cell) or is_unit(cell) for cell in told)


def _whole(names: list[str], above: list[Row]) -> tuple[list[str], list[Row]]:
    """Names of which a row above has the first part (pivot over position), and has them whole where none stands below; that row."""
    over = [cell.strip() for cell in above[-1].cells] if above else []
    both = any(o and n for o, n in zip(over, names, strict=False))
    if not both or not any(o and not n for o, n in zip(over, names, strict=False)):
        return names, []
    found, last = [], ""
    for o, n in zip(over, names, strict=False):
        last = o or last  # a name may stand over the first of its columns only
        found.append(f"{last}.{n}" if last and n else o or n)
    return found, [above[-1]]


def _unique(names: list[str], above: list[Row]) -> tuple[list[str], list[Row]]:
    """Names that repeat (X, Y, Z of every marker) with what stands over them, as far up as needed; and the rows it took."""
    used: list[Row] = []
    for row in reversed(above):
        twice = {name for name, count in Counter(names).items() if count > 1 and name}
        if not twice:
            break
        over, last = [], ""
        for cell in row.cells:
            last = cell.strip() or last  # a name may stand over the first of its columns only
            over.append(last)
        names = [f"{o}.{n}" if n in twice and o else n for n, o in zip(names, over, strict=False)]
        used.append(row)
    return names, used
