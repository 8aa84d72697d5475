"""Every comparison's distance from its limit, by group."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from markupsafe import Markup

from harness.cases.results import Results
from harness.report import words
from harness.report.figures.dots import dots


@dataclass(frozen=True)
class Distances:
    anchor: str = "distances"
    title: str = "How far from the limit"
    template: str = "pictures.html"

    def content(self, results: Results) -> Mapping[str, Any] | None:
        pictures = []
        for group, members in groupby(results.rows, key=lambda row: row.group):
            rows = list(members)
            if any(row.verdict != "skipped" for row in rows):
                pictures.append((words.GROUP_TITLES.get(group, group), Markup(dots(rows, f"dots-{group}"))))
        if not pictures:
            return None
        return {
            "words": "Each mark is one quantity of one case in one engine: its difference over what is allowed there. "
            "The reason for each limit is in the table.",
            "pictures": pictures,
        }
