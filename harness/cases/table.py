"""The table as plain text, for ``print(results)``; the terminal's coloured one is in ``harness.report``."""

from __future__ import annotations

from collections.abc import Sequence

from harness.cases.case import Row
from harness.notebook import text_table


def number(value: float | None) -> str:
    """A figure as the tables show it: two digits, or a dash for nothing."""
    if value is None:
        return "–"
    return "0" if value == 0.0 else f"{value:.1e}"


def cells(row: Row) -> tuple[str, ...]:
    """Quantity, engines, difference, allowed, unit and verdict of a comparison."""
    engines = " / ".join(row.engines)
    return row.quantity, engines, number(row.difference), number(row.allowed), row.unit, row.verdict


def aligned(rows: Sequence[Row]) -> str:
    """Aligned columns: case, quantity, engines, difference, allowed, unit, verdict, note."""
    head = ("case", "quantity", "engines", "difference", "allowed", "unit", "verdict", "note")
    lines = [(row.case, *cells(row), row.note) for row in rows]
    return f"{text_table(head, lines)}\n\n{counts(rows)}"


def counts(rows: Sequence[Row]) -> str:
    """How many passed, failed and were skipped."""
    return ", ".join(f"{sum(row.verdict == v for row in rows)} {v}" for v in ("pass", "fail", "skipped"))
