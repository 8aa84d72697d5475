"""Text tables: comma, semicolon, tab or blanks between cells, a header line, ``#`` comments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.errors import InputError
from harness.recording.formats.cells import Cells, is_absent, read_cells, refuse_two_marks
from harness.recording.formats.csv_layout import Layout, Row, find_layout
from harness.recording.formats.lvm import is_lvm, read_lvm
from harness.recording.formats.ros_csv import is_rostopic, joints_of
from harness.recording.formats.table import Table, left_out, stated_twice
from harness.recording.recording import QualityNote
from harness.system.description import Array

MINUS = "\N{MINUS SIGN}"


def read_text(path: Path, content: bytes, readable: str) -> Table:
    """Columns of a text file's bytes; raises InputError for what is no text. readable: what else could be given."""
    if not content.strip():
        raise InputError("the file is empty", mend="record again or name another file", source=path)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return read_csv(path, content.decode("utf-16"))
        except UnicodeDecodeError:
            pass
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Degree and micro signs of older instruments; anything that is not text shows in the control characters.
        text = content.decode("latin-1")
    sample = text[:4096]
    odd = sum(1 for letter in sample if (letter < " " and letter not in "\t\r\n") or letter == "\x7f")
    if odd > 0:
        raise InputError("is not text and no format that is known", mend=f"give {readable}", source=path)
    text = text.replace(MINUS, "-")
    return read_lvm(path, text) if is_lvm(text) else read_csv(path, text)


def read_csv(path: Path, text: str) -> Table:
    """Columns of a text table with their line numbers; text and other columns that are no numbers have a fault.

    Titles above the header, a row of units under it and headers of several rows are told apart by their cells. Raises InputError,
    naming line and column, for a missing header and rows of another length.
    """
    layout = find_layout(path, text.splitlines())
    body, notes = _whole_rows(path, layout)
    if layout.skipped:
        many = len(layout.skipped) > 1
        where = f"lines {layout.skipped[0]} to {layout.skipped[-1]} are" if many else f"line {layout.skipped[0]} is"
        notes.append(left_out("", f"{where} above the header"))
    names = layout.names
    rows: list[Sequence[str]] = [row.cells for row in body]
    lines = tuple(row.line for row in body)
    units = {name: unit for name, unit in zip(names, layout.units, strict=True) if unit}
    aliases: dict[str, str] = {}
    twice: set[str] = set()
    if is_rostopic(names):
        names, rows, units, aliases, twice = joints_of(names, rows)
    columns: dict[str, Array] = {}
    cells: dict[str, Cells] = {}
    texts: dict[str, Sequence[str]] = {}
    faults: dict[str, InputError] = {}
    origins: dict[str, float] = {}
    for k, name in enumerate(names):
        if not name:
            notes.append(left_out("", f"column {k + 1} has no name"))
            continue
        if name in columns:
            faults[name] = InputError(
                f"two columns are named {name!r}", mend="rename one", source=path, line=layout.line, column=k + 1
            )
            continue
        texts[name] = [row[k] for row in rows]
        found = cells[name] = read_cells(path, name, texts[name], lines, layout.delimiter)
        columns[name] = found.values
        if found.fault is not None:
            faults[name] = found.fault
        if found.origin:
            origins[name] = found.origin
        if found.unit:
            units[name] = found.unit
    faults |= {name: stated_twice(path, name) for name in twice}
    faults |= refuse_two_marks(path, cells, texts, lines)
    return Table(columns, units, lines, faults, origins, aliases=aliases, notes=tuple(notes))


def _whole_rows(path: Path, layout: Layout) -> tuple[list[Row], list[QualityNote]]:
    """The rows that have a cell for every column; the last may be cut off."""
    body, width = list(layout.body), len(layout.names)
    notes: list[QualityNote] = []
    if len(body) > 1 and len(body[-1].cells) < width:
        notes.append(QualityNote("cut_off", "", f"line {body[-1].line}, the last, is cut off", "left out"))
        body = body[:-1]
    if all(len(row.cells) == width for row in body):
        return body, notes
    whole = []
    for row in body:
        cells = row.cells
        # A delimiter at the end of every line makes an empty last cell.
        if len(cells) == width + 1 and is_absent(cells[-1]):
            cells = cells[:-1]
        if len(cells) != width:
            raise InputError(
                f"has {len(cells)} cells where the header has {width}",
                mend="mend or remove the line",
                source=path,
                line=row.line,
            )
        whole.append(Row(row.line, cells))
    return whole, notes
