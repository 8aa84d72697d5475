"""Sets that would be better than the best one, were it not for a member that has come to nothing, without that one."""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.constants.search import MOST_EMPTIED_SETS, NOTHING_SIZE
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits of sets that would be better than the best one, were it not for a member that has come to nothing, without that one.

    What was found beside something that explained part of it by mistake may need nothing beside it.
    """
    own = study.criterion(best)
    promising: list[tuple[float, int, Fit, int]] = []
    for fitted in study.fits.values():
        for k, member in enumerate(fitted.hypothesis.members):
            without = study.criterion(fitted) - study.price(member, len(fitted.hypothesis.members) - 1)
            if without < own and _came_to_nothing(study, fitted, k):
                promising.append((without, len(promising), fitted, k))
                break
    # Beside a force that is left out sets are hardly worth more than one another, and most of them promise to win.
    return [study.reduce(fitted, k) for _, _, fitted, k in sorted(promising)[:MOST_EMPTIED_SETS]]


def _came_to_nothing(study: Study, fitted: Fit, k: int) -> bool:
    """Whether member ``k`` of a fit is absent to within a small part of its typical size."""
    member = fitted.hypothesis.members[k]
    if not member.effect.parameters:
        return False
    size = member.effect.parameters[0]
    value = study.predictor.effect_values(fitted.hypothesis, k, fitted.x)[0]
    return bool(np.isfinite(size.neutral) and abs(value - size.neutral) < NOTHING_SIZE * size.scale(member.references))


REWRITE = Rewrite("a set without what has come to nothing", _fits, (Turn.POLISHING, Turn.FEWER))
