"""Something that gives, begun where it vibrates or gives as something else that gives does."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.selection.constants.starts import (
    EIGENVALUE_ROUNDING,
    LEAST_DAMPING_RATIO,
    OWN_MODE_SHARE,
    SAME_START_RATIO,
)
from harness.effects.directions import sideways
from harness.system.description import constant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Give:
    """How something gives: frequency of its vibration [rad/s], damping ratio, compliance under an even sideways load."""

    frequency: float
    damping_ratio: float
    compliance: float


def in_tune(
    predictor: Predictor, hypothesis: Hypothesis, x: Array, k: int, others: Array, other: Candidate
) -> list[Array]:
    """Parameter vectors of a set at ``x`` with something else that gives in member ``k``'s place, and ``others`` of the rest.

    In the first one it vibrates at the same frequency and dies out as fast, in the second it gives as much under slow forces.
    Empty if one of the two has no stiffness to tune.
    """
    rest = hypothesis.without(k)
    aim = _give(predictor, hypothesis, x, rest)
    effect = other.effect
    first = np.array([p.start_values(other.references)[0] for p in effect.parameters])
    begun = np.concatenate([others, to_internal(other, first)])
    own = _give(predictor, rest.with_(other), begun, rest)
    if aim is None or own is None:
        return []
    stiffer = [(aim.frequency / own.frequency) ** 2]
    by_give = own.compliance / aim.compliance
    if max(by_give / stiffer[0], stiffer[0] / by_give) > SAME_START_RATIO:
        stiffer.append(by_give)
    found = []
    for times in stiffer:
        values = first.copy()
        for place, parameter in enumerate(effect.parameters):
            if parameter.name == "stiffness":
                values[place] *= times
            elif parameter.name == "frequency":
                values[place] *= np.sqrt(times)
            elif parameter.name == "damping_ratio":
                values[place] = aim.damping_ratio
            elif parameter.name == "damping":
                values[place] *= np.sqrt(times) * aim.damping_ratio / own.damping_ratio
        values = np.clip(values, effect.lower, effect.upper)
        found.append(np.concatenate([others, to_internal(other, values)]))
    return found


def _give(predictor: Predictor, hypothesis: Hypothesis, x: Array, rest: Hypothesis) -> Give | None:
    """How what a set adds to the coordinates of the rest gives, at zero position without gravity; None if it does not."""
    system = predictor.altered(hypothesis, x)
    names = system.coordinate_names
    added = np.array([name not in predictor.mechanism(rest).names for name in names])
    model = Denoc(replace(system, attachments=(), gravity=constant(sideways(predictor.system))))
    rest_position = np.zeros(model.n)
    mass, load = model.mass_matrix(rest_position), model.gravity(rest_position)
    stiffness, damping = model.linear_passive()
    own = np.ix_(added, added)
    if not added.any() or np.linalg.eigvalsh(stiffness[own])[0] <= 0.0:
        return None
    values, modes = scipy.linalg.eigh(stiffness, mass)
    elastic = np.einsum("ak,ab,bk->k", modes[added], stiffness[own], modes[added])
    ringing = np.flatnonzero((values > EIGENVALUE_ROUNDING * values[-1]) & (elastic > OWN_MODE_SHARE * values))
    compliance = float(load[added] @ np.linalg.solve(stiffness[own], load[added]))
    if not len(ringing) or not compliance > 0.0:
        return None
    mode = modes[added, ringing[0]]
    frequency = float(np.sqrt(values[ringing[0]]))
    return Give(frequency, max(float(mode @ damping[own] @ mode) / (2.0 * frequency), LEAST_DAMPING_RATIO), compliance)
