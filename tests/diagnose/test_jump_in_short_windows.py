"""Windows of a few samples, as of a slow camera, have no room for a jump that is no single reading: none is looked for there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnose.criticism.checks.reading_jump import CHECK
from harness.diagnose.criticism.gains import jointly
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.score_tests import Nuisance

NOISE, JUMP, WHEN = 1e-3, 4.0, 30  # rad, noise standard deviations, sample


def _left(sizes: list[int]) -> Any:
    """What windows of white noise leave, one a run, of which long ones jump once; nothing may be adjusted."""
    rng = np.random.default_rng(5)
    residuals = [rng.standard_normal(size) + JUMP * (np.arange(size) >= WHEN) for size in sizes]
    space = Nuisance(
        states=tuple(np.zeros((size, 0)) for size in sizes),
        shared=np.zeros((sum(sizes), 0)),
        residual=np.concatenate(residuals),
        prior=np.zeros(0),
    )
    likelihood = SimpleNamespace(
        colours=[Colour(NOISE)],
        weights=lambda window: np.ones((1, window.size)),
        whiten_signal=lambda window, signal: (signal / NOISE).reshape(len(signal), -1),
    )
    runs = [SimpleNamespace(name=f"run{k}", time=np.arange(size) / 6.0) for k, size in enumerate(sizes)]
    problem = SimpleNamespace(channels=[SimpleNamespace(name="pivot.position")])
    fitted = SimpleNamespace(
        windows=[Window(k, 0, size) for k, size in enumerate(sizes)], linear=SimpleNamespace(residuals=residuals)
    )
    predictor = SimpleNamespace(runs=runs, problem=problem)
    return SimpleNamespace(fitted=fitted, predictor=predictor, likelihood=likelihood, space=space, noise=1.0)


@pytest.mark.parametrize("sizes", [[7], [9, 10, 3]])
def test_no_jump_is_looked_for_where_none_could_be_told(sizes: list[int]) -> None:
    assert list(CHECK.ask(_left(sizes))) == []


def test_short_windows_hide_no_jump_in_long_ones() -> None:
    left = _left([9, 60, 7])
    (test,) = CHECK.ask(left)
    assert test.chance < 1e-5
    assert test.where == ("pivot.position", f"run1 at {WHEN / 6.0:.2f} s")
    # By least squares: of a step among noise that nothing else explains.
    step = (np.arange(60) >= WHEN).astype(float)
    gain = float((step @ left.fitted.linear.residuals[1]) ** 2 / (step @ step))
    assert test.gain == pytest.approx(gain)
    # Of windows that have room for one alone.
    assert jointly(left.space, [np.zeros((0, 9)), step[None], np.zeros((0, 7))]) == pytest.approx(gain)
