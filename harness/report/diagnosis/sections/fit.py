"""Before and after: errors by channel, levels of dry friction by recording, the augmented model in other engines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.diagnose.answer.diagnosis import one_by_one
from harness.diagnose.answer.significant_digits import rounded
from harness.recording.units import written
from harness.report.diagnosis.figures import errors
from harness.report.diagnosis.sections.figure import Document


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
        return {
            "fit": fit,
            "foretold": any("predictive" in channel for channel in fit),
            "picture": Markup(errors(fit)),
            "figure": rounded,
            "unit": written,
            "shown_there": shown_there,
        }


@dataclass(frozen=True)
class Levels:
    anchor: str = "levels"
    title: str = "Dry friction, recording by recording"
    template: str = "diagnosis_levels.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        levels = document.get("levels")
        return {"levels": levels, "figure": rounded} if levels else None


@dataclass(frozen=True)
class Replay:
    anchor: str = "replay"
    title: str = "The augmented model in other engines"
    template: str = "diagnosis_replay.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        replay = document.get("replay")
        return {"replay": replay, "figure": rounded} if replay else None
