"""A diagnosis as one HTML page that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.cases.case import Series
from harness.report.diagnosis.sections import Answer, BeforeAndAfter, Data, Lines, Rivals, Where
from harness.report.html import page
from harness.report.sections.section import Section


def diagnosis_html(document: Mapping[str, Any], series: Sequence[Series] = ()) -> str:
    """The page of a ``denoc.diagnosis/1`` document; series: further pictures."""
    sections: list[Section] = [Answer(), BeforeAndAfter(), Where(), Lines(series), Rivals(), Data()]
    return page("What the model left out", document, sections)
