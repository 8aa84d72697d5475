"""What is outside the catalogue, and what several of its effects piece together, is told as unexplained.

As in quick proofs, three kinds were once told by what they are not: air that feeds small swings and brakes large ones (van der
Pol) as a shaken base and a high-pass, down to the noise; an encoder that skips as drift, a shaken base and a tilt, beside a
remainder; liquid in the bob as a cogging torque, beside a remainder. As in a full proof, a draught and a blow were told as a base
that shakes near the frequency of the swing, and nothing beside it. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.proof.run import FULL, QUICK, conceal, diagnose_folder, tasks
from harness.proof.seal import unseal

SHORT, LONG = 685775202, 27804809
CASES = [
    (604417153, "outside-0", "self_excitation"), (SHORT, "outside-2", "encoder_skip"), (SHORT, "outside-7", "sloshing_bob"),
    (LONG, "outside-19", "gust"), (LONG, "outside-23", "knock"),
]  # fmt: skip


@pytest.mark.parametrize(("seed", "case", "kind"), CASES)
def test_what_is_pieced_together_is_no_finding(seed: int, case: str, kind: str, tmp_path: Path) -> None:
    (task,) = (t for t in tasks(FULL if seed == LONG else QUICK) if t.name == case)
    name, digest = conceal(task, seed, tmp_path, short=seed != LONG)
    found = diagnose_folder(tmp_path / "cases" / name)
    concealed = [planted["effect"] for planted in unseal(name, tmp_path / "sealed", digest)["planted"]]
    assert concealed == [kind]
    assert found["verdict"] in ("unexplained", "partly_explained"), found["findings"]
    assert found["findings"] == []
