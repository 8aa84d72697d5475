"""The verdict in a sentence, and in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.cases.results import Results
from harness.report import words


@dataclass(frozen=True)
class Summary:
    anchor: str = "summary"
    title: str = "Summary"
    template: str = "summary.html"

    def content(self, results: Results) -> Mapping[str, Any]:
        passed, failed, skipped = (results.count(v) for v in ("pass", "fail", "skipped"))
        text = words.headline(passed, failed, skipped)
        engines = sorted(
            {e for row in results.rows if row.verdict != "skipped" for e in row.engines} - {"analytic", "published"}
        )
        return {
            "headline": text[0].upper() + text[1:] + ".",
            "ok": results.ok,
            "tiles": [
                ("comparisons within the allowed", passed, "pass"),
                ("failed", failed, "fail" if failed else ""),
                ("not possible, with the reason", skipped, ""),
                ("cases", len(results.titles), ""),
                ("engines", len(engines), ""),
            ],
            "failed": results.failed,
            "doubts": results.doubts,
            "words": words,
        }
