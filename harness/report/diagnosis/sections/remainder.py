"""What is left when what was found has been fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.significant_digits import rounded
from harness.recording.units import written
from harness.report.diagnosis.sections.figure import Document


@dataclass(frozen=True)
class Remainder:
    anchor: str = "remainder"
    title: str = "What is left"
    template: str = "diagnosis_remainder.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        left = document.get("remainder") or {}
        tests = left.get("tests") or []
        sizes = sizes_of(document.get("discrepancy"))
        if not left.get("significant") and not tests and not sizes:
            return None
        return {
            "significant": left.get("significant", False),
            "form": left.get("residual_torque"),
            "doubted": [key.replace("_", " ") for key in left.get("doubted") or ()],
            "tests": tests,
            "sizes": sizes,
            "between": any(row.get("between_recordings") for row in sizes),
            "gain": any(row.get("effort_gain_between_recordings") for row in sizes),
            "figure": rounded,
            "unit": written,
        }


def sizes_of(discrepancy: Any) -> list[Mapping[str, Any]]:
    """Rows (joint, size, unit, memory) of what is left as a force, whether listed or told by joint."""
    if isinstance(discrepancy, Mapping):
        return [{"joint": joint, **told} for joint, told in discrepancy.items() if isinstance(told, Mapping)]
    return list(discrepancy or ())
