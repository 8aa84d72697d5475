"""Beyond the ends of where a give or a play was searched, which are ends of patience and not of physics.

What is as good as rigid depends on the noise. Everywhere else in a search stiffer equations would only take longer.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import internal_bounds
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.constants.search import CARRIED_STEPS
from harness.diagnose.selection.constants.starts import FURTHER_REACH
from harness.diagnose.selection.study import Study


def beyond_the_ends(study: Study, fitted: Fit) -> Fit:
    """The fit, continued if a member that adds coordinates stands at an end of its search."""
    reach = study.predictor.reach
    at_end = [
        m.key for k, m in enumerate(fitted.hypothesis.members) if m.key not in reach and _at_end(study, fitted, k, m)
    ]
    if not at_end:
        return fitted
    reach.update(dict.fromkeys(at_end, FURTHER_REACH))
    return study.fit(fitted.hypothesis, [fitted.x], fitted, most_steps=CARRIED_STEPS)


def _at_end(study: Study, fitted: Fit, k: int, member: Candidate) -> bool:
    """Whether a parameter of member ``k`` could go further if it were let."""
    if not member.effect.adds_coordinates:
        return False
    first = len(study.predictor.nominal) + fitted.hypothesis.span(k).start
    own = fitted.x[first : first + member.size]
    (low, high), (lower, upper) = internal_bounds(member), internal_bounds(member, FURTHER_REACH)
    return bool(np.any(((own <= low) & (lower < low)) | ((own >= high) & (upper > high))))
