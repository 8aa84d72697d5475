"""The tables of a fleet: heads and lines of text, for terminal and page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.diagnose.answer.significant_digits import resolved
from harness.recording.units import written

Document = Mapping[str, Any]
Shown = tuple[tuple[str, ...], list[tuple[str, ...]]]

NAMED = 3  # units that a line names; the file for programs names them all
WORDS = ("effect", "at", "parameter", "unit", "units", "e.g.", "what", "verdict", "of the fleet")


def verdicts(document: Document) -> Shown:
    """How many units have which verdict."""
    lines: list[tuple[str, ...]] = [
        (verdict.replace("_", " "), str(count)) for verdict, count in document["verdicts"].items()
    ]
    if document["failed"]:
        lines.append(("failed", str(len(document["failed"]))))
    return ("verdict", "number of units"), lines


def effects(document: Document) -> Shown:
    """How many units have which effect, by grade."""
    heads = ("effect", "at", "established", "likely", "possible", "of the fleet", "e.g.")
    lines: list[tuple[str, ...]] = []
    for row in document["effects"]:
        claimed = [*row["established"], *row["likely"]]
        share = f"{100.0 * len(claimed) / max(document['diagnosed'], 1):.3g} %"
        counts = [str(len(row[grade])) for grade in ("established", "likely", "possible")]
        lines.append((row["effect"], row["site"], *counts, share, some(claimed or row["possible"])))
    return heads, lines


def parameters(document: Document) -> Shown:
    """How numbers are spread."""
    heads = (
        "effect",
        "at",
        "parameter",
        "number of units",
        "median",
        "within a unit",
        "between units",
        "95 %",
        "outliers",
        "unit",
    )
    lines: list[tuple[str, ...]] = []
    for row in document["parameters"]:
        between, width = row["between"], row["within"]
        low, high = between["ci95"] or (None, None)
        lines.append(
            (
                row["effect"], row["site"], row["parameter"], str(row["number"]), resolved(row["median"], width),
                resolved(width, None), resolved(between["value"], None),
                "" if low is None else f"{resolved(low, None)} … {resolved(high, None)}",
                "–" if row["outliers"] is None else str(row["outliers"]), written(row["unit"]),
            )
        )  # fmt: skip
    return heads, lines


def outliers(document: Document) -> Shown:
    """Units apart from the others."""
    heads = ("units", "effect", "at", "parameter", "value", "median", "unit", "robust deviations", "chance, adjusted")
    lines: list[tuple[str, ...]] = [
        (
            row["unit"], row["effect"], row["site"], row["parameter"], resolved(row["value"], row["std"]),
            resolved(row["median"], row["std"]), written(row["si"]), f"{row['z']:+.1f}", f"{row['chance']:.1e}",
        )
        for row in document["outliers"]
    ]  # fmt: skip
    return heads, lines


def rare(document: Document) -> Shown:
    """Units with an effect that few have."""
    return ("units", "effect", "at", "others that have it"), [
        (row["unit"], row["effect"], row["site"], str(row["others"])) for row in document["rare"]
    ]


def failed(document: Document) -> Shown:
    """Units without an answer, and why."""
    return ("units", "what"), [(row["unit"], row["what"]) for row in document["failed"]]


def some(units: Sequence[str]) -> str:
    """The first few names."""
    return ", ".join(units[:NAMED]) + (", …" if len(units) > NAMED else "")
