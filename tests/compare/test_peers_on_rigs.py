"""The table of peers on real rigs: what is said of one that takes too long, fails or was not asked."""

import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
peers_on_rigs = pytest.importorskip("peers_on_rigs")
peers_on_rigs_table = pytest.importorskip("peers_on_rigs_table")


def test_a_peer_is_ended_though_it_catches_what_it_may(monkeypatch) -> None:
    def stubborn(case: object) -> None:
        while True:
            try:
                time.sleep(10.0)
            except Exception:  # as peers do round their own steps
                continue

    monkeypatch.setitem(peers_on_rigs.PEERS, "stubborn", stubborn)
    began = time.perf_counter()
    told = peers_on_rigs.ask("stubborn", None, 0.2)
    assert time.perf_counter() - began < 5.0
    assert told["ended_after_s"] == 0.2
    assert peers_on_rigs_table.cell({**told, "ended_after_s": 720.0}) == "ended after 720 s"
    # The limit is over with it: what comes next is not ended.
    time.sleep(0.3)


def test_each_cell_says_what_became_of_it() -> None:
    cell = peers_on_rigs_table.cell
    assert cell(None) == "not asked"
    assert cell({"error": "ValueError: no"}) == "failed"
    assert cell({"not_for_it": "one joint"}) == "–"
    assert cell({"heldout": {"first_sample": 0.1234, "state_fitted": 0.01}}) == "0.123 / 0.01"
