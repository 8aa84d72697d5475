"""The recording itself: what was measured and what each model says, and what each leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.diagnose.answer.curves import Curves
from harness.report.diagnosis.curves import motion, residuals, shown
from harness.report.diagnosis.sections.figure import Document


@dataclass(frozen=True)
class Motion:
    curves: Curves | None
    anchor: str = "recording"
    title: str = "Measured and simulated"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.curves is None or not self.curves.residuals:
            return None
        rows, others = shown(self.curves.residuals)
        words = (
            "What was measured, the model as it was given (nominal), and with what was found (augmented). Nothing but its "
            "initial state was fitted to a recording held out."
        )
        if others:
            words += f" {others} more recording{'s are' if others > 1 else ' is'} not shown."
        return {"words": words, "plots": [plot.html() for plot in motion(rows)], "pictures": []}


@dataclass(frozen=True)
class Residuals:
    curves: Curves | None
    anchor: str = "residuals"
    title: str = "Residuals"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        if self.curves is None or not self.curves.residuals:
            return None
        rows, _ = shown(self.curves.residuals)
        words = "Measured less simulated; two standard deviations of the noise either way are shaded."
        return {"words": words, "plots": [plot.html() for plot in residuals(rows)], "pictures": []}
