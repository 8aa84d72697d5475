"""Errors of a known shape that no law of the catalogue makes, all that are looked for: see ``selection.model_error``."""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.constants import TEST_CHANCE
from harness.diagnose.criticism.structure import worth_of_structure
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.levels.differing_levels import comparable
from harness.diagnose.levels.unequal_friction import unequal_friction
from harness.diagnose.selection.study import Study


def worth_of_known_error(study: Study, fitted: Fit, of_state: bool) -> float:
    """What the likeliest such error gains in the criterion beyond its price: one of a shape, or friction of several levels.

    of_state: whether forces over the state are among them.
    """
    return max(worth_of_structure(study, fitted, of_state=of_state), _worth_of_levels(study, fitted))


def _worth_of_levels(study: Study, fitted: Fit) -> float:
    """The same of a level of dry friction of its own in every recording."""
    if not comparable(study.problem):
        return 0.0
    asked = unequal_friction(study, fitted)
    if asked is None or asked.chance > TEST_CHANCE:
        return 0.0
    there = max(fitted.score - study.samples, 0.0)
    return asked.share * there - (len(asked.levels) - 1) * float(np.log(study.samples))
