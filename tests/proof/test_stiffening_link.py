"""A link that stiffens as it turns is named where the model keeps it from doing so.

It is there or it is not. The model without it is bent to do its work, and from there its slope leads nowhere, so that it was never
found among what has sizes. The truth is Exudyn's: its cable elements always stiffen.
"""

from __future__ import annotations

from pathlib import Path

from harness.proof.run import EFFECTS_BY_KIND, Task, _shuffled, conceal, diagnose_folder
from harness.proof.seal import unseal

SEED = 70214


def test_geometric_stiffening_is_named(tmp_path: Path) -> None:
    kind, effect = "flexible single", "geometric_stiffening"
    (task,) = (t for t in (Task(kind, 0, e) for e in EFFECTS_BY_KIND[kind]) if _shuffled(t, SEED) == effect)
    name, digest = conceal(task, SEED, tmp_path, short=False)
    found = diagnose_folder(tmp_path / "cases" / name)
    assert [p["effect"] for p in unseal(name, tmp_path / "sealed", digest)["planted"]] == [effect]
    assert found["verdict"] == "explained"
    assert [(f["effect"], f["site"]) for f in found["findings"]] == [(effect, "strip")]
