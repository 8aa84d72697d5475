"""What each recording says by itself, where recordings disagree with one another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.significant_digits import best, ends, rounded
from harness.recording.units import written
from harness.report.diagnosis.sections.figure import Document


@dataclass(frozen=True)
class Disagreement:
    anchor: str = "disagreement"
    title: str = "Recordings that disagree with one another"
    template: str = "diagnosis_disagreement.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        apart = document.get("disagreement")
        return {"apart": apart, "heads": heads_of(apart), "figure": rounded, "interval": interval} if apart else None


def heads_of(apart: Mapping[str, Any]) -> list[tuple[str, str, bool]]:
    """Key, heading with its unit, and whether it differs, of every number that a recording has, those that differ first."""
    first = apart["recordings"][0]["parameters"]
    keys = sorted(first, key=lambda key: key not in apart["differing"])
    return [(key, f"{key} [{written(first[key]['unit']) or '1'}]", key in apart["differing"]) for key in keys]


def interval(number: Mapping[str, Any]) -> str:
    """A number with its 95 % interval."""
    return f"{best(number['value'], number['ci95'])} ({ends(number['ci95'])})"
