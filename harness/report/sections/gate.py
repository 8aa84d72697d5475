"""What closes the gate, first on its page: what changed, then where and when, then why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.cases.gate import Judgement
from harness.cases.results import Results
from harness.report.gate import closing


@dataclass(frozen=True)
class Gate:
    """judgement: of the run that the page is about; files: the model of each case, for the line that changed."""

    judgement: Judgement
    files: Mapping[str, Path] = field(default_factory=dict)
    anchor: str = "gate"
    title: str = "Gate"
    template: str = "gate.html"

    def content(self, results: Results) -> Mapping[str, Any]:
        failed = self.judgement.failed
        count, of = len(failed), len(self.judgement.rows)
        headline = f"Closed: {count} of {of} rows." if count else f"Open: all {of} rows hold."
        if self.judgement.reference:
            headline = f"Closed: the reference {self.judgement.reference}."
        return {
            "headline": headline,
            "ok": self.judgement.ok,
            "not_held": self.judgement.not_held(),
            "heads": closing.HEADS,
            "figures": closing.FIGURES,
            "rows": [line.cells for line in closing.lines(self.judgement, self.files)],
            "versions": self.judgement.versions_changed,
        }
