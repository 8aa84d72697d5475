"""A joint law of its own is compiled when a run first asks for it, and the catalogue's is kept on disk."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.denoc.lanes.model import LaneModel
from harness.system.random_systems import random_chain

_LAW = """
from harness.denoc.joint_laws.address import compiled_law, teeth
print(compiled_law(teeth).cache_hits, compiled_law(lambda q, qd, t, p: -p[0] * q).cache_hits)
"""


def test_a_law_is_compiled_when_it_is_first_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr("harness.denoc.lanes.model.compiled_law", lambda law: asked.append(law))
    assert LaneModel(random_chain(2, 1)).user == 0
    model = LaneModel(random_chain(2, 1), law=max)
    assert not asked
    with pytest.raises(AttributeError):
        _ = model.user
    assert asked == [max]


def test_the_law_of_teeth_comes_from_disk_the_second_time(tmp_path: Path) -> None:
    said = []
    for _ in range(2):
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        done = subprocess.run(
            [sys.executable, "-c", _LAW], env=environment, capture_output=True, text=True, timeout=120, check=True
        )
        said.append(done.stdout.split())
    assert said == [["0", "0"], ["1", "0"]]
