"""A diagnosis as one HTML page that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.diagnose.curves import Curves
from harness.report.diagnosis.sections import Answer, BeforeAndAfter, Data, Levels, Pictures, Replay, Rivals, Where
from harness.report.html import page
from harness.report.sections.notes import ModelNotes
from harness.report.sections.section import Section


def diagnosis_html(document: Mapping[str, Any], curves: Curves | None = None) -> str:
    """The page of a ``denoc.diagnosis/1`` document; curves: what its pictures are drawn from."""
    sections: list[Section] = [
        Answer(),
        BeforeAndAfter(),
        Levels(),
        Where(),
        Pictures(curves),
        Rivals(),
        Replay(),
        ModelNotes(),
        Data(),
    ]
    return page("What the model left out", document, sections)
