"""Models held against recordings, as a page and as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from harness.report.arbitration import rows
from harness.report.arbitration.sections import Answer, Curves, Intervals, Motion, Table, Where
from harness.report.diagnosis.page import when
from harness.report.html import page
from harness.report.sections.notes import ModelNotes
from harness.report.sections.section import Section
from harness.whole_files import write_folder

TITLES = {
    "denoc.arbitration/1": ("arbitration", "Two models, the same recordings"),
    "denoc.transfer/1": ("transfer", "Parameters of one unit on recordings of another"),
}


def write_comparison(document: Mapping[str, Any], curves: Curves, folder: str | Path) -> list[Path]:
    """Write ``arbitration.json`` and ``arbitration.html``, or ``transfer``; returns their paths."""
    name, _ = TITLES[document["schema"]]
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    return write_folder(folder, {f"{name}.json": text, f"{name}.html": comparison_html(document, curves)})


def comparison_html(document: Mapping[str, Any], curves: Curves = ()) -> str:
    """The page of a ``denoc.arbitration/1`` or ``denoc.transfer/1`` document."""
    _, title = TITLES[document["schema"]]
    ratio = (
        "Free swings show ratios alone: numbers of every model are multiplied by one factor so that the {counted} is that of "
        "the recordings' fit. "
        if document["counted_by"]
        else ""
    )
    parts: list[Section] = [
        Answer(),
        Table(
            "prediction", "Errors of free runs", rows.prediction,
            "Held out, and in brackets over the recordings that “refitted” was fitted to; initial states alone are fitted "
            "to a run.",
        ),
        Motion(curves),
        Where(),
        Table(
            "where", "Where one is better", rows.places,
            "By the Diebold–Mariano test over a group's windows: a name where that model errs less by more than chance (5 %) and "
            "by more than a twentieth, “level” where not, “too few” where there are fewer than four windows.",
        ),
        Table(
            "numbers", "Numbers", partial(rows.numbers, made_of=True),
            ratio + "The recordings' estimate is that of the same equations fitted to the training recordings. A model's number is "
            "within its interval also where it is outside by less than a hundredth of its size; a number is open where half "
            "its interval is more than half its size.",
        ),
        Intervals(),
        Table(
            "combinations", "Combinations", rows.combinations,
            "What the recordings tell by itself, the best known first: changes in units of each number's size, how well the "
            "combination is known, and how many of its standard deviations a model lies away from the estimate.",
        ),
        ModelNotes(),
    ]  # fmt: skip
    told = document["provenance"]
    names = ", ".join(row["recording"] for row in told["recordings"])
    line = f"{names}; denoc-harness {told['version']}, {when(told['created'])}"
    return page(title, document, parts, line)
