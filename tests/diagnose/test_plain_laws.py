"""Plain laws that free runs speak for, where the evidence beside a force over the state speaks for another set."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnose.claims import plain_laws as module
from harness.diagnose.claims.plain_laws import plain_laws
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.effects.catalogue import catalogue
from harness.effects.scale import References


def _member(name: str) -> Candidate:
    return Candidate(catalogue()[name], "servo", References(1.0, 1.0, 1.0, 1.0, 1.0, 1.0))


SAMPLES = 20.0


def _set(criterion: float, held: float, *names: str, stretched: bool = False, left: float = 1.0) -> Any:
    """A set with its criterion by free runs and what it leaves of the data held out.

    stretched: with bent nominal quantities. left: variance of what free runs leave, in units of what noise is taken for.
    """
    members = Hypothesis(tuple(map(_member, names)))
    return SimpleNamespace(
        hypothesis=members, criterion=criterion, held=held, score=criterion, stretched=stretched, cost=left * SAMPLES
    )


def _told(monkeypatch: pytest.MonkeyPatch, best: Any, *others: Any, sure: bool = False) -> Any:
    fits = {f.hypothesis.identity: f for f in (best, *others)}
    study = SimpleNamespace(
        criterion=lambda f: f.criterion, stretched=lambda f: f.stretched, fits=fits, samples=SAMPLES
    )
    monkeypatch.setattr(module, "judge", lambda outcome, fitted: SimpleNamespace(cost=fitted.held))
    outcome: Any = SimpleNamespace(study=study)
    return plain_laws(outcome, best, sure=sure)


NOTHING = _set(388.0, 100.0)
WEIGHT = _set(15.0, 1.3, "payload_mass", "viscous_damping")


def test_plain_laws_that_foretell_far_more_are_told_instead(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _told(monkeypatch, NOTHING, WEIGHT, _set(145.0, 34.0, "coulomb_friction")) is WEIGHT


def test_what_fits_no_better_beyond_doubt_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _told(monkeypatch, _set(20.0, 100.0), WEIGHT) is None


@pytest.mark.parametrize(("left", "told"), [(0.6, False), (1e-4, True)])
def test_free_runs_that_leave_far_less_are_likelier_by_the_logarithm_of_that(
    monkeypatch: pytest.MonkeyPatch, left: float, told: bool
) -> None:
    # Under noise as loud as the best set leaves it, the weight is likelier by 20 − 20 left and costs 14 for its numbers: never by
    # ten. With noise as loud as each leaves it, it is likelier by −20 ln left: 10.2 or 184.2.
    law = _set(34.0 - SAMPLES * (1.0 - left), 1.3, "payload_mass", left=left)
    assert (_told(monkeypatch, _set(20.0, 100.0), law) is law) == told


@pytest.mark.parametrize(("times", "told"), [(1.9, False), (2.0, True)])
def test_the_data_held_out_have_a_say(monkeypatch: pytest.MonkeyPatch, times: float, told: bool) -> None:
    # An error 1.4 times as large is one of 1.96 times the squares.
    found = _told(monkeypatch, _set(388.0, times * WEIGHT.held), WEIGHT)
    assert (found is WEIGHT) == told


@pytest.mark.parametrize(("times", "told"), [(3.2, False), (3.3, True)])
def test_and_more_of_one_where_the_evidence_speaks_for_a_law(
    monkeypatch: pytest.MonkeyPatch, times: float, told: bool
) -> None:
    # An error 1.8 times as large is one of 3.24 times the squares.
    best = _set(388.0, times * WEIGHT.held, "coulomb_friction")
    assert (_told(monkeypatch, best, WEIGHT, sure=True) is WEIGHT) == told


@pytest.mark.parametrize(("bent", "times", "told"), [(False, 1.1, True), (False, 0.9, False), (True, 1.1, False)])
def test_a_model_bent_far_beyond_its_tolerance_foretells_nothing_for_the_drawing(
    monkeypatch: pytest.MonkeyPatch, bent: bool, times: float, told: bool
) -> None:
    # Laws that need no such bending foretell no worse; those that are bent themselves have to foretell 1.4 times better, as ever.
    law = _set(15.0, 1.3, "payload_mass", "viscous_damping", stretched=bent)
    best = _set(388.0, times * law.held, stretched=True)
    assert (_told(monkeypatch, best, law) is law) == told


def test_of_laws_that_free_runs_do_not_part_the_fewest_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    more = _set(9.0, 1.2, "payload_mass", "viscous_damping", "coulomb_friction")
    assert _told(monkeypatch, NOTHING, more, WEIGHT) is WEIGHT
    assert (
        _told(monkeypatch, NOTHING, _set(4.0, 1.2, "payload_mass", "viscous_damping", "coulomb_friction"), WEIGHT)
        is not WEIGHT
    )


@pytest.mark.parametrize("name", ["cogging_torque", "sensor_delay", "stribeck_friction"])
def test_what_can_be_bent_to_many_shapes_is_not_told_instead(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    assert _told(monkeypatch, NOTHING, _set(1.0, 0.1, "viscous_damping", name)) is None


def test_what_has_lost_the_recordings_is_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    lost = _set(1.0, 0.1, "payload_mass")
    lost.score = np.inf
    assert _told(monkeypatch, NOTHING, lost) is None


def test_of_ordinary_laws_at_every_joint_those_go_that_free_runs_are_likelier_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # −2 log L of friction and drag is 20, a rotor and a constant force change nothing and cost 4 each; without drag it is 60.
    costs = {"quadratic_drag": -40.0, "coulomb_friction": -40.0, "added_inertia": 4.0, "constant_torque": 4.0}
    asked: list[frozenset[str]] = []

    def of(names: tuple[str, ...]) -> Any:
        asked.append(frozenset(names))
        return _set(100.0 + sum(costs[name] for name in names), 1.0, *names)

    def reduce(fitted: Any, k: int) -> Any:
        left = [member.effect.name for member in fitted.hypothesis.members]
        return of(tuple(left[:k] + left[k + 1 :]))

    predictor = SimpleNamespace(nominal=())
    study: Any = SimpleNamespace(criterion=lambda f: f.criterion, samples=SAMPLES, reduce=reduce, predictor=predictor)
    monkeypatch.setattr(module, "rise_without", lambda f, nominal, k: -costs[f.hypothesis.members[k].effect.name])
    monkeypatch.setattr(module, "ordinary_everywhere", lambda study, near: [of(tuple(costs))])
    module.fit_ordinary(study, NOTHING)
    # One fit for every member that goes, and one that shows that no more may.
    assert [len(names) for names in asked] == [4, 3, 2, 1]
    assert asked[2] == frozenset({"quadratic_drag", "coulomb_friction"})
