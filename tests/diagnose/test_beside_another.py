"""What is told apart beside one of two effects that look alike need not be beside the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.answer.diagnosis import rivals_of
from harness.diagnose.claims import rivals
from harness.diagnose.claims.constants import CROSSED_EVIDENCE
from harness.diagnose.claims.model_comparison import why_lost
from harness.diagnose.claims.rivals import beside_another
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linearisation import Linearisation
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.selection.exchange import Swap

RUB, LOAD, SLOW, SOFT = "viscous_damping", "load_dependent_friction", "sensor_lowpass", "base_compliance"


@pytest.fixture(scope="module")
def known() -> dict[str, Candidate]:
    recordings = releases(Rig(), (0.6, -0.4), 1e-3, seed=2, duration=2.0, rate=50.0)
    return {c.effect.name: c for c in candidates(nominal(), recordings)}


def fitted(members: Sequence[Candidate], score: float) -> Fit:
    nothing = Linearisation(score, (), (), np.zeros((0, 0)), np.zeros(0), (), ())
    return Fit(Hypothesis(tuple(members)), (), np.zeros(8), {}, nothing, 0.0, True, np.ones(8, dtype=bool))


def outcome_of(known: dict[str, Candidate], scores: dict[tuple[str, str], float]) -> tuple[SimpleNamespace, list[Fit]]:
    """A study that has fitted pairs of effects to these scores, in which all numbers cost nothing."""
    fits = [fitted([known[name] for name in names], score) for names, score in scores.items()]
    study = SimpleNamespace(
        fits={f.hypothesis.identity: f for f in fits}, criterion=lambda f: f.score, evidence=lambda f: f.score
    )
    return SimpleNamespace(study=study), fits


def test_a_rival_beside_what_the_partner_could_be_is_told_with_it(known: dict[str, Candidate]) -> None:
    scores = {(RUB, SLOW): 100.0, (RUB, SOFT): 105.0, (LOAD, SLOW): 120.0, (LOAD, SOFT): 112.0}
    outcome, fits = outcome_of(known, scores)
    found = beside_another(outcome, fits[0], 0)
    assert {c.effect.name: [m.effect.name for m in beside] for c, beside in found.items()} == {LOAD: [SOFT]}
    # The low-pass has a rival of its own, which is told wherever it stands; nothing further is one beside the other friction.
    assert beside_another(outcome, fits[0], 1) == {}


@pytest.mark.parametrize(
    "changed", [{(RUB, SOFT): 100.0 + 1.1 * UNPARTED_EVIDENCE}, {(LOAD, SOFT): 105.0 + 1.1 * UNPARTED_EVIDENCE}]
)
def test_what_the_recordings_part_is_not_told(
    known: dict[str, Candidate], changed: dict[tuple[str, str], float]
) -> None:
    scores = {(RUB, SLOW): 100.0, (RUB, SOFT): 105.0, (LOAD, SLOW): 120.0, (LOAD, SOFT): 112.0} | changed
    outcome, fits = outcome_of(known, scores)
    assert beside_another(outcome, fits[0], 0) == {}


@pytest.mark.parametrize(("alone", "tried"), [(0.5 * CROSSED_EVIDENCE, True), (1.1 * CROSSED_EVIDENCE, False)])
def test_both_exchanges_are_fitted_where_either_alone_is_not_hopeless(
    known: dict[str, Candidate], monkeypatch: pytest.MonkeyPatch, alone: float, tried: bool
) -> None:
    outcome, fits = outcome_of(known, {(RUB, SLOW): 100.0, (RUB, SOFT): 105.0, (LOAD, SLOW): 100.0 + alone})
    asked = []

    def exchanged(study: object, best: Fit, one: Swap, two: Swap, target: float) -> Fit:
        asked.append((one.candidate.effect.name, two.candidate.effect.name, target))
        return replace(best)

    monkeypatch.setattr(rivals, "exchanged", exchanged)
    rivals._crossed(outcome, fits[0])
    assert asked == ([(SOFT, LOAD, 105.0 + UNPARTED_EVIDENCE)] if tried else [])


def test_what_would_stand_beside_a_rival_is_told_with_it() -> None:
    finding = {
        "indistinguishable_from": [LOAD, "dahl_friction"],
        "only_beside": {LOAD: ["base_compliance@base", "x@y"]},
    }
    assert rivals_of(finding) == [f"{LOAD} (beside base_compliance@base or x@y)", "dahl_friction"]
    assert rivals_of({"indistinguishable_from": [LOAD]}) == [LOAD]
    assert rivals_of({}) == []


@pytest.mark.parametrize(
    ("score", "said"),
    [
        (85.0, "fits better (χ² by 15), too little for 2 more parameters"),
        (99.9, "fits no better with 2 more parameters"),
        (130.0, "fits the recordings worse (χ² by 30)"),
    ],
)
def test_why_a_set_of_more_numbers_lost(known: dict[str, Candidate], score: float, said: str) -> None:
    outcome, (best, other) = outcome_of(known, {(RUB, SLOW): 100.0, (RUB, SOFT): score})
    study = outcome.study
    study.samples, study.predictor = 4000.0, SimpleNamespace(nominal=())
    study.criterion = lambda f: f.score + np.log(study.samples) * f.hypothesis.size
    assert why_lost(study, best, other, 1.0, 1.0) == said
