"""Where the search for cogging begins, from recorded efforts."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.inverse.effort_search import _wave


@pytest.mark.parametrize("phase", [-2.85, -0.4, 1.2, 3.0])
def test_a_wave_is_begun_at_its_amplitude_periods_and_phase(phase: float) -> None:
    q = np.linspace(-0.8, 0.9, 400)
    starts = [np.array([0.5, float(n), early]) for n in range(2, 13) for early in (-np.pi / 2.0, 0.0)]
    traces = np.array([a * np.sin(n * q + early) for a, n, early in starts])
    left = -1.7 * np.sin(9.0 * q + phase)  # what a model without the wave leaves
    gain, which, found = _wave(starts, traces @ left, traces @ traces.T)
    assert found == pytest.approx([1.7, 9.0, phase], rel=1e-9)
    assert starts[which][1] == 9.0
    assert gain == pytest.approx(float(left @ left))
