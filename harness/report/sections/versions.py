"""What the results were made with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.cases.results import Results


@dataclass(frozen=True)
class Versions:
    anchor: str = "versions"
    title: str = "Versions and time"
    template: str = "versions.html"

    def content(self, results: Results) -> Mapping[str, Any]:
        slowest = sorted(results.case_seconds.items(), key=lambda item: -item[1])[:5]
        return {
            "versions": dict(results.versions),
            "created": results.created,
            "seconds": results.seconds if results.seconds == results.seconds else None,
            "slowest": slowest,
        }
