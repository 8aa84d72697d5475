"""In which way a loop was closed where a recording begins; the truth is the state of MuJoCo that was recorded."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mechanisms_by_mujoco import CLOSED, FOUR_BAR, NOTHING, SLIDER_CRANK, closed, model_file, motion, mounted, recording

from harness.diagnose.criticism import check
from harness.diagnose.diagnose import _led
from harness.diagnose.estimation.assemblies import told
from harness.diagnose.estimation.reach import check_reach
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import cut
from harness.errors import InputError
from harness.system import load

SECONDS = 3.0


def predictor_of(
    folder: Path, text: str, seen: Sequence[str], joints: Sequence[str], q: Sequence[np.ndarray]
) -> Predictor:
    """Of recordings of some joints, with 0.5 mrad (mm) of noise, along motions (T, n)."""
    time = np.arange(len(q[0])) / 100.0
    recordings = [
        recording(f"run{k}", time, {(name, "position"): own[:, joints.index(name)] for name in seen}, 5e-4, k)
        for k, own in enumerate(q)
    ]
    system = _led(load(model_file(folder, text)), recordings)
    return Predictor(pose(system, recordings))


@pytest.mark.parametrize("start", [-0.9, -2.3, 0.07, 0.77])
def test_windows_begin_at_the_place_of_the_crank_that_the_rocker_was_moved_by(tmp_path: Path, start: float) -> None:
    # From 0.77 rad the crank goes through both dead points: what it is at the recording's beginning it is not later.
    hidden = NOTHING | {"pin": 0.01}
    _, q = motion(FOUR_BAR.format(**hidden, closing=CLOSED), closed(start), np.zeros(3), SECONDS)
    predictor = predictor_of(
        tmp_path, FOUR_BAR.format(**NOTHING, closing=CLOSED), ["rocker"], ["crank", "pin", "rocker"], [q, q]
    )
    order = [("crank", "pin", "rocker").index(name) for name in predictor.system.joint_names]
    for window in cut(predictor.runs, [0], 0.7):
        state = measured_state(predictor.problem, predictor, window)
        off = state[:3] - q[window.first, order]
        # The sensor's noise, made larger where the rocker is slow beside the crank.
        assert np.abs(np.exp(1j * off) - 1.0).max() < 0.05


def test_a_joint_that_leaves_one_way_is_closed_as_before(tmp_path: Path) -> None:
    text = FOUR_BAR.format(**NOTHING, closing=CLOSED)
    _, q = motion(text, closed(-0.9), np.zeros(3), 1.0)
    predictor = predictor_of(tmp_path, text, ["crank", "pin", "rocker"], ["crank", "pin", "rocker"], [q, q])
    measured_state(predictor.problem, predictor, cut(predictor.runs, [0], 1.0)[0])
    assert predictor.assemblies == {}
    assert told(predictor, predictor.runs) == ()


@pytest.mark.parametrize(("gravity", "apart"), [("0 0 -9.81", True), ("-9.81 0 0", False)])
def test_mirror_images_are_told_apart_by_what_pulls_them_alone(tmp_path: Path, gravity: str, apart: bool) -> None:
    # Gravity along the slide moves the slider alike with the crank above and below it: no run can say which it was.
    text = SLIDER_CRANK.format(crank=0.0, pin=0.0, slide=0.0, gravity=gravity)
    _, q = motion(text, mounted(-1.0), np.zeros(3), 1.5)
    predictor = predictor_of(tmp_path, text, ["slide"], ["crank", "pin", "slide"], [q, q])
    state = measured_state(predictor.problem, predictor, cut(predictor.runs, [0], 1.5)[0])
    begun = predictor.assemblies[0, 0]
    assert begun.ways == 2
    assert begun.alike == (1 if apart else 2)
    said = told(predictor, predictor.runs)[0]
    assert ("cannot be told apart" in said) == (not apart)
    if apart:
        assert state[predictor.system.joint_names.index("crank")] == pytest.approx(-1.0, abs=0.02)


@pytest.mark.parametrize(("shift", "reached"), [(0.0, True), (0.004, True), (0.2, False)])
def test_a_recording_that_no_assembly_takes_is_refused(tmp_path: Path, shift: float, reached: bool) -> None:
    # The slide goes from -0.4 to 0 m and no farther: at its dead point noise, and a zero that is 4 mm off, lead beyond.
    text = SLIDER_CRANK.format(crank=0.0, pin=0.0, slide=0.0, gravity="0 0 -9.81")
    time = np.arange(300) / 100.0
    q = np.array([mounted(0.9 * np.cos(4.0 * t)) for t in time]) + np.array([0.0, 0.0, shift])
    predictor = predictor_of(tmp_path, text, ["slide"], ["crank", "pin", "slide"], [q, q])
    if reached:
        check_reach(predictor)
    else:
        with pytest.raises(
            InputError,
            match=r"run0: the model's loops cannot be closed at most of its samples, .* s \(slide\.position 0\.",
        ) as raised:
            check_reach(predictor)
        assert "\n" not in str(raised.value)


def test_a_run_that_ends_where_loops_close_no_farther_is_judged_as_far_as_it_went(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    course = np.array([0.1, 0.3, 0.5, np.nan, np.nan])[:, None]
    gone = np.full((5, 1), np.nan)
    system = load(model_file(tmp_path, FOUR_BAR.format(**NOTHING, closing=CLOSED)))
    study: Any = SimpleNamespace(problem=SimpleNamespace(system=system), predictor=None, likelihood=None)
    unasked: Any = None
    left = check.Remainder(study, unasked, unasked, 1.0)

    def ranges(*courses: np.ndarray) -> check.AtJoint | None:
        motions = {k: SimpleNamespace(q=q, qd=q) for k, q in enumerate(courses)}
        monkeypatch.setattr(check, "probe", lambda *_: SimpleNamespace(names=("crank",), motions=motions))
        found = left.at_joint("crank")
        return None if found is None else found.here

    seen = ranges(course, gone)
    assert seen is not None
    assert 0.1 <= seen.low < 0.3 < seen.high <= 0.5 and np.isfinite(seen.fast)
    assert ranges(gone) is None
