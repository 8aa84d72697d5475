"""What vibrates has many valleys that fit alike, and an interval holds those too.

A base that gives beside a cogging torque, concealed as in a quick proof, was once told to carry a tenth of its mass, give or take a
quarter of that. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.proof.run import QUICK, conceal, diagnose_folder, tasks
from harness.proof.seal import unseal

SEED = 604417153


def test_an_interval_holds_the_mass_of_a_base_that_gives(tmp_path: Path) -> None:
    (task,) = (t for t in tasks(QUICK) if t.name == "pair-0")
    name, digest = conceal(task, SEED, tmp_path, short=True)
    found = diagnose_folder(tmp_path / "cases" / name)
    (true,) = (p for p in unseal(name, tmp_path / "sealed", digest)["planted"] if p["effect"] == "base_compliance")
    (told,) = (f for f in found["findings"] if f["effect"] == "base_compliance")
    for parameter in ("stiffness", "mass"):
        low, high = np.log(told["parameters"][parameter]["ci95"])
        # One interval in twenty may miss, narrowly. Half as wide again, one in three hundred may.
        beside = abs(np.log(true["parameters"][parameter]) - (low + high) / 2.0)
        assert beside <= 1.5 * (high - low) / 2.0, parameter
