"""Friction that falls with speed, where a set has friction and less damping than the model states.

Over the speeds of a swing the two act alike, but a search that has found the one way of saying it does not come by the other: it
would have to exchange two members for one.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linear_response import motions
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible
from harness.diagnose.selection.constants.search import FALLING_FRICTION_SHAPES, NEAR_EVIDENCE, NOTICEABLE_GAIN
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]

FRICTIONS = ("coulomb_friction", "load_dependent_friction", "dahl_friction")


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits with Stribeck friction in the place of a joint's friction and of damping that takes back what the model states."""
    found = []
    for base, hypothesis, starts in _ways(study, best):
        known = study.known(hypothesis)
        # One that was begun from friction alone may have ended in a wrong valley.
        if known is None or known.score > best.score + NOTICEABLE_GAIN:
            found.append(study.fit(hypothesis, starts, base, target=best.score + NEAR_EVIDENCE))
    return found


def _ways(study: Study, best: Fit) -> Iterator[tuple[Fit, Hypothesis, list[Array]]]:
    """Sets with damping taken back and Coulomb friction, those with one law instead, and where a fit of these may begin."""
    for k, member in enumerate(best.hypothesis.members):
        site = member.site
        law, dry = (_at(study, name, site) for name in ("stribeck_friction", "coulomb_friction"))
        less = member.effect.name == "viscous_damping" and study.predictor.takes_back(best.hypothesis, k, best.x)
        if not less or law is None or dry is None:
            continue
        for friction in best.hypothesis.members:
            if friction.site != site or friction.effect.name not in FRICTIONS:
                continue
            base = study.fits.get((best.hypothesis.identity - {friction.key}) | {dry.key})
            if base is None:
                continue
            rest, others, values = base.hypothesis, base.x, {}
            for key in (member.key, dry.key):
                place = rest.keys.index(key)
                values[key] = float(study.predictor.effect_values(rest, place, others)[0])
                others = study.predictor.without(rest, place, others)
                rest = rest.without(place)
            if not compatible(rest, law):
                continue
            joint = study.predictor.mechanism(base.hypothesis).names.index(site)
            fastest = max(float(np.abs(m.qd[:, joint]).max()) for m in motions(study.predictor, base, base.windows))
            level, fall = values[dry.key], -values[member.key] * fastest
            points = [
                np.array([max(level - deep * fall, 0.0), level, wide * fastest])
                for wide, deep in FALLING_FRICTION_SHAPES
            ]
            yield base, rest.with_(law), [np.concatenate([others, to_internal(law, point)]) for point in points]


def _at(study: Study, name: str, site: str) -> Candidate | None:
    return next((c for c in study.candidates if c.effect.name == name and c.site == site), None)


REWRITE = Rewrite("friction that falls with speed for friction and less damping", _fits, (Turn.LAST,))
