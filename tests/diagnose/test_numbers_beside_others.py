"""Numbers of what is told know what else may act: ordinary dissipation that was left out, members that are as good as absent."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.answer.intervals_told import intervals
from harness.diagnose.claims import idle_members as idle
from harness.diagnose.claims.conclude import conclude
from harness.diagnose.claims.dissipation_beside import fit_dissipation_beside
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.selection.investigation import investigate
from harness.effects.scale import swing


def test_friction_beside_damping_that_was_not_asked_for() -> None:
    """Of dry friction 4e-3 N·m beside drag a camera sees 2 mrad of noise: damping of 2e-4 N·m·s/rad beside them does not show by
    itself, and moves the friction by what it takes from the same decay. SciPy integrates all three.
    """
    rig = Rig(dry=4e-3, drag=2e-3, viscous=2e-4)
    runs = releases(rig, (1.4, 0.8, 1.1), 2e-3, seed=3, duration=12.0, rate=60.0)
    laws = ("coulomb_friction", "quadratic_drag", "viscous_damping")
    problem = pose(nominal(), runs)
    known = candidates(problem.system, runs, only=laws)
    outcome = investigate(
        problem, [c for c in known if c.effect.name != laws[2]], swing(problem.system, runs[0]) / (2.0 * np.pi)
    )
    conclusion = conclude(outcome)
    assert {c.candidate.effect.name for c in conclusion.claims} == set(laws[:2])
    alone = intervals(outcome, conclusion)["coulomb_friction@pivot"]["torque"]
    # The same search, of which damping is a candidate now that nothing has looked at beside the set.
    outcome.study.candidates = known
    beside = intervals(outcome, conclusion)["coulomb_friction@pivot"]["torque"]
    assert alone.low > rig.dry
    assert beside.low < rig.dry < beside.high


@pytest.mark.parametrize(("gain", "fitted"), [(6.0, ["viscous_damping@pivot"]), (0.5, [])])
def test_only_what_may_matter_is_fitted(gain: float, fitted: list[str]) -> None:
    """Of a thousand samples a number costs 6.9; what is more than 6 behind has no part in an interval."""
    runs = releases(Rig(), (0.5,), 1e-3, seed=1, duration=3.0, rate=50.0)
    known = candidates(nominal(), runs)
    told = next(c for c in known if c.effect.name == "coulomb_friction")
    begun: list[str] = []
    study = SimpleNamespace(
        candidates=known, samples=1000.0, numbers=lambda c: c.size,
        among=lambda base, laws: [SimpleNamespace(candidate=c, gain=gain if "viscous" in c.key else 0.0) for c in laws],
        extend=lambda base, score: begun.append(score.candidate.key),
    )  # fmt: skip
    best = SimpleNamespace(hypothesis=Hypothesis((told,)))
    fit_dissipation_beside(cast(Any, study), cast(Any, best), [told])
    assert begun == fitted


@pytest.mark.parametrize(
    ("size", "deviation", "kept"), [(0.5, 1.0, 1), (1.5, 1.0, 1), (2.5, 1.0, 2), (0.5, np.nan, 2), (0.5, np.inf, 2)]
)
def test_a_member_that_is_as_good_as_absent_is_left_out(
    monkeypatch: pytest.MonkeyPatch, size: float, deviation: float, kept: int
) -> None:
    """Two laws beside a force: one sure, one so many deviations from nothing, if these are known."""
    runs = releases(Rig(), (0.5,), 1e-3, seed=1, duration=3.0, rate=50.0)
    laws = [c for c in candidates(nominal(), runs) if c.effect.name in ("constant_torque", "coulomb_friction")]
    hypothesis = Hypothesis(tuple(sorted(laws, key=lambda c: c.key)))
    x, spread = np.array([size, 9.0]), np.array([deviation, 1.0])

    def reduced(base: Any, k: int) -> Any:
        return SimpleNamespace(hypothesis=base.hypothesis.without(k), x=np.delete(base.x, k))

    evidence = SimpleNamespace(beside=lambda study, f: SimpleNamespace(x=f.x, spread=spread[-len(f.x) :]))
    monkeypatch.setattr(idle, "from_internal", lambda member, values: values)
    outcome = SimpleNamespace(
        evidence=evidence, study=SimpleNamespace(reduce=reduced), predictor=SimpleNamespace(nominal=())
    )
    best = cast(Fit, SimpleNamespace(hypothesis=hypothesis, x=x))
    left = idle.without_idle(cast(Any, outcome), best).hypothesis
    assert left.keys[-1] == hypothesis.keys[1]
    assert len(left.members) == kept
