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
                sum(range(100_000))
            except Exception:  # as peers do round their own steps
                continue

    monkeypatch.setitem(peers_on_rigs.PEERS, "stubborn", stubborn)
    began = time.process_time()
    told = peers_on_rigs.ask("stubborn", None, 0.2)
    assert 0.1 <= time.process_time() - began < 5.0
    assert told["ended_after_processor_s"] == 0.2
    assert peers_on_rigs_table.cell({**told, "ended_after_processor_s": 720.0}) == "ended after 720 s"
    # The limit is over with it: what comes next is not ended.
    while time.process_time() - began < 0.6:
        sum(range(100_000))


def test_each_cell_says_what_became_of_it() -> None:
    cell = peers_on_rigs_table.cell
    assert cell(None) == "not asked"
    assert cell({"error": "ValueError: no"}) == "failed"
    assert cell({"not_for_it": "one joint"}) == "–"
    assert cell({"heldout": {"first_sample": 0.1234, "state_fitted": 0.01}}) == "0.123 / 0.01"


def test_what_was_ended_is_asked_again_with_more_time_alone() -> None:
    made = peers_on_rigs.made
    assert not made(None, None)
    assert made({"heldout": {}}, None) and made({"not_for_it": "one joint"}, 60.0)
    ended = {"ended_after_processor_s": 60.0}
    assert made(ended, 60.0) and not made(ended, 90.0) and not made(ended, None)
