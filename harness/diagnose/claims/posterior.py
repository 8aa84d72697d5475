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
from harness.diagnose.selection.investigation import Outcome
from harness.diagnose.selection.state_evidence import placed
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


def posterior(outcome: Outcome, best: Fit) -> Posterior:
    """Posterior probabilities over the sets fitted; with a force over the state, where there is one.

    A set speaks for an effect of ``best`` if it has that on the same side of absence: what is more beside one law and less beside
    another is not known. Laws that were chosen among many places are pieces of a force over the state, where there is one, and sets
    with them are none of their own.
    """
    study, evidence = outcome.study, outcome.evidence
    fits = list(study.fits.values())
    if evidence is not None:
        fits = [f for f in fits if not any(map(placed, f.hypothesis.members))]
    if not fits:
        return Posterior(())  # the time was up before any set was weighed under the last likelihood
    values = np.array([study.criterion(f) if evidence is None else evidence.criterion(study, f) for f in fits])
    weights = np.exp(-0.5 * (values - values.min()))
    weights /= weights.sum()
    sides = _sides(study, best.hypothesis, best.x)
    rows = []
    for f, weight in zip(fits, weights.tolist(), strict=True):
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
