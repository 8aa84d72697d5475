"""What waves of their own in every window gain together: by dense least squares, and never more than there is."""

import numpy as np
import pytest

from harness.diagnose.criticism.gains import jointly, window_by_window
from harness.diagnose.selection.score_tests import Nuisance

SIZES = (40, 30, 50)


def orthonormal(random, rows, columns):
    return np.linalg.qr(random.normal(size=(rows, columns)))[0]


@pytest.mark.parametrize("columns", [1, 2])
def test_it_is_that_of_least_squares_beside_what_is_adjustable(columns):
    """Each window has an initial state of its own, and all share parameters."""
    random = np.random.default_rng(3)
    states = tuple(orthonormal(random, size, 2) for size in SIZES)
    every = np.zeros((sum(SIZES), 6))
    edges = np.cumsum([0, *SIZES])
    for k, own in enumerate(states):
        every[edges[k] : edges[k + 1], 2 * k : 2 * k + 2] = own
    shared = random.normal(size=(sum(SIZES), 3))
    shared = np.linalg.qr(shared - every @ (every.T @ shared))[0]
    adjustable = np.hstack([every, shared])
    residual = random.normal(size=sum(SIZES))
    residual -= adjustable @ (adjustable.T @ residual)
    waves = [random.normal(size=(columns, size)) for size in SIZES]
    space = Nuisance(states, shared, residual, np.zeros(0))

    dense = np.zeros((sum(SIZES), columns * len(SIZES)))
    for k, own in enumerate(waves):
        dense[edges[k] : edges[k + 1], columns * k : columns * (k + 1)] = own.T
    left = np.linalg.lstsq(np.hstack([adjustable, dense]), residual, rcond=None)[1]
    exact = float(residual @ residual - left[0])
    assert jointly(space, waves if columns > 1 else [w[0] for w in waves]) == pytest.approx(exact, rel=1e-9)


def test_the_sum_of_windows_by_themselves_would_be_more_than_there_is():
    """Two windows and a parameter that both share: what is left in one of them the other leaves too."""
    # In each window one reading; the parameter moves both alike, so the residual is (1, −1)/√2, and either window takes all of it.
    shared = np.full((2, 1), np.sqrt(0.5))
    residual = np.array([1.0, -1.0]) * np.sqrt(0.5)
    space = Nuisance((np.zeros((1, 0)),) * 2, shared, residual, np.zeros(0))
    one, other = (space.measure([np.ones((1, 1))], only=k).gains()[0] for k in (0, 1))
    assert one + other == pytest.approx(2.0)
    assert jointly(space, [np.ones(1), np.ones(1)]) == pytest.approx(1.0)


@pytest.mark.parametrize(("windows", "columns"), [(3, 4), (65, 12)])
def test_however_many_windows_there_are(windows, columns):
    """A wheel with one pulse a turn is looked at in 65 windows of a few turns each: 780 columns of their own."""
    random = np.random.default_rng(4)
    size = 30
    states = tuple(orthonormal(random, size, 2) for _ in range(windows))
    shared = random.normal(size=(windows * size, 3))
    rows = [slice(k * size, (k + 1) * size) for k in range(windows)]
    for own, at in zip(states, rows, strict=True):
        shared[at] -= own @ (own.T @ shared[at])
    shared = np.linalg.qr(shared)[0]
    waves = [random.normal(size=(columns, size)) for _ in range(windows)]
    amplitudes = [random.normal(size=columns) for _ in range(windows)]
    residual = -np.concatenate([a @ own for a, own in zip(amplitudes, waves, strict=True)])
    for own, at in zip(states, rows, strict=True):
        residual[at] -= own @ (own.T @ residual[at])
    residual -= shared @ (shared.T @ residual)
    gain, found, directions = window_by_window(Nuisance(states, shared, residual, np.zeros(0)), waves)
    # All that is left was made of these columns, so that with them nothing is.
    assert gain == pytest.approx(float(residual @ residual), rel=1e-9)
    assert directions == windows * columns
    assert np.concatenate(found) == pytest.approx(np.concatenate(amplitudes), rel=1e-6, abs=1e-8)
