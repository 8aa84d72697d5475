"""The table as plain text, for ``print(results)``; the terminal's coloured one is in ``harness.report``."""

from __future__ import annotations

from harness.cases.results import Results


def number(value: float | None) -> str:
    """A figure as the tables show it: two digits, or a dash for nothing."""
    if value is None:
        return "–"
    return "0" if value == 0.0 else f"{value:.1e}"


def text(results: Results) -> str:
    """Aligned columns: case, quantity, engines, difference, allowed, unit, verdict, note."""
    head = ("case", "quantity", "engines", "difference", "allowed", "unit", "verdict", "note")
    lines = [head] + [
        (
            row.case,
            row.quantity,
            " / ".join(row.engines),
            number(row.difference),
            number(row.allowed),
            row.unit,
            row.verdict,
            row.note,
        )
        for row in results.rows
    ]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    body = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
    counts = ", ".join(f"{results.count(v)} {v}" for v in ("pass", "fail", "skipped"))
    return "\n".join([body[0], "-" * min(len(max(body, key=len)), 160), *body[1:], "", counts])
