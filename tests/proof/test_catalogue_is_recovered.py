"""Every effect of the catalogue, concealed by engines that are not ours at fifty standard deviations, is named or in a class.

Rigs, noise, rates and sizes are drawn as in a proof, from a seed of this file's own. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.proof.concealments import CONCEALMENTS
from harness.proof.draw import draw_case
from harness.proof.run import diagnose_folder
from harness.proof.score import score_case
from harness.proof.seal import answer
from harness.proof.write import write_case

SEED = 8101
VISIBILITY = 50.0


@pytest.mark.parametrize("index", range(len(CONCEALMENTS)), ids=list(CONCEALMENTS))
def test_concealed_effect_is_named(index: int, tmp_path: Path) -> None:
    effect = list(CONCEALMENTS)[index]
    case = draw_case("single", SEED, index, effects=(effect,), target=VISIBILITY)
    write_case(case, tmp_path / "case", np.random.default_rng([SEED, index]))
    found = diagnose_folder(tmp_path / "case")
    scored = score_case(case.name, answer(case), found)
    assert "error" not in found
    assert scored.in_class, (case.planted, scored.found, found["verdict"])
