"""What an engine's equation lacks, for a person, a program and as a picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from harness.compare.balance import Balance
from harness.diagnose.answer.significant_digits import digits, estimate
from harness.report.columns import figures, print_table
from harness.report.figures.canvas import FAINT, INK, canvas
from harness.report.pictures import alone

BLUE = "#0a7bbd"
EXCERPT = 300  # samples: a whole recording of a vibration is a black band


def summary(found: Balance, engine: str) -> str:
    """One paragraph in plain words."""
    if not found.mends:
        return f"The recording asks for no change of the equations of {engine}."
    missing = [mend.words for mend in found.mends]
    told = missing[0] if len(missing) == 1 else "; ".join(missing[:-1]) + f"; and {missing[-1]}"
    return f"The equations of {engine} do not balance along the recording: {told}."


def balance_document(found: Balance, *, source: str, model: str, engine: str) -> dict[str, Any]:
    """The answer as plain values (denoc.balance/1)."""
    units = dict(zip(found.names, found.units, strict=True))
    left = found.lacking - found.explained
    return {
        "schema": "denoc.balance/1",
        "source": source,
        "model": model,
        "engine": engine,
        "summary": summary(found, engine),
        "mends": [
            {
                "row": mend.row,
                "term": mend.name,
                "what": mend.words,
                "factor": {"value": mend.factor, "std": mend.std, "ci95": list(mend.ci95), "unit": "1"},
                "log_bayes_factor": mend.evidence,
            }
            for mend in found.mends
        ],
        "rows": [
            {
                "row": name,
                "unit": units[name],
                "lacking_rms": float(np.sqrt(np.mean(found.lacking[:, k] ** 2))),
                "left_rms": float(np.sqrt(np.mean(left[:, k] ** 2))),
                "candidates": list(found.tried[name]),
            }
            for k, name in enumerate(found.names)
        ],
    }


def print_balance(document: dict[str, Any], console: Console) -> None:
    """Print a ``denoc.balance/1`` document."""
    console.print(Text(document["summary"]))
    if document["mends"]:
        print_table(
            console,
            (
                "equation of",
                "what the recording asks for",
                figures("factor (1: the corrected term)"),
                figures("log Bayes factor"),
            ),
            [
                (
                    mend["row"],
                    mend["what"],
                    estimate(mend["factor"]["value"], mend["factor"]["std"], mend["factor"]["ci95"]),
                    digits(mend["log_bayes_factor"], 3),
                )
                for mend in document["mends"]
            ],
        )
    print_table(
        console,
        ("equation of", "unit", figures("does not balance by (rms)"), figures("with the mends"), "terms that could be wrong"),
        [
            (
                row["row"],
                row["unit"],
                digits(row["lacking_rms"], 3),
                digits(row["left_rms"], 3),
                ", ".join(row["candidates"]) or "none",
            )
            for row in document["rows"]
        ],
    )  # fmt: skip


def balance_picture(found: Balance, engine: str) -> str:
    """SVG: for every row what the engine's equation lacks in an excerpt of the recording, and what the mends give of it."""
    middle = len(found.time) // 2
    shown = slice(max(0, middle - EXCERPT // 2), middle + EXCERPT // 2)
    with canvas("balance", 9.2, 2.6 * len(found.names), rows=len(found.names)) as (made, axes):
        for ax, name, unit, lacking, explained in zip(
            axes[:, 0], found.names, found.units, found.lacking.T, found.explained.T, strict=True
        ):
            ax.plot(found.time[shown], lacking[shown], color=FAINT, lw=1.6, label=f"what {engine} lacks")
            ax.plot(found.time[shown], explained[shown], color=BLUE, lw=0.9, ls="--", label="what the mends give")
            ax.plot(found.time[shown], (lacking - explained)[shown], color=INK, lw=0.6, label="left")
            ax.set_ylabel(f"{name} [{unit}]")
        axes[-1, 0].set_xlabel("time [s]")
        axes[0, 0].legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), labelcolor=INK, fontsize=9, ncols=3)
    return alone(str(made.svg))
