"""How far each comparison is from what is allowed, on a logarithmic line, a dot a row."""

from __future__ import annotations

from collections.abc import Sequence

from harness.cases.case import NATIVE, Row
from harness.cases.discover import natural
from harness.report.figures.canvas import FAINT, INK, canvas, colour, marker

# Exact agreement has no logarithm; it is drawn at the left edge.
FLOOR = 1e-9


def dots(rows: Sequence[Row], name: str) -> str:
    """SVG: a line for each case, a dot for each compared row at difference / allowed, coloured by engine."""
    compared = [row for row in rows if row.verdict != "skipped"]
    cases = sorted(dict.fromkeys(row.case for row in compared), key=natural)
    height = 0.9 + 0.27 * len(cases)
    with canvas(name, 9.2, height) as (made, axes):
        ax = axes[0, 0]
        ax.set_xscale("log")
        ax.set_xlim(FLOOR / 2.0, 1e3 if any(row.verdict == "fail" for row in compared) else 10.0)
        ax.axvspan(1.0, 1e9, color="#d64545", alpha=0.12, lw=0)
        ax.axvline(1.0, color="#d64545", lw=1.2)
        engines: dict[str, str] = {}
        for row in compared:
            other = next((e for e in row.engines if e != NATIVE), NATIVE)
            # A row against a truth is the engine's own: its first name.
            other = row.engines[0] if other in ("analytic", "published") else other
            engines.setdefault(other, colour(other, len(engines)))
            ratio = row.ratio if row.ratio == row.ratio else 1e3
            ax.plot(
                min(max(ratio, FLOOR), 9e2),
                cases.index(row.case),
                marker(other),
                color=engines[other],
                ms=6 if row.verdict == "pass" else 9,
                alpha=0.75 if row.verdict == "pass" else 1.0,
                mec=INK if row.verdict == "fail" else "none",
                mew=1.0,
            )
        ax.set_yticks(range(len(cases)), cases)
        ax.set_ylim(len(cases) - 0.4, -0.6)
        ax.tick_params(axis="y", length=0)
        ax.grid(axis="y", lw=0.5)
        ax.set_xlabel("difference / allowed (left is better; the red line is the limit)")
        handles = [ax.plot([], [], marker(e), color=c, label=e)[0] for e, c in engines.items()]
        made.figure.legend(handles=handles, loc="outside upper right", ncols=len(handles), labelcolor=INK)
        ax.spines["left"].set_color(FAINT)
    return str(made.svg)
