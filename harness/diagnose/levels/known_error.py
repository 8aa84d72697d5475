"""Errors of a known shape that no law of the catalogue makes, all that are looked for: see ``selection.model_error``."""

from __future__ import annotations

from harness.diagnose.criticism.doubt import LEVEL
from harness.diagnose.criticism.structure import structures
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.levels.differing_levels import comparable
from harness.diagnose.levels.unequal_friction import unequal_friction
from harness.diagnose.selection.model_error import KnownError
from harness.diagnose.selection.study import Study


def known_errors(study: Study, fitted: Fit) -> list[KnownError]:
    """All such errors that may be what a set leaves: one of a shape, or friction of several levels."""
    return structures(study, fitted) + _levels(study, fitted)


def _levels(study: Study, fitted: Fit) -> list[KnownError]:
    """A level of dry friction of its own in every recording."""
    asked = unequal_friction(study, fitted) if comparable(study.problem) else None
    if asked is None or asked.chance > LEVEL:
        return []
    there = max(fitted.score - study.samples, 0.0)
    return [KnownError(asked.share * there, len(asked.levels) - 1)]
