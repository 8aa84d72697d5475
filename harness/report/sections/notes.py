"""What reading the models left out or had to interpret."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.cases.results import Results


@dataclass(frozen=True)
class Notes:
    anchor: str = "notes"
    title: str = "What the models say beside this"
    template: str = "notes.html"

    def content(self, results: Results) -> Mapping[str, Any] | None:
        return {"by_case": results.notes, "titles": results.titles} if results.notes else None


@dataclass(frozen=True)
class ModelNotes:
    """The notes of a diagnosis, whose document lists those of its one model."""

    anchor: str = "notes"
    title: str = "What was left out of the model"
    template: str = "notes.html"

    def content(self, document: Mapping[str, Any]) -> Mapping[str, Any] | None:
        notes = document.get("notes")
        return {"by_case": {"": notes}, "titles": {}} if notes else None
