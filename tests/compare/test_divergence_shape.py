"""Shapes in which two motions part, on motions that part by construction."""

from __future__ import annotations

import numpy as np
import pytest

from harness.compare.divergence_shape import by_steps, shape_of

TIME = np.linspace(0.0, 10.0, 501)
SWING = np.sin(3.0 * TIME)


@pytest.mark.parametrize(
    ("other", "shape"),
    [
        (SWING + 1e-3, "offset"),
        (SWING + 1e-3 * TIME, "secular"),
        (SWING + 1e-4 * TIME**2, "secular"),
        (np.sin(3.0 * (TIME + 1e-3)), "phase"),
        (np.sin(3.0003 * TIME), "phase"),
        (SWING + 1e-9 * np.exp(1.5 * TIME), "exponential"),
        (SWING, ""),
        (SWING + 1e-3 * np.random.default_rng(1).standard_normal(501), ""),
        (np.where(TIME < 9.0, SWING, np.nan), ""),
    ],
)
def test_the_shape_is_named(other, shape):
    assert shape_of(TIME, SWING, other) == shape


def test_no_verdict_below_what_the_steps_make():
    assert "it is the model" in by_steps(1e-3, {"denoc": 1e-9, "mujoco": 1e-6})
    assert "no verdict" in by_steps(2e-6, {"denoc": 1e-9, "mujoco": 1e-6})
    assert by_steps(1e-3, {}) == ""
