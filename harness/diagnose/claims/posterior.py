"""How probable every effect is over all sets that were fitted.

Bayesian model averaging (Hoeting et al., Stat. Sci. 14 (1999) 382).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.state_evidence import piece_of_a_force
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Posterior:
    """The share of every set that was fitted, with the keys of its members that speak for an effect of the best one."""

    rows: Sequence[tuple[float, frozenset[str]]]

    def of(self, keys: Iterable[str]) -> float:
        """How probable it is that any of these is there."""
        asked = frozenset(keys)
        return min(1.0, float(sum(share for share, own in self.rows if own & asked)))


def weighed(outcome: Outcome, *, at_hand: bool = False) -> list[tuple[float, Fit]]:
    """The sets that were fitted, each with its share of the posterior; beside a force over the state, where there is one.

    Laws that were chosen among many places are pieces of such a force unless whole waves of them were seen, and sets with them
    none of their own. at_hand: only those that have been looked at beside that force, so that no run is needed.
    """
    study, evidence = outcome.study, outcome.evidence
    fits = list(study.fits.values())
    if evidence is not None:
        fits = [f for f in fits if not piece_of_a_force(study, f) and (not at_hand or evidence.has(f))]
    if not fits:
        return []  # the time was up before any set was weighed under the last likelihood
    values = np.array([study.criterion(f) if evidence is None else evidence.criterion(study, f) for f in fits])
    weights = np.exp(-0.5 * (values - values.min()))
    return list(zip((weights / weights.sum()).tolist(), fits, strict=True))


def posterior(outcome: Outcome, best: Fit, *, at_hand: bool = False) -> Posterior:
    """Posterior probabilities over the sets fitted. at_hand: see ``weighed``.

    A set speaks for an effect of ``best`` if it has that on the same side of absence: what is more beside one law and less beside
    another is not known.
    """
    study, evidence = outcome.study, outcome.evidence
    sides = _sides(study, best.hypothesis, best.x)
    rows = []
    for weight, f in weighed(outcome, at_hand=at_hand):
        own = _sides(study, f.hypothesis, f.x if evidence is None else evidence.beside(study, f).x)
        rows.append((weight, frozenset(key for key, side in own.items() if side * sides.get(key, side) >= 0.0)))
    return Posterior(rows)


def _sides(study: Study, hypothesis: Hypothesis, x: Array) -> dict[str, float]:
    """On which side of absence the first number of every member is; 0 where there is no such side."""
    out = {}
    for k, member in enumerate(hypothesis.members):
        values = study.predictor.effect_values(hypothesis, k, x)
        neutral = next((p.neutral for p in member.effect.parameters), np.nan)
        out[member.key] = float(np.sign(values[0] - neutral)) if len(values) and np.isfinite(neutral) else 0.0
    return out
