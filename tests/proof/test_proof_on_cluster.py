"""The proof on a cluster says what it says here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from harness.proof.run import prove

SEED, COUNTS = 23, {"single": 1, "clean": 1}


def answers(folder: Path) -> dict[str, Any]:
    found = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (folder / "found").glob("*.json")}
    # Where and how fast it ran is no part of the answer.
    return {
        name: {key: f[key] for key in ("verdict", "findings", "fit", "ranking", "unexplained") if key in f}
        for name, f in found.items()
    }


def test_a_cluster_finds_the_same(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    here = prove(tmp_path / "here", seed=SEED, counts=COUNTS, workers=1, peers=False)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, protocol="tcp"
    ) as cluster:
        there = prove(tmp_path / "there", seed=SEED, counts=COUNTS, dask=cluster.scheduler_address, peers=False)
    assert answers(tmp_path / "there") == answers(tmp_path / "here")
    assert [(s.name, s.exact, s.verdict) for s in there.scores] == [(s.name, s.exact, s.verdict) for s in here.scores]
