"""One kind of picture for all the cases that have it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.cases.results import Results
from harness.report.figures.kinds import Kind


@dataclass(frozen=True)
class Story:
    kind: Kind
    template: str = "pictures.html"

    @property
    def anchor(self) -> str:
        return self.kind.figure

    @property
    def title(self) -> str:
        return self.kind.title

    def content(self, results: Results) -> Mapping[str, Any] | None:
        mine = [line for line in results.series if line.figure == self.kind.figure]
        pictures = []
        for case in dict.fromkeys(line.case for line in mine):
            lines = [line for line in mine if line.case == case]
            title = lines[0].title or results.titles.get(case, case)
            pictures.append((title, Markup(self.kind.draw(lines, f"{self.kind.figure}-{case}"))))
        return {"words": self.kind.words, "pictures": pictures} if pictures else None
