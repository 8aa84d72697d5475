"""The tables of peers: what is said of one that takes too long, fails or was not asked; and of one that named nothing."""

import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
peers_on_rigs = pytest.importorskip("peers_on_rigs")
peers_on_rigs_table = pytest.importorskip("peers_on_rigs_table")
peers_sealed_table = pytest.importorskip("peers_sealed_table")


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


def test_a_row_on_sealed_cases_has_dashes_where_nothing_is_to_be_counted() -> None:
    said = {
        "asked": 3, "failed": 1, "named_single": [1, 2], "named_exactly": [0, 2], "listed_single": 2.0, "worth_single": 0.25,
        "false_beside_single": [0, 1], "clean_false": [0, 1], "coverage95": [0, 0], "interval_width": None,
        "heldout_over_noise": 1.0234, "seconds": 34.21,
    }  # fmt: skip
    row = peers_sealed_table.row("mujoco.sysid", said)
    assert (
        row
        == "| `mujoco.sysid` | 3, 1 without an answer | 1 of 2 | 0 | 2 | 25 % | 0 of 1 | 0 of 1 | – | – | 1.02 | 34.2 |"
    )
    assert peers_sealed_table.table({"denoc": said}).count("\n") == 2
