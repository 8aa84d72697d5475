"""What the answer was made from: recordings, their noise and quality, model, command, version and day."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.significant_digits import rounded
from harness.recording.units import written
from harness.report.diagnosis.sections.figure import Document

ROLES = {"training": "training", "held out": "held out", "both": "training, its end held out"}


@dataclass(frozen=True)
class Data:
    anchor: str = "data"
    title: str = "The recordings"
    template: str = "diagnosis_data.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        return {
            "recordings": (document.get("provenance") or {}).get("recordings") or [],
            "roles": ROLES,
            "noise": document["noise"],
            "quality": document.get("quality") or [],
            "figure": rounded,
            "unit": written,
        }


@dataclass(frozen=True)
class Provenance:
    anchor: str = "provenance"
    title: str = "How this was made"
    template: str = "diagnosis_provenance.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        told = document.get("provenance")
        if not told:
            return None
        model = told["model"]
        rows = [
            (
                "model",
                " ".join(part for part in (model["name"], f"({model['file']})" if model["file"] else "") if part),
            ),
            ("command", told.get("command", "")),
            ("denoc-harness", told["version"]),
            ("made", told["created"]),
        ]
        return {"rows": [(name, text) for name, text in rows if text]}
