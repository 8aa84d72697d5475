"""A fleet on the terminal: which units have which effect, how numbers are spread, which units are apart."""

from __future__ import annotations

from collections.abc import Callable

from rich.console import Console
from rich.text import Text

from harness.report.columns import Column, figures, print_table
from harness.report.fleet import rows
from harness.report.fleet.rows import WORDS, Document, Shown

MOST = 20  # lines of a table; all are in the files


def print_fleet(document: Document, console: Console) -> None:
    """Print a ``denoc.fleet/1`` document."""
    console.print(Text(extent(document), style="bold"))
    _show(console, rows.verdicts, document, "")
    _show(console, rows.effects, document, "Which units have which effect")
    _show(console, rows.parameters, document, "How numbers are spread (effects established or likely)")
    _show(console, rows.outliers, document, "Units whose number lies apart")
    _show(console, rows.rare, document, "Units with an effect that few have (established, at most one in twenty)")
    _show(console, rows.failed, document, "Units without an answer")


def extent(document: Document) -> str:
    """How many units there are, and are answered."""
    text = f"{document['diagnosed']} of {document['units']} units diagnosed"
    short = len(document["incomplete"])
    return text + (f", {short} of them cut short by the time limit" if short else "")


def _show(console: Console, make: Callable[[Document], Shown], document: Document, title: str) -> None:
    heads, lines = make(document)
    if not lines:
        return
    console.print()
    columns: list[Column | str] = [head if head in WORDS else figures(head) for head in heads]
    print_table(console, columns, lines[:MOST], title=title)
    if len(lines) > MOST:
        console.print(Text(f"… {len(lines) - MOST} more in the report"))
