"""Rows of the tables of a ``denoc.arbitration/1`` or ``denoc.transfer/1`` document, the same on the terminal and on the
page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.diagnose.answer.significant_digits import best, ends, resolved, rounded
from harness.recording.units import written

Document = Mapping[str, Any]
NOISE = "noise"
WORDS = (
    "channel",
    "by",
    "group",
    "better",
    "number",
    "unit",
    "verdict",
    "combination of changes, in sizes",
)  # all else is figures


def models_of(document: Document) -> list[str]:
    """The models that were given."""
    return list(document["models"]) if "models" in document else [document["model"]]


def runners(document: Document) -> list[str]:
    """All whose free runs are told: the models given, then what was fitted."""
    return list(document["prediction"][0]["models"]) if document["prediction"] else models_of(document)


def prediction(document: Document) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of errors held out, training in brackets behind them."""
    names = runners(document)
    heads = ["channel", "unit", *names, NOISE, "better"]
    rows = []
    for row in document["prediction"]:
        errors = [
            f"{rounded(row['models'][name]['heldout_rmse'])} ({rounded(row['models'][name]['train_rmse'])})"
            for name in names
        ]
        rows.append([row["channel"], written(row["unit"]), *errors, rounded(row["noise_floor"]), row["better"]])
    return heads, rows


def places(document: Document, *, clear: bool = False) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of where models err how much; clear: those alone where one is better by more than chance."""
    names = runners(document)
    heads = ["channel", "by", "group", "windows", *names, "better", "chance"]
    rows = []
    for row in document.get("where", ()):
        if clear and row["better"] not in models_of(document):
            continue
        group = row["group"] if row["by"] == "recording" else f"{row['group']} {written(row['by_unit'])}"
        chance = "" if row["chance"] is None else "< 0.001" if row["chance"] < 1e-3 else f"{row['chance']:.2g}"
        errors = [rounded(row["models"].get(name)) if name in row["models"] else "" for name in names]
        rows.append([row["channel"], row["by"], group, str(row["windows"]), *errors, row["better"], chance])
    return heads, rows


def numbers(document: Document, *, made_of: bool = False) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of numbers: what models say, the recordings' estimate with its 95 % interval, and what follows.

    made_of: whether a last column has the combination that a number is.
    """
    names = models_of(document)
    heads = ["number", "unit", *(["published"] if "model" in document else names), "recordings", "95 %", "verdict"]
    heads += ["made of"] if made_of else []
    rows = []
    for row in document["numbers"]:
        own = [row["published"]] if "published" in row else [row["models"][name] for name in names]
        interval = row["ci95"]
        width = None if interval is None else interval[1] - interval[0]
        rows.append(
            [
                row["number"],
                written(row["unit"]),
                *(resolved(value, width) for value in own),
                "" if interval is None else best(row["value"], interval),
                ends(interval),
                _side(row["says"], names),
                *([row["grouped"]] if made_of else []),
            ]
        )
    return heads, rows


def combinations(document: Document, says: Sequence[str] | None = None) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of combinations, the best told first; says: those of which this follows, by default all."""
    names = models_of(document)
    heads = ["combination of changes, in sizes", "known to", *(f"{name} off by" for name in names), "verdict"]
    rows = []
    for row in document["combinations"]:
        if says is not None and row["says"] not in says:
            continue
        formula = " ".join(f"{'−' if w < 0.0 else '+'} {abs(w):.2g} {label}" for label, w in row["weights"].items())
        known = "nothing" if row["std"] > 1e3 else f"± {100.0 * row['std']:.2g} %"
        away = ["" if row["std"] > 1e3 else f"{row['models'][name]:+.1f} σ" for name in names]
        rows.append([formula.removeprefix("+ "), known, *away, _side(row["says"], names)])
    return heads, rows


def _side(says: str, names: Sequence[str]) -> str:
    return f"for {says}" if says in names else says
