"""The paper's figures and studies as pictures, tables and a document for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

from harness.cases.case import Series
from harness.cases.paper.study import Study
from harness.report.figures.lines import lines
from harness.report.pictures import alone

Rows = Sequence[Sequence[str]]


def markdown_table(heads: Sequence[str], rows: Rows) -> str:
    """The same in Markdown."""
    told = ["| " + " | ".join(heads) + " |", "|" + " -- |" * len(heads)]
    told += ["| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows]
    return "\n".join(told) + "\n"


def drawn(series: Sequence[Series]) -> dict[str, str]:
    """File name to SVG, on white, one picture a figure."""
    found = {}
    ordered = sorted(series, key=lambda line: line.figure)
    for figure, members in groupby(ordered, key=lambda line: line.figure):
        name = figure.replace(" ", "-").replace("(", "").replace(")", "").replace("°", "")
        found[f"{name}.svg"] = alone(lines(list(members), name, height=3.6))
    return found


def document(what: str, study: Study, numbers: Mapping[str, Any], command: str) -> dict[str, Any]:
    """A study as plain values, and the command that made it (denoc.paper/1)."""
    return {
        "schema": "denoc.paper/1",
        "what": what,
        "command": command,
        "numbers": dict(numbers),
        "tables": {
            name: {"heads": list(heads), "rows": [list(row) for row in rows]}
            for name, (heads, rows) in study.tables.items()
        },
        "records": [dict(record) for record in study.records],
        "series": series_document(study.series),
    }


def series_document(series: Sequence[Series]) -> list[dict[str, Any]]:
    """Lines of the pictures as plain values."""
    return [
        {
            "figure": s.figure,
            "label": s.label,
            "x": list(s.x),
            "y": list(s.y),
            "x_label": s.x_label,
            "y_label": s.y_label,
        }
        for s in series
    ]
