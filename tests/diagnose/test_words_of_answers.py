"""Words of an answer that are worked out apart from it: why a set lost, what pushed, what the next experiment does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import click
import numpy as np
import pytest

from harness.cli.diagnose import diagnose as diagnose_verb
from harness.cli.validate import validate as validate_verb
from harness.diagnose.answer import next_experiment as next_one
from harness.diagnose.claims.model_comparison import why_lost
from harness.diagnose.experiment.design import Proposal
from harness.diagnose.inverse.effort import _note
from harness.system import Joint, JointType, Link, System


def fitted(*keys: str, cost: float) -> Any:
    members = tuple(SimpleNamespace(key=k, effect=SimpleNamespace(name=k.split("@")[0])) for k in keys)
    own = SimpleNamespace(identity=frozenset(keys), members=members, keys=keys, size=len(keys))
    return SimpleNamespace(hypothesis=own, cost=cost, prior=0.0, x=np.zeros(0))


def study(*fits: Any) -> Any:
    """Of a thousand samples; sets are as good as their χ² and their numbers make them."""
    return SimpleNamespace(
        fits={f.hypothesis.identity: f for f in fits}, samples=1000, predictor=SimpleNamespace(nominal=()),
        criterion=lambda f: f.cost + 7.0 * f.hypothesis.size,
    )  # fmt: skip


def test_a_set_of_nothing_is_not_said_to_want_bearing_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """It has the least criterion of all, but what is told fits better, and foretells the data held out so."""
    monkeypatch.setattr("harness.diagnose.claims.model_comparison.as_stated", lambda study, other: other)
    nothing, told = fitted(cost=1005.0), fitted("constant_torque@pivot", cost=1000.0)
    said = why_lost(cast(Any, study(nothing, told)), told, nothing, 24.0, 19.0)
    assert said == "fits the recordings worse (χ² by 5), predicts the data held out 26 % worse"
    # What has effects and leads without being claimed does want it.
    friction = fitted("coulomb_friction@pivot", cost=990.0)
    assert "not borne out" in why_lost(cast(Any, study(friction, told)), told, friction, 19.0, 19.0)


def test_a_vast_misfit_is_told_by_three_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    told, other = fitted("actuator_saturation@pivot", cost=1e3), fitted("joint_stiffness@pivot", cost=437677887302.0)
    said = why_lost(cast(Any, study(told, other)), told, other, 2900.0, 1.0)
    assert said == "fits the recordings worse (χ² by 4.38e11), predicts the data held out 2,900 times worse"


@pytest.mark.parametrize(("kind", "unit"), [(JointType.PRISMATIC, "N"), (JointType.REVOLUTE, "N·m")])
def test_what_pushes_is_told_in_the_joints_unit(kind: JointType, unit: str) -> None:
    joint = Joint("rail", kind, "base", "cart", axis=np.array([1.0, 0.0, 0.0]))
    system = System("rig", (joint,), (Link("cart", 1.0, np.zeros(3), np.eye(3) * 0.01),))
    push = SimpleNamespace(joint=0, first=6.36, last=6.63, peak=0.34)
    note = _note(system, cast(Any, SimpleNamespace(time=np.arange(0.0, 10.0, 0.01))), cast(Any, push))
    assert f"pushes rail with up to -0.34 {unit}: the motion" in note.what


@pytest.mark.parametrize(("size", "proposed"), [(40.0, True), (1.0, False)])
def test_an_experiment_parts_no_pair_that_the_answer_does_not_tell(
    monkeypatch: pytest.MonkeyPatch, size: float, proposed: bool
) -> None:
    """Nothing is left open: the runner-up is tried, and named as that."""
    monkeypatch.setattr(next_one, "propose", lambda study, pairs: Proposal("release from 0.15 rad", pairs[0][2], size))
    best, second = fitted("actuator_saturation@pivot", cost=1.0), fitted("sensor_highpass@pivot.position", cost=9.0)
    claim = SimpleNamespace(rival_candidates=())
    outcome = SimpleNamespace(study=None, ordered=(best, second))
    found = next_one._proposed(cast(Any, outcome), cast(Any, SimpleNamespace(claims=(claim,), best=best)))
    assert found["separates"] == []
    assert found["what"] == (
        "release from 0.15 rad, where the likeliest set beside what is told (sensor_highpass@pivot.position) would show most "
        "that it is wrong"
        if proposed
        else ""
    )


def test_workers_of_a_diagnosis_are_told_to_be_of_a_fleet() -> None:
    def told(verb: click.Command, name: str) -> str:
        return next(p.help or "" for p in verb.params if isinstance(p, click.Option) and p.name == name)

    assert all("with --fleet" in told(diagnose_verb, name) for name in ("workers", "dask"))
    assert "--fleet" not in told(validate_verb, "workers")
