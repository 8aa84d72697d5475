"""A case with one effect concealed, diagnosed without the answer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from harness.proof.run import EFFECTS_BY_KIND, Task, _shuffled, conceal, diagnose_folder
from harness.proof.seal import unseal


def told_of(effect: str, kind: str, seed: int, folder: Path) -> dict[str, Any]:
    """What diagnosis says of the case of a seed that conceals the effect; its answer is seen to be that."""
    (task,) = (t for t in (Task(kind, 0, e) for e in EFFECTS_BY_KIND[kind]) if _shuffled(t, seed) == effect)
    name, digest = conceal(task, seed, folder, short=False)
    found = diagnose_folder(folder / "cases" / name)
    assert [p["effect"] for p in unseal(name, folder / "sealed", digest)["planted"]] == [effect]
    return found
