"""Ordinary dissipation beside what is told: every joint rubs, is damped and drags, if only by a little.

A search stops where a further law does not pay. The numbers of what is told then mean that there is none of the others at that
joint, which nobody knows: a little damping that was left out makes dry friction larger by many of its deviations. Where recordings
do not speak clearly against another such law beside the set, the set with it is fitted, and intervals reach over what it says
(``estimation.intervals.across``).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import STRONG_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, compatible
from harness.diagnose.selection.dissipation_starts import DISSIPATION
from harness.diagnose.selection.study import Study


def fit_dissipation_beside(study: Study, best: Fit, told: Iterable[Candidate]) -> None:
    """Fit a set with each law of dissipation that it lacks where it tells one, as far as a score test lets that matter."""
    sites = {member.site for member in told if member.effect.name in DISSIPATION}
    laws = [c for c in study.candidates if c.effect.name in DISSIPATION and c.site in sites]
    lacking = [c for c in laws if c.key not in best.hypothesis.keys and compatible(best.hypothesis, c)]
    for found in study.among(best, lacking):
        if found.gain > study.numbers(found.candidate) * float(np.log(study.samples)) - STRONG_EVIDENCE:
            study.extend(best, found)
