"""Pairs and a triple of effects, concealed by engines that are not ours, that a search once missed for another set.

Rigs, noise, rates and sizes are drawn as in a proof. The truth is what was concealed. What was told instead, one by one: a wave
over the angle and a shifted centre of mass; a shift, drag and damping; a bent model; nothing; an encoder's error.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.proof.run import Task, conceal, diagnose_folder
from harness.proof.score import score_case
from harness.proof.seal import unseal

SEED = 1813693910


@pytest.mark.parametrize(("kind", "index"), [("pair", 2), ("pair", 15), ("pair", 30), ("pair", 33), ("triple", 6)])
def test_concealed_set_is_named(kind: str, index: int, tmp_path: Path) -> None:
    name, digest = conceal(Task(kind, index), SEED, tmp_path)
    found = diagnose_folder(tmp_path / "cases" / name)
    scored = score_case(name, unseal(name, tmp_path / "sealed", digest), found)
    assert "error" not in found
    assert scored.in_class, (scored.planted, scored.found, found["verdict"])
