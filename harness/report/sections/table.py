"""Every row, with its reason."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from harness.cases.results import Results
from harness.report import words


@dataclass(frozen=True)
class Table:
    anchor: str = "table"
    title: str = "All comparisons"
    template: str = "table.html"

    def content(self, results: Results) -> Mapping[str, Any] | None:
        if not results.rows:
            return None
        groups = []
        for group, members in groupby(results.rows, key=lambda row: row.group):
            cases = [
                (case, results.titles.get(case, case), list(rows))
                for case, rows in groupby(members, key=lambda row: row.case)
            ]
            groups.append((words.GROUP_TITLES.get(group, group), cases))
        return {"groups": groups, "words": words}
