"""What else it could be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.significant_digits import rounded
from harness.report.diagnosis.held_out_errors import channels_of, headings, held_out
from harness.report.diagnosis.sections.figure import Document, points
from harness.report.diagnosis.sets_in_words import first_not_likeliest, sets_in_words


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
        channels = channels_of(ranking)
        return {
            "ranking": [
                {**row, "errors": held_out(row, channels), "said": said.replace("_", " ")}
                for row, said in zip(ranking, sets_in_words(ranking), strict=True)
            ],
            "note": first_not_likeliest(ranking),
            "heads": headings(channels, "held-out error"),
            "best": min(known) if known else 0.0,
            "reasons": reasons,
            "figure": rounded,
            "points": points,
        }
