"""Beside a remainder, a number many times what its effect is named for is possible at most: the model is far off elsewhere."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.claims.grades import ESTABLISHED, LIKELY, POSSIBLE, grade
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.candidates import candidates


@pytest.mark.parametrize(
    ("offset", "remainder", "expected"),
    [
        # A centre of mass a tenth of the link off is usual, one eleven lengths off is no such thing; the link is 0.3 m long.
        (0.03, True, LIKELY),
        (0.3, True, LIKELY),
        (-3.3, True, POSSIBLE),
        (3.3, True, POSSIBLE),
        (3.3, False, ESTABLISHED),
    ],
)
def test_a_size_beyond_belief(offset: float, remainder: bool, expected: str) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    outcome = SimpleNamespace(force=None)
    conclusion = SimpleNamespace(hurried=False, remains=SimpleNamespace(significant=remainder))
    values = {"offset": Estimate(offset, 0.01, offset - 0.02, offset + 0.02)}
    assert grade(outcome, conclusion, claim, values, []) == expected


@pytest.mark.parametrize(("level", "expected"), [(1.0, ESTABLISHED), (3.0, POSSIBLE)])
def test_what_there_was_no_time_to_weigh_is_possible_unless_it_leaves_noise_alone(level: float, expected: str) -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    claim = SimpleNamespace(candidate=known["com_offset@rod"])
    study = SimpleNamespace(likelihood=SimpleNamespace(rounded=1.0))
    outcome = SimpleNamespace(force=None, evidence=None, study=study)
    conclusion = SimpleNamespace(hurried=True, level=level, remains=SimpleNamespace(significant=False))
    values = {"offset": Estimate(0.03, 0.001, 0.028, 0.032)}
    assert grade(outcome, conclusion, claim, values, []) == expected
