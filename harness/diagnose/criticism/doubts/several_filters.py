"""Several filters of sensors where one force that relaxes might do as well.

Where the swing is nearly linear any force with a memory looks like some filters. One such force is likelier than two filters
that come together, whatever its elements cost.
"""

from __future__ import annotations

from harness.diagnose.criticism.alternatives import tests_of
from harness.diagnose.criticism.checks import relaxing_force
from harness.diagnose.criticism.constants import UNNAMED_FORCE_BETTER
from harness.diagnose.criticism.reason import Reason, Suspect


def _filtered(suspect: Suspect) -> bool:
    best, smaller, missing = suspect.best, suspect.smaller, suspect.missing
    if len(missing) < 2 or any(effect.sensor is None or effect.sensor.memory is None for effect in missing):
        return False
    study = suspect.outcome.study
    there = min(smaller.score - best.score, smaller.score - study.samples)
    return any(test.gain >= there - UNNAMED_FORCE_BETTER for test in tests_of(study, smaller, [relaxing_force.CHECK]))


REASON = Reason("one force that relaxes is likelier than several filters", _filtered, together=True)
