"""What is outside the catalogue, and what several of its effects piece together, is told as unexplained.

As in quick proofs, three kinds were once told by what they are not: air that feeds small swings and brakes large ones (van der
Pol) as a shaken base and a high-pass, down to the noise; an encoder that skips as drift, a shaken base and a tilt, beside a
remainder; liquid in the bob as a cogging torque, beside a remainder. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.proof.run import QUICK, conceal, diagnose_folder, tasks
from harness.proof.seal import unseal

CASES = [
    (604417153, "outside-0", "self_excitation"), (685775202, "outside-2", "encoder_skip"), (685775202, "outside-7", "sloshing_bob"),
]  # fmt: skip


@pytest.mark.parametrize(("seed", "case", "kind"), CASES)
def test_what_is_pieced_together_is_no_finding(seed: int, case: str, kind: str, tmp_path: Path) -> None:
    (task,) = (t for t in tasks(QUICK) if t.name == case)
    name, digest = conceal(task, seed, tmp_path, short=True)
    found = diagnose_folder(tmp_path / "cases" / name)
    concealed = [planted["effect"] for planted in unseal(name, tmp_path / "sealed", digest)["planted"]]
    assert concealed == [kind]
    assert found["verdict"] in ("unexplained", "partly_explained"), found["findings"]
    assert found["findings"] == []
