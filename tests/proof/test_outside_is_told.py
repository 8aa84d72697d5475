"""A force outside the catalogue that several of its effects piece together is told as unexplained.

Air that feeds small swings and brakes large ones (van der Pol), concealed as in a quick proof, was once told as a shaken base and a
high-pass, down to the noise. The truth is what was concealed.
"""

from __future__ import annotations

from pathlib import Path

from harness.proof.run import QUICK, conceal, diagnose_folder, tasks
from harness.proof.seal import unseal

SEED = 604417153


def test_a_limit_cycle_is_no_shaken_base(tmp_path: Path) -> None:
    (task,) = (t for t in tasks(QUICK) if t.name == "outside-0")
    name, digest = conceal(task, SEED, tmp_path, short=True)
    found = diagnose_folder(tmp_path / "cases" / name)
    concealed = [planted["effect"] for planted in unseal(name, tmp_path / "sealed", digest)["planted"]]
    assert concealed == ["self_excitation"]
    assert found["verdict"] in ("unexplained", "partly_explained"), found["findings"]
    assert found["findings"] == []
