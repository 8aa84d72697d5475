"""A fleet as files: the document, its page, and a line a number for a spreadsheet."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.diagnose.answer.findings import Findings
from harness.fleet import Fleet
from harness.json_text import json_text
from harness.recording.units import written
from harness.report.figures.canvas import INK, canvas, colour
from harness.report.fleet import rows
from harness.report.fleet.rows import WORDS, Document, Shown
from harness.report.fleet.terminal import extent
from harness.report.html import page
from harness.report.sections.comparison import TEMPLATE, comparison
from harness.report.sections.section import Section
from harness.report.table_csv import tame
from harness.whole_files import staged, write_whole

COLUMNS = (
    "fleet_unit", "verdict", "complete", "failed", "effect", "site", "grade", "parameter", "value", "std", "low", "high", "unit",
)  # fmt: skip
DRAWN = 12  # numbers, those that most units have


def write_fleet(found: Fleet, folder: str | Path) -> list[Path]:
    """Write ``fleet.json``, ``fleet.csv`` and ``report.html``; returns their paths."""
    place, document = Path(folder), found.to_json()
    with staged(place / "fleet.csv") as temporary:
        _write_csv(found, temporary)
    return [
        write_whole(place / "fleet.json", json_text(document)),
        place / "fleet.csv",
        write_whole(place / "report.html", fleet_html(document)),
    ]


def _write_csv(found: Fleet, path: Path) -> None:
    """RFC 4180, a line a number of a finding; units without a finding or an answer have a line too."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="", extrasaction="ignore", lineterminator="\r\n")
        writer.writeheader()
        for name, answer in found.answers():
            told = (answer or {}).get("diagnosis")
            if told is None:
                lines: list[dict[str, Any]] = [{"failed": "has no answer" if answer is None else answer["failed"]}]
            else:
                common = {"verdict": told["verdict"], "complete": told["complete"]}
                lines = [{**common, **row} for row in Findings(told["findings"]).rows()] or [common]
            for line in lines:
                writer.writerow({key: tame(value) for key, value in {"fleet_unit": name, **line}.items()})


@dataclass(frozen=True)
class Lines:
    """One of the fleet's tables. rows: what makes it; words: what stands above it."""

    anchor: str
    title: str
    rows: Callable[[Document], Shown]
    words: Callable[[Document], str]
    template: str = TEMPLATE

    def content(self, document: Document) -> Mapping[str, Any] | None:
        return comparison(self.rows(document), self.words(document), WORDS)


@dataclass(frozen=True)
class Histograms:
    """How each number is spread, with what is an outlier in another colour."""

    anchor: str = "histograms"
    title: str = "Numbers over the fleet"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        drawn = [row for row in document["parameters"] if row["histogram"]][:DRAWN]
        if not drawn:
            return None
        words = "Number of units over the value; a mark below is an outlier."
        return {"words": words, "pictures": [(_caption(row), _histogram(row, document["outliers"])) for row in drawn]}


def _caption(row: Mapping[str, Any]) -> str:
    return f"{row['parameter'].replace('_', ' ')} of {row['effect'].replace('_', ' ')} at {row['site']}"


def _histogram(row: Mapping[str, Any], outliers: list[Mapping[str, Any]]) -> str:
    edges, counts = row["histogram"]["edges"], row["histogram"]["counts"]
    key = ("effect", "site", "parameter")
    apart = [found["value"] for found in outliers if all(found[name] == row[name] for name in key)]
    with canvas("-".join(row[name] for name in key), 9.2, 2.2) as (made, axes):
        ax = axes[0, 0]
        ax.stairs(counts, edges, fill=True, color=colour("denoc"), alpha=0.7)
        ax.axvline(row["median"], color=INK, lw=1.0)
        ax.plot(apart, [0.0] * len(apart), "v", color=colour("analytic"), ms=7, clip_on=False)
        ax.set_xlabel(f"{row['parameter'].replace('_', ' ')} [{written(row['unit'])}]")
        ax.set_ylabel("units")
    return str(made.svg)


def fleet_html(document: Document) -> str:
    """The page of a ``denoc.fleet/1`` document."""
    parts: list[Section] = [
        Lines("verdicts", "Verdicts", rows.verdicts, lambda d: f"{extent(d)}; fleet {d['source']}."),
        Lines("effects", "Which units have which effect", rows.effects, lambda d: "Share: established or likely."),
        Lines("parameters", "How numbers are spread", rows.parameters, lambda d: d["method"]),
        Histograms(),
        Lines("outliers", "Units whose number lies apart", rows.outliers, lambda d: "Farthest first."),
        Lines("rare", "Units with an effect that few have", rows.rare,
              lambda d: "Established, and claimed at no more than one unit in twenty."),
        Lines("failed", "Units without an answer", rows.failed, lambda d: "With the line that says why."),
    ]  # fmt: skip
    return page("A fleet diagnosed", document, parts)
