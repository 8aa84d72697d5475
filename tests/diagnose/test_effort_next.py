"""What to record next, where efforts leave two effects that they cannot tell apart."""

from __future__ import annotations

from harness.diagnose.inverse.effort_next import next_experiment
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.catalogue import catalogue
from harness.effects.scale import References


def _at(name: str, site: str) -> Candidate:
    return Candidate(catalogue()[name], site, References())


def test_one_effect_at_two_joints_is_told_with_them_and_parted_by_moving_each() -> None:
    pair = _at("added_inertia", "wrist"), _at("added_inertia", "shoulder")
    proposed = next_experiment([pair], gravity=True)
    assert proposed["separates"] == ["added_inertia@wrist", "added_inertia@shoulder"]
    assert "move wrist alone" in proposed["what"]
    assert "then shoulder alone" in proposed["what"]


def test_weight_and_inertia_are_parted_at_rest_which_a_geared_joint_can_do() -> None:
    pair = _at("payload_mass", "tool"), _at("added_inertia", "wrist")
    proposed = next_experiment([pair], gravity=True)
    assert proposed["separates"] == ["payload_mass", "added_inertia"]
    assert "postures" in proposed["what"]
    assert "swing" not in proposed["what"]
    assert "postures" not in next_experiment([pair], gravity=False)["what"]


def test_the_scale_of_the_effort_comes_first() -> None:
    scale = _at("payload_mass", "tool"), _at("actuator_gain", "wrist")
    other = _at("coulomb_friction", "wrist"), _at("stribeck_friction", "wrist")
    assert "known weight" in next_experiment([other, scale], gravity=True)["what"]
    assert "slowly" in next_experiment([other], gravity=True)["what"]
    assert next_experiment([], gravity=True) == {"what": "", "separates": []}
