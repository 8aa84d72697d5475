"""Motions as a page of their own that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.report.animation.scene import Scene
from harness.report.html import page


@dataclass(frozen=True)
class Moving:
    words: str
    anchor: str = "animation"
    title: str = "In motion"
    template: str = "diagnosis_plots.html"

    def content(self, subject: Scene) -> Mapping[str, Any]:
        return {"words": self.words, "plots": [subject.html()], "pictures": []}


def animation_html(shown: Scene, words: str = "") -> str:
    """The page of a scene; words: a line above it."""
    return page(shown.title, shown, [Moving(words)])
