"""The report's pictures as SVG files of their own, for a README, a paper, a slide."""

from __future__ import annotations

from itertools import groupby

from harness.cases.results import Results
from harness.report.figures.dots import dots
from harness.report.figures.kinds import kind_of

# The page's variables as a picture on white paper has them.
PAPER = {"var(--ink)": "#1c2430", "var(--faint)": "#7a8594", "var(--grid)": "#dfe4ea", "var(--sans)": "sans-serif"}


def pictures(results: Results) -> dict[str, str]:
    """File name to SVG: ``distances-<group>.svg`` and ``<figure>-<case>.svg``."""
    found: dict[str, str] = {}
    for group, members in groupby(results.rows, key=lambda row: row.group):
        rows = list(members)
        if any(row.verdict != "skipped" for row in rows):
            found[f"distances-{group}.svg"] = alone(dots(rows, f"dots-{group}"))
    for figure, case in dict.fromkeys((line.figure, line.case) for line in results.series):
        lines = [line for line in results.series if (line.figure, line.case) == (figure, case)]
        name = f"{figure}-{case}".replace("/", "-")
        found[f"{name}.svg"] = alone(kind_of(figure).draw(lines, name))
    return found


def alone(svg: str) -> str:
    """A picture of the page as a file that needs no page: its own colours, on white."""
    for variable, value in PAPER.items():
        svg = svg.replace(variable, value)
    end = svg.index(">", svg.index("<svg")) + 1
    return svg[:end] + '<rect width="100%" height="100%" fill="#ffffff"/>' + svg[end:]
