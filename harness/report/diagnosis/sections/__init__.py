"""Sections of a diagnosis's page, a small class and a template each, in the order in which they are read."""

from harness.report.diagnosis.sections.animation import Animation
from harness.report.diagnosis.sections.answer import Answer
from harness.report.diagnosis.sections.data import Data, Provenance
from harness.report.diagnosis.sections.disagreement import Disagreement
from harness.report.diagnosis.sections.findings import Correlations, Findings, Repeatability
from harness.report.diagnosis.sections.fit import BeforeAndAfter, Levels, Replay
from harness.report.diagnosis.sections.force import MissingForce, UnnamedForce
from harness.report.diagnosis.sections.motion import Motion, Residuals
from harness.report.diagnosis.sections.remainder import Remainder
from harness.report.diagnosis.sections.rivals import Rivals
from harness.report.diagnosis.sections.where import Where

__all__ = [
    "Animation",
    "Answer",
    "BeforeAndAfter",
    "Correlations",
    "Data",
    "Disagreement",
    "Findings",
    "Levels",
    "MissingForce",
    "Motion",
    "Provenance",
    "Remainder",
    "Repeatability",
    "Replay",
    "Residuals",
    "Rivals",
    "UnnamedForce",
    "Where",
]
