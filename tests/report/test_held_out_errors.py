"""Which channel an error on the data held out is of, where there are several."""

from __future__ import annotations

import pytest
from rich.console import Console

from harness.report.diagnosis.held_out_errors import channels_of, headings, held_out
from harness.report.diagnosis.terminal import print_diagnosis

TWO = {
    "effects": ["coulomb_friction@elbow"], "bic": -12.0, "heldout_rmse": 0.00123, "lost": "",
    "heldout": {"shoulder.position": 0.00123, "elbow.position": 0.0456},
}  # fmt: skip
NOT_WORKED_OUT = {"effects": [], "bic": 30.0, "heldout_rmse": None, "heldout": {}, "lost": ""}


def test_every_channel_has_its_own_column() -> None:
    channels = channels_of([NOT_WORKED_OUT, TWO])
    assert channels == ["shoulder.position", "elbow.position"]
    assert held_out(TWO, channels) == [0.00123, 0.0456]
    assert held_out(NOT_WORKED_OUT, channels) == [None, None]
    assert headings(channels, "held out") == ["held out, shoulder.position", "held out, elbow.position"]


@pytest.mark.parametrize("row", [{"heldout_rmse": 0.5}, {"heldout_rmse": 0.5, "heldout": {"pivot.position": 0.5}}])
def test_a_single_channel_needs_no_name(row: dict[str, object]) -> None:
    channels = channels_of([row])
    assert (held_out(row, channels), headings(channels, "held out")) == ([0.5], ["held out"])


def test_the_terminal_says_of_which_channel(capsys: pytest.CaptureFixture[str]) -> None:
    document = {
        "verdict": "unexplained", "summary": "", "findings": [], "fit": [], "ranking": [TWO, NOT_WORKED_OUT],
        "next_experiment": {"what": ""},
    }  # fmt: skip
    print_diagnosis(document, Console(width=160))
    shown = capsys.readouterr().out
    assert "held out, shoulder.position" in shown and "held out, elbow.position" in shown
    (line,) = (text for text in shown.splitlines() if text.startswith("coulomb_friction@elbow"))
    assert line.split()[1:] == ["0", "0.00123", "0.0456"]
