"""Where the search for cogging and springs begins, from recorded efforts."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.inverse.effort_search import _in_plane, _spring, _wave


@pytest.mark.parametrize("phase", [-2.85, -0.4, 1.2, 3.0])
def test_a_wave_is_begun_at_its_amplitude_periods_and_phase(phase: float) -> None:
    q = np.linspace(-0.8, 0.9, 400)
    starts = [np.array([0.5, float(n), early]) for n in range(2, 13) for early in (-np.pi / 2.0, 0.0)]
    traces = np.array([a * np.sin(n * q + early) for a, n, early in starts])
    left = -1.7 * np.sin(9.0 * q + phase)  # what a model without the wave leaves
    gain, which, found = _in_plane(starts, traces @ left, traces @ traces.T, _wave)
    assert found == pytest.approx([1.7, 9.0, phase], rel=1e-9)
    assert starts[which][1] == 9.0
    assert gain == pytest.approx(float(left @ left))


@pytest.mark.parametrize("rest", [-0.6, 0.1, 2.4])
def test_a_spring_is_begun_at_its_stiffness_and_rest(rest: float) -> None:
    q = np.linspace(-0.8, 0.9, 400)
    starts = [np.array([0.5, -1.0]), np.array([0.5, 1.0])]
    traces = np.array([-k * (q - slack) for k, slack in starts])
    left = 6.0 * (q - rest)
    gain, _, found = _in_plane(starts, traces @ left, traces @ traces.T, _spring)
    assert found == pytest.approx([6.0, rest], rel=1e-9)
    assert gain == pytest.approx(float(left @ left))


def test_a_spring_that_pushes_is_none() -> None:
    q = np.linspace(-0.8, 0.9, 400)
    starts = [np.array([0.5, -1.0]), np.array([0.5, 1.0])]
    traces = np.array([-k * (q - slack) for k, slack in starts])
    left = -6.0 * (q - 0.2)
    assert _in_plane(starts, traces @ left, traces @ traces.T, _spring)[0] == 0.0
