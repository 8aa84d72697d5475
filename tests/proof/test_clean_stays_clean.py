"""A hundred recordings of rigs with nothing concealed, nominal data off within their tolerance: nothing is found in any.

Rigs, noise and rates are drawn as in a proof, from a seed of this file's own; another engine makes the recordings.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.proof.draw import draw_case
from harness.proof.run import diagnose_folder
from harness.proof.write import write_case

SEED, CASES = 1359012006, 100


@pytest.mark.parametrize("index", range(CASES))
def test_nothing_is_found_where_nothing_is_concealed(index: int, tmp_path: Path) -> None:
    case = draw_case("clean", SEED, index, short=True)
    write_case(case, tmp_path / "case", np.random.default_rng([SEED, index]))
    found = diagnose_folder(tmp_path / "case")
    assert (found.get("verdict"), found.get("findings")) == ("consistent", []), found.get("error", found.get("summary"))
