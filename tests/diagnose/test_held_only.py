"""What only the recording held out shows is told if its stretches predict one another, and not if it happened once.

Recordings by SciPy. Small swings do not reach a stop that the large one held out runs into many times: it was fitted there, so
that nothing confirmed it, and all was unexplained.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording, releases, swing

from harness import diagnose
from harness.diagnose.claims.held_out_only import _pieces
from harness.diagnose.problem.windows import Window, contains
from harness.report.diagnosis.page import diagnosis_html

NOISE = 1e-3
ANGLE, STIFFNESS, DAMPING = 0.9, 4.0, 0.02


def stop(t: float, q: float, v: float) -> float:
    """Of a stop that only pushes back [N·m]."""
    return -max(STIFFNESS * (q - ANGLE) + DAMPING * v, 0.0) if q > ANGLE else 0.0


@pytest.fixture(scope="module")
def found():
    return diagnose(releases(Rig(torque=stop), (0.5, 0.7, -1.5), NOISE, seed=3), model=nominal())


def test_a_stop_that_only_they_reach_is_told(found):
    assert found.verdict == "explained"
    (told,) = found.findings
    assert (told["effect"], told["shows_only_in"]) == ("end_stop", ["run2"])
    for name, true in {"angle": ANGLE, "stiffness": STIFFNESS}.items():
        low, high = told["parameters"][name]["ci95"]
        # An interval of 95 % is four standard deviations wide; within three of them the truth is but once in four hundred not.
        margin = 0.25 * (high - low)
        assert low - margin < true < high + margin
    assert "every second stretch" in found.summary
    # Nothing may pass for a prediction that is a fit.
    assert "also on data held out" not in found.summary
    assert "a fit to all recordings" in diagnosis_html(found.to_json())


def test_its_model_reproduces_them(found):
    (row,) = found.fit
    assert row["augmented"]["heldout_rmse"] == pytest.approx(NOISE, rel=0.05)
    assert row["refitted"]["heldout_rmse"] > 10.0 * NOISE


def test_a_single_stretch_confirms_nothing():
    # So short that it is one stretch: the stop is met once.
    *runs, held = releases(Rig(torque=stop), (0.5, 0.7, -1.5), NOISE, seed=3)
    time = held.time[:150]
    short = recording("short", time, {"pivot.position": held.channels[0].values[:150]})
    found = diagnose([*runs, short], model=nominal())
    assert found.verdict == "unexplained"
    assert not found.findings
    assert "No data that it was not fitted to bear out end_stop" in found.summary


def test_a_blow_that_only_they_had_is_no_finding():
    rig = Rig()
    runs = releases(rig, (0.5, 0.7), NOISE, seed=4)
    time = np.arange(0.0, 12.0, 0.01)
    bumped = Rig(torque=lambda t, q, v: 0.15 * np.exp(-(((t - 5.0) / 0.05) ** 2)))
    held = swing(bumped, -1.2, time) + NOISE * np.random.default_rng(5).standard_normal(len(time))
    found = diagnose([*runs, recording("bumped", time, {"pivot.position": held})], model=nominal())
    assert found.verdict == "unexplained"
    assert not found.findings


def test_pieces_lie_within_windows_that_are_short_themselves():
    # A motion so wild that its windows are short, and of another length than the pieces: none may lie across two of them.
    runs = [SimpleNamespace(interval=0.01)]
    windows = (Window(0, 0, 700), Window(0, 700, 1100), Window(0, 1100, 1150))
    outcome = SimpleNamespace(problem=SimpleNamespace(runs=runs), period=1.0)
    pieces = [piece for window in windows for piece in _pieces(outcome, window)]
    assert all(any(contains(window, piece) for window in windows) for piece in pieces)
    assert sum(piece.size for piece in pieces) == 1150
    # A swing and a half each, or all there is.
    assert [piece.size for piece in pieces] == [140] * 5 + [133, 133, 134] + [50]
