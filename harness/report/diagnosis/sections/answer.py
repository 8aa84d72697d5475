"""The answer in three short paragraphs: what, how sure, and what next."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.explain import percent
from harness.diagnose.answer.significant_digits import rounded
from harness.recording.units import written
from harness.report.diagnosis.sections.figure import Document

SMALLER = 1.02  # times, by which an error has to have become smaller to be said to fall
_PRODUCT = re.compile(r"(?<=[A-Za-z])\*(?=[A-Za-z])")  # in a unit


@dataclass(frozen=True)
class Answer:
    anchor: str = "answer"
    title: str = "Answer"
    template: str = "diagnosis_answer.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        return {
            "verdict": document["verdict"].replace("_", " "),
            "good": document["verdict"] in ("consistent", "explained"),
            "paragraphs": paragraphs(document),
            "complete": document.get("complete", True),
            "not_tried": document.get("not_tried") or [],
            "notes": [_note(note) for note in document.get("notes") or []],
        }


def paragraphs(document: Document) -> list[str]:
    """What is missing; how far that helps, what speaks against it and what is left; what to do next."""
    first, *doubts = re.split(r"(?<=[.!?]) (?=[A-Z])", document["summary"].strip())
    told = (first, " ".join([*_use(document), *doubts]), _next(document.get("next_experiment") or {}))
    return [_PRODUCT.sub("·", text) for text in told if text]


def _use(document: Document) -> list[str]:
    if not document["findings"]:
        return []
    told = []
    worst = max(document["fit"], key=_gain, default=None)
    if worst is None or not _gain(worst):
        return []
    before, after, noise = (
        rounded(value) for value in (worst["nominal"]["heldout_rmse"], worst["augmented"]["heldout_rmse"], worst["noise_floor"])
    )  # fmt: skip
    unit = written(worst["unit"])
    if _gain(worst) < 1.0 / SMALLER:
        return [
            f"On data held out the error of {worst['channel']} is {after} {unit}, before it was {before} (noise {noise})."
        ]
    if _gain(worst) < SMALLER:
        # What shows where a recording begins, say, is nothing in data held out that go on from there.
        return [f"On data held out the error of {worst['channel']} is {after} {unit} with or without (noise {noise})."]
    told = [f"On data held out the error of {worst['channel']} falls from {before} to {after} {unit} (noise {noise})."]
    share = document.get("explained_share")
    # Beside a force that is left out the summary tells it with the findings.
    firm = any(finding.get("grade") != "possible" for finding in document["findings"])
    if share is not None and share > 0.0 and not (document.get("discrepancy") and firm):
        told.append(f"That removes {percent(share)} of the nominal model's mean-square error there.")
    return told


def _next(following: Mapping[str, Any]) -> str:
    if not following.get("what"):
        return ""
    parted = [name.replace("_", " ") for name in following.get("separates") or ()]
    return f"Next experiment: {following['what']}" + (f" (it parts {' and '.join(parted)})." if parted else ".")


def _gain(row: Mapping[str, Any]) -> float:
    """How many times smaller the error of a channel has become."""
    before, after = row["nominal"]["heldout_rmse"], row["augmented"]["heldout_rmse"]
    return float(before / after) if before and after else 0.0


def _note(note: Any) -> str:
    if isinstance(note, Mapping):
        return ": ".join(str(note[key]) for key in ("where", "what", "done") if note.get(key))
    return str(note)
