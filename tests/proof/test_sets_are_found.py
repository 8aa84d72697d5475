"""Pairs and a triple of effects, concealed by engines that are not ours, that a search once missed for another set.

Rigs, noise, rates and sizes are drawn as in a proof, the last three's as in a quick one. The truth is what was concealed. What was
told instead, one by one: a wave over the angle and a shifted centre of mass; a shift, drag and damping; a bent model; nothing; an
encoder's error; friction that grows with the load for one that falls with speed, which cannot be told from damping there either; a
joint that gives for a link that bends, and no word of the link; a wave of another length and a wrong scale for the wave and a
constant torque; a wrong scale for a spring, and no word of the spring.
"""

from __future__ import annotations

from pathlib import Path
from zlib import crc32

import numpy as np
import pytest

from harness.proof.draw import draw_case
from harness.proof.run import Task, conceal, diagnose_folder
from harness.proof.score import score_case
from harness.proof.seal import unseal
from harness.proof.write import write_case

FULL, LATER, QUICK, SHORT = 1813693910, 27804809, 604417153, 685775202
CASES = [
    (FULL, "pair", 2), (FULL, "pair", 15), (FULL, "pair", 30), (FULL, "pair", 33), (FULL, "triple", 6), (LATER, "pair", 16),
    (QUICK, "pair", 4), (SHORT, "pair", 0), (SHORT, "pair", 2),
]  # fmt: skip


@pytest.mark.parametrize(("seed", "kind", "index"), CASES)
def test_concealed_set_is_named(seed: int, kind: str, index: int, tmp_path: Path) -> None:
    name, digest = conceal(Task(kind, index), seed, tmp_path, short=seed not in (FULL, LATER))
    found = diagnose_folder(tmp_path / "cases" / name)
    scored = score_case(name, unseal(name, tmp_path / "sealed", digest), found)
    assert "error" not in found
    assert scored.in_class, (scored.planted, scored.found, found["verdict"])


def test_one_effect_is_named_beside_two_that_do_its_work(tmp_path: Path) -> None:
    """Stribeck friction of this swing is matched by damping and a friction that grows with the load, of one number each."""
    seed, index = 254273263, 130
    case = draw_case("single", seed, index, effects=("stribeck_friction",))
    write_case(case, tmp_path / "case", np.random.default_rng([seed, index, crc32(b"single")]))
    found = diagnose_folder(tmp_path / "case")
    assert found["findings"]
    for finding in found["findings"]:
        assert "stribeck_friction" in {finding["effect"], *finding["indistinguishable_from"]}
