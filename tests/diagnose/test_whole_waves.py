"""Cogging among efforts is more than possible where whole waves of it were seen, and next to nothing is left beside it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort_grades import _whole
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.catalogue import effect
from harness.effects.scale import References


@pytest.mark.parametrize(
    ("periods", "span", "excess", "whole"),
    [(11.0, 1.3, 5.0, True), (11.0, 0.4, 5.0, False), (11.0, 1.3, 50.0, False), (6.0, 1.3, 5.0, False)],
)
def test_a_piece_of_a_wave_is_any_smooth_force(periods: float, span: float, excess: float, whole: bool) -> None:
    """Eleven periods a turn are 2.3 waves in 1.3 rad and 0.7 in 0.4; six are 1.2 in 1.3."""
    q = np.linspace(-0.5 * span, 0.5 * span, 50)[:, None]
    run = SimpleNamespace(q=q, usable=np.ones(50, dtype=bool))
    model = SimpleNamespace(system=SimpleNamespace(joint_names=("wrist",)), runs=(run,))
    data: Any = SimpleNamespace(model=model)
    member = Candidate(effect("cogging_torque"), "wrist", References())
    values = {"periods": Estimate(periods, 0.05, periods - 0.1, periods + 0.1)}
    assert _whole(data, member, values, 1000.0, excess) is whole
