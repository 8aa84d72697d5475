"""Between which frequencies a recorded effort is missed is told by as many digits as for any other channel."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from simulated_recordings import nominal

from harness.diagnose.inverse.effort_shown import mismatch
from harness.diagnose.problem.hypothesis import Hypothesis

STEP, SAMPLES, FREQUENCY = 0.01, 1141, 2.0  # s, of which frequencies are 1 / 11.41 s apart, Hz


def test_the_band_of_an_effort_has_few_digits() -> None:
    """Closed form: a sine under a Hann window has all of its power within two steps of frequency (Harris, Proc. IEEE, 1978)."""
    time = STEP * np.arange(SAMPLES)
    left = 0.1 * np.sin(2.0 * np.pi * FREQUENCY * time)[:, None]
    run = SimpleNamespace(time=time, usable=np.full(SAMPLES, True), q=left, qd=left)
    model = SimpleNamespace(runs=[run], residuals=lambda hypothesis, x: [left])
    data = SimpleNamespace(
        joints=[0], noises=[SimpleNamespace(std=1e-3)], model=model,
        plain=lambda residuals, joint: residuals[0][:, joint],
    )  # fmt: skip
    study: Any = SimpleNamespace(data=data)
    empty: Any = SimpleNamespace(hypothesis=Hypothesis(), x=np.zeros(0))
    (row,) = mismatch(nominal(), study, empty, empty)
    assert row["frequency_hz"] == [round(f, 4) for f in row["frequency_hz"]]
    assert row["frequency_hz"] == pytest.approx([FREQUENCY] * 2, abs=2.0 / (STEP * SAMPLES))
