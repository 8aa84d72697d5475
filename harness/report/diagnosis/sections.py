"""Sections of a diagnosis's page: what it says, what was found, before and after, where, and what else it could be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.diagnose.answer.curves import Curves
from harness.diagnose.answer.diagnosis import numbers_of, one_by_one, rivals_of
from harness.diagnose.answer.significant_digits import ends, resolved, width_of
from harness.report.diagnosis.curves import pictures
from harness.report.diagnosis.figures import errors, windows

Document = Mapping[str, Any]


def figure(value: float | None) -> str:
    """Three digits, or a dash."""
    return "–" if value is None else f"{value:.3g}"


@dataclass(frozen=True)
class Answer:
    anchor: str = "answer"
    title: str = "Answer"
    template: str = "diagnosis_answer.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        return {
            "verdict": document["verdict"].replace("_", " "),
            "good": document["verdict"] in ("consistent", "explained"),
            "summary": document["summary"],
            "findings": [
                {**f, "numbers": numbers_of(f), "rivals": rivals_of(f)} for f in one_by_one(document["findings"])
            ],
            "next_experiment": document.get("next_experiment") or {},
            "figure": figure,
            "resolved": resolved,
            "ends": ends,
            "width_of": width_of,
        }


@dataclass(frozen=True)
class BeforeAndAfter:
    anchor: str = "fit"
    title: str = "Before and after"
    template: str = "diagnosis_fit.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        fit = document["fit"]
        if not fit:
            return None
        shown_there = [f["effect"].replace("_", " ") for f in one_by_one(document["findings"]) if "shows_only_in" in f]
        return {"fit": fit, "picture": Markup(errors(fit)), "figure": figure, "shown_there": shown_there}


@dataclass(frozen=True)
class Levels:
    anchor: str = "levels"
    title: str = "Dry friction, recording by recording"
    template: str = "diagnosis_levels.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        levels = document.get("levels")
        return {"levels": levels, "figure": figure} if levels else None


@dataclass(frozen=True)
class Replay:
    anchor: str = "replay"
    title: str = "The augmented model in other engines"
    template: str = "diagnosis_replay.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        replay = document.get("replay")
        return {"replay": replay, "figure": figure} if replay else None


@dataclass(frozen=True)
class Where:
    anchor: str = "where"
    title: str = "Where the model leaves the recordings"
    template: str = "diagnosis_where.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        places = document["mismatch"]
        if not places:
            return None
        picture = Markup(windows(places)) if any(place["time"] for place in places) else ""
        return {"places": places, "picture": picture, "figure": figure}


@dataclass(frozen=True)
class Pictures:
    curves: Curves | None
    anchor: str = "pictures"
    title: str = "Residuals"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.curves is None:
            return None
        drawn = [(caption, Markup(svg)) for caption, svg in pictures(self.curves)]
        return {"words": "", "pictures": drawn} if drawn else None


@dataclass(frozen=True)
class Rivals:
    anchor: str = "ranking"
    title: str = "What else it could be"
    template: str = "diagnosis_ranking.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        ranking = document.get("ranking") or []
        if not ranking:
            return None
        known = [row["bic"] for row in ranking if row.get("bic") is not None]
        reasons = any(row.get("lost") for row in ranking)
        return {"ranking": ranking, "best": min(known) if known else 0.0, "reasons": reasons, "figure": figure}


@dataclass(frozen=True)
class Data:
    anchor: str = "data"
    title: str = "The recordings"
    template: str = "diagnosis_data.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        return {"noise": document["noise"], "quality": document.get("quality") or [], "figure": figure}
