"""What efforts do not turn on is told with the width beyond which nothing is known, not with any number that division leaves."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.claims.grades import effect_says_not_what
from harness.diagnose.estimation.constants import NORMAL_95, WIDEST_INTERVAL
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_grades import estimates
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis


def test_a_number_of_no_influence_is_as_wide_as_nothing_known():
    recordings = releases(Rig(), (0.6, -0.4), 1e-3, seed=2, duration=2.0, rate=50.0)
    (member,) = (c for c in candidates(nominal(), recordings) if c.effect.name == "stribeck_friction")
    scales = np.asarray(member.scales, dtype=float)
    # 200 rows that the first number alone moves, by one each for a step of its scale: σ of that is scale/√200.
    jacobian = np.zeros((200, member.size))
    jacobian[:, 0] = 1.0 / scales[0]
    jacobian[:, 1] = 1e-200
    fitted = EffortFit(
        Hypothesis((member,)), scales.copy(), np.ones(200), np.zeros(200, dtype=int), jacobian, 0.0, 200.0
    )
    found = estimates(fitted, 0, 0)
    names = [p.name for p in member.effect.parameters]
    assert found[names[0]].std == pytest.approx(scales[0] / np.sqrt(200.0))
    for j, name in enumerate(names[1:], 1):
        assert found[name].std == pytest.approx(WIDEST_INTERVAL * scales[j])
        assert found[name].high <= scales[j] * (1.0 + NORMAL_95 * WIDEST_INTERVAL) * (1.0 + 1e-12)
        assert not effect_says_not_what(member, {names[0]: found[names[0]], name: found[name]})
