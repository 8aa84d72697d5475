"""Every effect of the catalogue, concealed by engines that are not ours, is named or in a class, at three levels of noise.

Rigs, noise, rates and sizes are drawn as in a proof, from seeds of this file's own: how far an effect stands out is the number of
standard deviations of noise by which it changes the recordings as a whole. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.proof.concealments import CONCEALMENTS
from harness.proof.draw import Case, UnseenError, draw_case
from harness.proof.run import REDRAWS, diagnose_folder
from harness.proof.score import score_case
from harness.proof.seal import answer
from harness.proof.write import write_case

LEVELS = {15.0: 1958353948, 50.0: 8101, 200.0: 332645733}


def _drawn(effect: str, index: int, visibility: float) -> Case:
    """A case on which the effect shows; another rig where it does not (a stop that no swing reaches)."""
    for attempt in range(REDRAWS):
        try:
            return draw_case(
                "single", LEVELS[visibility], index + 1000 * attempt, effects=(effect,), target=visibility, short=True
            )  # fmt: skip
        except UnseenError:
            continue
    raise AssertionError(f"{effect} shows on none of {REDRAWS} rigs")


CASES = [
    pytest.param(index, visibility, id=f"{effect}-{visibility}")
    for index, effect in enumerate(CONCEALMENTS)
    for visibility in LEVELS
]


@pytest.mark.parametrize(("index", "visibility"), CASES)
def test_concealed_effect_is_named(index: int, visibility: float, tmp_path: Path) -> None:
    effect, seed = list(CONCEALMENTS)[index], LEVELS[visibility]
    case = _drawn(effect, index, visibility)
    write_case(case, tmp_path / "case", np.random.default_rng([seed, index]))
    found = diagnose_folder(tmp_path / "case")
    scored = score_case(case.name, answer(case), found)
    assert "error" not in found
    assert scored.in_class, (case.planted, scored.found, found["verdict"])
