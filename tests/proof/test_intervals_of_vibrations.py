"""What vibrates has many valleys that fit alike, and an interval holds those too.

A base that gives beside a cogging torque, concealed as in a quick proof, was once told to carry a tenth of its mass, give or take a
quarter of that. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.proof.draw import draw_case
from harness.proof.run import diagnose_folder
from harness.proof.write import write_case

SEED = 604417153


@pytest.mark.parametrize("index", [0, 1])
def test_an_interval_holds_the_mass_of_a_base_that_gives(index: int, tmp_path: Path) -> None:
    case = draw_case("pair", SEED, index, effects=("base_compliance", "cogging_torque"), short=True)
    write_case(case, tmp_path / "case", np.random.default_rng([SEED, index]))
    found = diagnose_folder(tmp_path / "case")
    # A friction of a few millionths was once told besides: without it a fit of the true pair had ended in another valley.
    assert {f["effect"] for f in found["findings"]} == {"base_compliance", "cogging_torque"}
    (true,) = (p for p in case.planted if p.effect == "base_compliance")
    (told,) = (f for f in found["findings"] if f["effect"] == "base_compliance")
    for parameter in ("stiffness", "mass"):
        low, high = np.log(told["parameters"][parameter]["ci95"])
        # One interval in twenty may miss, narrowly. Half as wide again, one in three hundred may.
        beside = abs(np.log(true.parameters[parameter]) - (low + high) / 2.0)
        assert beside <= 1.5 * (high - low) / 2.0, parameter
