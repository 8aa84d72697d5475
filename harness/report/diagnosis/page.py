"""A diagnosis as one HTML page that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.diagnose.answer.curves import Curves
from harness.effects.force_table import ForceTable
from harness.report.diagnosis import sections
from harness.report.html import page
from harness.report.sections.notes import ModelNotes
from harness.report.sections.section import Section
from harness.system import System


def diagnosis_html(
    document: Mapping[str, Any],
    curves: Curves | None = None,
    system: System | None = None,
    unnamed: ForceTable | None = None,
) -> str:
    """The page of a ``denoc.diagnosis/1`` document; curves: what its pictures are drawn from; system: what is seen to move;
    unnamed: the force over the state in the best predicting model."""
    parts: list[Section] = [
        sections.Answer(),
        sections.Motion(curves),
        sections.Animation(curves, system),
        sections.Findings(),
        sections.Disagreement(),
        sections.Residuals(curves),
        sections.BeforeAndAfter(),
        sections.Repeatability(),
        sections.Correlations(),
        sections.Levels(),
        sections.Where(),
        sections.MissingForce(curves),
        sections.UnnamedForce(curves, unnamed),
        sections.Remainder(),
        sections.Rivals(),
        sections.Replay(),
        ModelNotes(),
        sections.Data(),
        sections.Provenance(),
    ]
    return page("What the model left out", document, parts, line_of(document))


def line_of(document: Mapping[str, Any]) -> str:
    """Which recordings, which model, which version, when: the line below the title."""
    told = document.get("provenance")
    if not told:
        return ""
    names = [row["recording"] for row in told["recordings"]]
    listed = ", ".join(names) if len(names) <= 4 else f"{', '.join(names[:3])} and {len(names) - 3} more"
    return f"{listed} against {told['model']['name']}; denoc-harness {told['version']}, {when(told['created'])}"


def when(moment: str) -> str:
    """An ISO 8601 moment in UTC as it is read: day, minute."""
    return moment.replace("T", " ").replace("+00:00", " UTC")
