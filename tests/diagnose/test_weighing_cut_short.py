"""Of sets that there is no time to weigh, what leaves least is weighed all the same, and nothing at all."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from simulated_recordings import Rig, nominal, releases

from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.deadline import Deadline, TimeUp
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.selection.search_beside_force import likeliest_beside


class _Evidence:
    """Evidence whose time is up with the first set that has not been looked at before."""

    def __init__(self, values: dict[frozenset[str], float], looked: frozenset[str]) -> None:
        self.values, self.looked = values, looked

    def has(self, fitted: SimpleNamespace) -> bool:
        return bool(fitted.hypothesis.identity == self.looked)

    def beside(self, *_: object, **__: object) -> None:
        raise TimeUp

    def criterion(self, _: object, fitted: SimpleNamespace) -> float:
        return self.values[fitted.hypothesis.identity]


def test_what_was_not_weighed_is_not_passed_over_for_what_is_far_worse() -> None:
    known = {c.key: c for c in candidates(nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0))}
    sets = [
        Hypothesis(tuple(known[key] for key in keys))
        for keys in (
            (),
            ("viscous_damping@pivot",),
            ("coulomb_friction@pivot",),
            ("viscous_damping@pivot", "end_stop@pivot"),
        )
    ]
    empty, worse, looked, nearest = (one.identity for one in sets)
    fits: list[Any] = [
        SimpleNamespace(hypothesis=one, score=score) for one, score in zip(sets, (2e8, 1.5e8, 1.4e8, 5e2), strict=True)
    ]
    study: Any = SimpleNamespace(predictor=SimpleNamespace(deadline=Deadline()), candidates=())

    def likeliest(values: dict[frozenset[str], float]) -> frozenset[str]:
        evidence: Any = _Evidence(values, looked)
        found = likeliest_beside(study, evidence, fits, lambda _: None)
        return frozenset(found.hypothesis.identity)

    # The set that a stop is in leaves 300,000 times less; the one that was looked at before is worse than nothing.
    assert likeliest({empty: 245.0, worse: 240.0, looked: 260.0, nearest: 53.0}) == nearest
    assert likeliest({empty: 245.0, worse: 240.0, looked: 260.0, nearest: 300.0}) == empty
