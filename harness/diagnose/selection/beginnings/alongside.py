"""Beside what it modifies, so that both together act about as that alone did."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.beginning import Addition, Beginning

Array = NDArray[np.float64]


def alongside(candidate: Candidate, modified: Candidate, values: Array) -> list[tuple[Array, Array]]:
    """Starting values of an effect and of what it modifies, with which both together act about as that does at ``values``."""
    together = candidate.effect.alongside
    if together is None:
        return []
    found = []
    for point in product(*(p.start_values(candidate.references) for p in candidate.effect.parameters)):
        other = together(candidate.effect.named(point), modified.effect.named(values), candidate.references)
        found.append((np.array(point), np.array([other[name] for name in modified.effect.parameter_names])))
    return found


def _starts(addition: Addition) -> list[Array]:
    predictor, base, candidate = addition.bench.predictor, addition.base, addition.candidate
    starts = []
    for k, member in enumerate(base.hypothesis.members):
        if member.site == candidate.site and member.effect.name in candidate.effect.modifies:
            values = predictor.effect_values(base.hypothesis, k, base.x)
            for own, other in alongside(candidate, member, values):
                x = predictor.with_values(base.hypothesis, k, base.x, other)
                starts.append(np.concatenate([x, to_internal(candidate, own)]))
    return starts


BEGINNING = Beginning("with what it modifies", _starts)
