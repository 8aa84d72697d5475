"""Where the nominal model leaves the recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.diagnose.answer.significant_digits import rounded
from harness.report.diagnosis.figures import windows
from harness.report.diagnosis.sections.figure import Document


@dataclass(frozen=True)
class Where:
    anchor: str = "where"
    title: str = "Where the model leaves the recordings"
    template: str = "diagnosis_where.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        places = document["mismatch"]
        if not places:
            return None
        timed = any(place["time"] for place in places)
        picture = Markup(windows(places)) if timed else ""
        return {"places": places, "picture": picture, "figure": rounded}
