"""Tables for the terminal that cut nothing.

Side by side where there is room; where there is not, the last column beneath its row; else row under row.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

Cell = str | Text
GAP = 2
# Sentences squeezed narrower than this are a tower of words, which nobody reads; names of a few words may be.
READABLE, SENTENCE = 20, 48
# So many lines of a last column beside its row: a sentence of more reads better beneath, over the whole width.
TALL = 2
# Heads that need not be said again where their column stands beneath its row.
UNSAID = ("", "note", "what changed")
INDENT = 4
_NUMBER = r"[-+−]?\d[\d.,]*(e[-+]?\d+)?"
_FIGURE = re.compile(rf"{_NUMBER}( (±|…|→) {_NUMBER})?( ?%)?")


@dataclass(frozen=True)
class Column:
    """A column: ``figures`` stand to the right and each on one line, all else breaks between words."""

    head: str
    figures: bool = False


@dataclass(frozen=True)
class Heading:
    """A line between rows, of the whole width."""

    text: str
    style: str = "bold cyan"


def figures(head: str) -> Column:
    """A column of numbers."""
    return Column(head, figures=True)


def print_table(
    console: Console, columns: Sequence[Column | str], rows: Sequence[Sequence[Cell] | Heading], *, title: str = ""
) -> None:
    """Print a table as wide as the console allows; where its figures do not fit beside one another, row under row.

    columns: a plain string is a column of words, or of figures if nothing else is in it. rows: as many cells as columns each. A
    column without content is left out.
    """
    body = [row if isinstance(row, Heading) else [_text(cell) for cell in row] for row in rows]
    cells = [row for row in body if not isinstance(row, Heading)]
    heads = [
        Column(column, _counts([row[k].plain for row in cells])) if isinstance(column, str) else column
        for k, column in enumerate(columns)
    ]
    kept = [k for k in range(len(heads)) if any(row[k].plain.strip() for row in cells)]
    if not kept:
        return
    heads = [heads[k] for k in kept]
    body = [row if isinstance(row, Heading) else [row[k] for k in kept] for row in body]
    if title:
        console.print(Text(title, style="italic"))
    rows_of_text = [row for row in body if not isinstance(row, Heading)]
    beside = _widths(heads, rows_of_text, console.width)
    short = heads[:-1] if len(heads) > 2 and not heads[-1].figures else []
    above = _widths(short, [row[:-1] for row in rows_of_text], console.width) if short else None
    tower = beside is not None and any(len(row[-1].wrap(console, beside[-1])) > TALL for row in rows_of_text)
    if beside is not None and not (tower and above is not None):
        _side_by_side(console, heads, body, beside)
    elif above is not None:
        _side_by_side(console, short, body, above, heads[-1].head)
    else:
        _stacked(console, heads, body)


def _counts(cells: Sequence[str]) -> bool:
    """Whether a column is numbers with their uncertainties, none of them as long as a sentence."""
    filled = [cell for cell in cells if cell.strip() not in ("", "–")]
    return bool(filled) and all(len(cell) <= READABLE and _FIGURE.fullmatch(cell.strip()) for cell in filled)


def _text(cell: Cell) -> Text:
    return Text(" ".join(cell.split())) if isinstance(cell, str) else cell


def _widths(heads: Sequence[Column], rows: Sequence[Sequence[Text]], room: int) -> list[int] | None:
    """Width of each column, or None where they do not fit beside one another."""
    longest = [max(cell_len(row[k].plain) for row in rows) for k in range(len(heads))]
    wanted = [max(cell_len(head.head), longest[k]) for k, head in enumerate(heads)]
    least = [
        max(longest[k], _least([head.head], 0))
        if head.figures
        else _least([head.head, *(row[k].plain for row in rows)], longest[k])
        for k, head in enumerate(heads)
    ]
    left = room - GAP * (len(heads) - 1) - sum(least)
    if left < 0:
        return None
    # Who needs little gets all of it first; the long ones share what is left.
    widths = list(least)
    waiting = sorted(range(len(heads)), key=lambda k: wanted[k] - least[k])
    for index, k in enumerate(waiting):
        more = min(wanted[k] - least[k], left // (len(waiting) - index))
        widths[k] += more
        left -= more
    return widths


def _least(texts: Sequence[str], longest: int) -> int:
    """Room that words need: the longest one whole, and for sentences enough of a line to read on."""
    word = max((cell_len(word) for text in texts for word in text.split()), default=0)
    return max(word, READABLE if longest > SENTENCE else 0)


def _side_by_side(
    console: Console,
    heads: Sequence[Column],
    body: Sequence[Sequence[Text] | Heading],
    widths: Sequence[int],
    last: str = "",
) -> None:
    """last: head of a column that stands beneath each row."""
    label = "" if last in UNSAID else f"{last}: "
    table = _grid(heads, widths)
    table.add_row(*_parted([Text(head.head, style="bold") for head in heads]))
    for row in body:
        if isinstance(row, Heading):
            _print(console, table)
            console.print(Text(row.text, style=row.style))
            table = _grid(heads, widths)
        else:
            table.add_row(*_parted(row[: len(heads)]))
            beneath = row[len(heads) :]
            if beneath and beneath[0].plain.strip():
                _print(console, table)
                console.print(Padding(Text(label) + beneath[0], (0, 0, 0, INDENT)), soft_wrap=False)
                table = _grid(heads, widths)
    if table.row_count:
        _print(console, table)


def _grid(heads: Sequence[Column], widths: Sequence[int]) -> Table:
    # A column of its own parts two others: what padding does to the last one differs between versions of rich.
    table = Table.grid(padding=0)
    for k, (head, width) in enumerate(zip(heads, widths, strict=True)):
        if k:
            table.add_column(width=GAP)
        table.add_column(justify="right" if head.figures else "left", width=width, overflow="fold")
    return table


def _parted(cells: Sequence[Text]) -> list[Text]:
    """The cells with an empty one between any two."""
    return [cell for k, one in enumerate(cells) for cell in ([Text(), one] if k else [one])]


def _stacked(console: Console, heads: Sequence[Column], body: Sequence[Sequence[Text] | Heading]) -> None:
    label = max(cell_len(head.head) for head in heads)
    for row in body:
        if isinstance(row, Heading):
            console.print(Text(row.text, style=row.style))
            continue
        table = Table.grid(padding=0)
        table.add_column(width=label, no_wrap=True)
        table.add_column(width=GAP)
        table.add_column(width=max(console.width - label - GAP, 1), overflow="fold")
        for head, cell in zip(heads, row, strict=True):
            if cell.plain.strip():
                table.add_row(Text(head.head, style="bold"), "", cell)
        _print(console, table)
        console.print()


def _print(console: Console, table: Table) -> None:
    if console.is_terminal:
        console.print(table)
        return
    # In a file or a pipe, blanks at the ends of lines are only in the way.
    with console.capture() as captured:
        console.print(table)
    console.out("\n".join(line.rstrip() for line in captured.get().splitlines()), highlight=False)
