"""Seeds of the search that no single effect leads to: the ordinary dissipation of a joint, all of it at once.

Bearings rub, air drags, and what the model states of damping is often a fit to the sum of both. One of these alone explains
little where the stated damping is wrong in sign or size, so a search that adds one effect at a time takes another way.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import start_vector, to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]

SETS = (
    ("viscous_damping", "coulomb_friction"),
    ("viscous_damping", "coulomb_friction", "quadratic_drag"),
)


def ordinary(study: Study, near: Fit) -> list[Fit]:
    """Fits of dry friction with viscous and quadratic drag at every joint that can have them; best first.

    near: a fit whose initial states are begun from.
    """
    by_site: dict[str, dict[str, Candidate]] = {}
    for candidate in study.candidates:
        by_site.setdefault(candidate.site, {})[candidate.effect.name] = candidate
    found = []
    for at in by_site.values():
        for names in SETS:
            if not all(name in at for name in names):
                continue
            hypothesis = Hypothesis(tuple(at[name] for name in names))
            known = study.fits.get(hypothesis.identity)
            found.append(known or study.fit(hypothesis, _starts(study, hypothesis, near), near))
    return sorted(found, key=study.criterion)


def _starts(study: Study, hypothesis: Hypothesis, near: Fit) -> Sequence[Array]:
    """The nominal quantities as stated; damping as stated, and with most of the stated taken away."""
    nominal = np.zeros(len(study.predictor.nominal))
    usual = [start_vector(member) for member in hypothesis.members]
    starts = [np.concatenate([nominal, *usual])]
    lowest = [float(member.effect.lower[0]) for member in hypothesis.members]
    if any(-np.inf < low < 0.0 for low in lowest):
        less = [
            to_internal(member, np.array([0.9 * low])) if -np.inf < low < 0.0 else start
            for member, low, start in zip(hypothesis.members, lowest, usual, strict=True)
        ]
        starts.append(np.concatenate([nominal, *less]))
    return starts
