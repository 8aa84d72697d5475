"""Models held against recordings, on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.report.arbitration import rows
from harness.report.arbitration.rows import WORDS
from harness.report.columns import Column, figures, print_table


def print_comparison(document: Mapping[str, Any], console: Console) -> None:
    """Print a ``denoc.arbitration/1`` or ``denoc.transfer/1`` document."""
    console.print(Text(document["summary"]))
    _table(console, "Free runs held out (training): root mean square", *rows.prediction(document))
    heads, clear = rows.places(document, clear=True)
    # One that is better everywhere is in the words above.
    if len({line[-2] for line in clear}) > 1 or 0 < len(clear) < len(document["where"]):
        _table(console, "Where one predicts better than the other by more than chance", heads, clear)
    counted = document["counted_by"]
    title = "Numbers" + (f"; free swings show ratios alone, all are counted by the {counted}" if counted else "")
    _table(console, title, *rows.numbers(document))
    heads, left = rows.combinations(document, ("open", "left open"))
    if left:
        _table(console, "Combinations that the recordings leave open", heads, left)


def _table(console: Console, title: str, heads: list[str], lines: list[list[str]]) -> None:
    console.print()
    columns: list[Column | str] = [head if head in WORDS else figures(head) for head in heads]
    print_table(console, columns, lines, title=title)
