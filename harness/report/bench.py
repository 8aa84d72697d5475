"""Benchmarks on the terminal, in Markdown and as a page with scaling plots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.json_text import json_text
from harness.report.columns import figures, print_table

Document = Mapping[str, Any]
HEADS = ("what", "n", "peer", "ours", "theirs", "ratio", "wanted", "note")
FIGURES = ("n", "ours", "theirs", "ratio", "wanted")


def cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    """A row's cells under ``HEADS``."""
    unit = row.get("unit", "s")
    return (
        row["what"].replace("_", " "),
        "" if row.get("n") is None else str(row["n"]),
        row["peer"],
        _cost(row["ours"], unit),
        _cost(row["theirs"], unit),
        "–" if row["ratio"] is None else f"{row['ratio']:.3g}",
        "" if row.get("wanted") is None else f"{row['wanted']:g}",
        row.get("note") or "",
    )


def _cost(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    if unit != "s":
        return f"{value:.3g} {unit}" if unit != "1" else f"{value:.3g}"
    for factor, name in ((1.0, "s"), (1e3, "ms"), (1e6, "µs")):
        if value * factor >= 1.0:
            return f"{value * factor:.3g} {name}"
    return f"{value * 1e9:.3g} ns"


def print_bench(document: Document, console: Console) -> None:
    """A line for each row; ratios that miss what was aimed at are red."""
    lines = []
    for row in document["rows"]:
        style = {True: "green", False: "bold red"}.get(row.get("met"), "")
        texts = [Text(cell) for cell in cells(row)]
        texts[5].stylize(style) if style else None
        lines.append(texts)
    print_table(console, [figures(head) if head in FIGURES else head for head in HEADS], lines)


def bench_markdown(document: Document) -> str:
    """The same table in Markdown, with the machine it was measured on."""
    lines = ["# Benchmarks", "", "Ratios are theirs over ours: above 1 the native code is cheaper.", ""]
    lines += ["| " + " | ".join(HEADS) + " |", "|" + " --- |" * len(HEADS)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in cells(row)) + " |" for row in document["rows"]]
    lines += ["", *(f"- {name}: {value}" for name, value in document.get("machine", {}).items())]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Costs:
    """The table."""

    anchor: str = "costs"
    title: str = "Ours and theirs"
    template: str = "bench_table.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        return {"heads": HEADS, "rows": [(row.get("met"), cells(row)) for row in document["rows"]]}


@dataclass(frozen=True)
class Scaling:
    """Cost over the number of joints, for whatever was measured at several sizes."""

    anchor: str = "scaling"
    title: str = "Cost over size"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        from markupsafe import Markup

        pictures = []
        for what in dict.fromkeys(row["what"] for row in document["rows"]):
            mine = [
                r for r in document["rows"] if r["what"] == what and r["ours"] and r.get("n") and r.get("unit") == "s"
            ]
            if len({row["n"] for row in mine}) > 1:
                pictures.append((what.replace("_", " "), Markup(_growth(what, mine))))
        return (
            {
                "words": "Both axes are logarithmic; a straight line of slope 1 is cost in proportion to size.",
                "pictures": pictures,
            }
            if pictures
            else None
        )


def _growth(what: str, rows: list[Mapping[str, Any]]) -> str:
    from harness.report.figures.canvas import INK, canvas, colour, marker

    with canvas(f"growth-{what}", 9.2, 3.6) as (made, axes):
        ax = axes[0, 0]
        ours = sorted({row["n"]: row["ours"] for row in rows}.items())
        ax.plot(*zip(*ours, strict=True), "o-", color=colour("denoc"), label="denoc")
        for index, peer in enumerate(dict.fromkeys(row["peer"] for row in rows)):
            theirs = sorted((row["n"], row["theirs"]) for row in rows if row["peer"] == peer and row["theirs"])
            if theirs:
                ax.plot(*zip(*theirs, strict=True), marker(peer) + "--", color=colour(peer, index), label=peer)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("coordinates n")
        ax.set_ylabel("time [s]")
        ax.legend(labelcolor=INK)
    return str(made.svg)


def bench_files(document: Document) -> dict[str, str]:
    """``bench.json``, ``bench.md``, ``report.html``."""
    from harness.report.html import page

    return {
        "bench.json": json_text(document),
        "bench.md": bench_markdown(document),
        "report.html": page("DeNOC benchmarks", document, [Scaling(), Costs()]),
    }
