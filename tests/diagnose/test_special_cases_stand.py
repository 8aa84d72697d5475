"""A law that has a special case stands against that, in a set found from efforts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from harness.diagnose.inverse.effort_settle import standing
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.effects.catalogue import effect
from harness.effects.scale import References


def fit(name: str, cost: float) -> Any:
    members = (Candidate(effect(name), "wrist", References()),) if name else ()
    return SimpleNamespace(hypothesis=Hypothesis(members), cost=cost, prior=0.0)


@pytest.mark.parametrize(("plain", "told"), [(101.0, "coulomb_friction"), (140.0, "stribeck_friction")])
def test_falling_friction_that_does_not_pay_beside_dry_friction_is_dry_friction(plain: float, told: str) -> None:
    """That something rubs is beyond doubt (900 without it), not that its friction falls."""
    falling, dry, nothing = fit("stribeck_friction", 100.0), fit("coulomb_friction", plain), fit("", 1000.0)
    study: Any = SimpleNamespace(
        criterion=lambda f: f.cost,
        heldout_z=lambda smaller, larger: 9.0,
        from_nothing=lambda f, k: 9.0,
        parting=lambda better, other: 9.0,
        seen_without=lambda f, k: nothing,
        plainer=lambda f, k: dry if f is falling else nothing,
    )
    found = standing(study, falling)
    assert [member.effect.name for member in found.hypothesis.members] == [told]
