"""Sets that differ by one member: which of two effects may stand for one another, and exchanges of one or two members of a set.

A set may be right in all but one member, and no growing repairs that. What is exchanged for what is a file each (``rewrites/``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import Candidate, compatible
from harness.diagnose.selection.study import Study


def related(member: Candidate, other: Candidate) -> bool:
    """Whether two candidates are forms of one thing, or known for being taken for one another."""
    a, b = member.effect, other.effect
    if a.name in b.simpler or b.name in a.simpler:
        return member.site == other.site
    return a.name in b.confusable_with or b.name in a.confusable_with


def known_in_place_of(study: Study, best: Fit, k: int) -> list[tuple[Candidate, Fit]]:
    """All known fits that differ from a set by another candidate in the place of member ``k``, with that candidate."""
    member, kept = best.hypothesis.members[k], best.hypothesis.without(k).identity
    return [
        (next(m for m in other.hypothesis.members if m.key not in kept), other)
        for key, other in study.fits.items()
        if kept < key and member.key not in key and len(key) == len(kept) + 1
    ]


@dataclass(frozen=True, eq=False)
class Swap:
    """A fit that differs from the best one by ``candidate`` in the place of member ``k``, and by how much it is worse."""

    worse: float
    k: int
    candidate: Candidate
    fit: Fit


def swaps(study: Study, best: Fit) -> list[Swap]:
    """All known fits that differ from the best one by one member, likeliest first."""
    own = study.criterion(best)
    found = [
        Swap(study.criterion(other) - own, k, new, other)
        for k in range(len(best.hypothesis.members))
        for new, other in known_in_place_of(study, best, k)
    ]
    return sorted(found, key=lambda s: s.worse)


def exchanged(study: Study, best: Fit, one: Swap, two: Swap, target: float = -np.inf) -> Fit | None:
    """A fit with both swaps of a set made at once, begun from the first one's; None if that is known, or no set."""
    place = one.fit.hypothesis.keys.index(best.hypothesis.keys[two.k])
    rest = one.fit.hypothesis.without(place)
    if not compatible(rest, two.candidate) or study.known(rest.with_(two.candidate)) is not None:
        return None
    span = two.fit.hypothesis.span(two.fit.hypothesis.keys.index(two.candidate.key))
    own = two.fit.x[len(study.predictor.nominal) :][span]
    start = np.concatenate([study.without(one.fit, place), own])
    return study.fit(rest.with_(two.candidate), [start], one.fit, target=target)
