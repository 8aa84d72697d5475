"""Spread of a fit's numbers over recordings, against the closed form for a mean of several recordings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm, t

from harness.diagnose.estimation.constants import POOLED_RECORDINGS
from harness.diagnose.estimation.dispersion import dispersion


def _fit(means: np.ndarray, samples: int) -> Any:
    """The fit of one number to recordings that are each constant: residuals x − mean, sensitivity 1, noise 1."""
    x = np.array([means.mean()])
    residuals = tuple(np.full(samples, x[0] - m) for m in means)
    rows = [np.vstack([[np.sqrt(samples)], [0.0]]) for _ in means]
    right = [np.array([np.sqrt(samples) * (x[0] - m), 0.0]) for m in means]
    linear = SimpleNamespace(residuals=residuals, matrix=np.vstack(rows), vector=np.concatenate(right))
    return SimpleNamespace(x=x, free=np.array([True]), windows=tuple(range(len(means))), linear=linear)


def test_one_number_by_recording() -> None:
    means, samples = np.array([1.0, 1.3, 0.8, 1.1]), 100
    found = dispersion(_fit(means, samples), 0, ["a", "b", "c", "d"])
    assert found is not None
    # The standard error of the mean, once by noise (1/√400) and once by the spread of recordings (s/√4).
    ratio = means.var(ddof=1) / len(means) / (1.0 / (samples * len(means)))
    student = t.ppf(0.975, POOLED_RECORDINGS + len(means) - 1) / norm.ppf(0.975)
    assert found.factors[0] == pytest.approx(np.sqrt(ratio) * student, rel=1e-12)
    for k, name in enumerate("abcd"):
        value, _ = found.without[name]
        assert value[0] == pytest.approx(np.delete(means, k).mean(), rel=1e-12)


def test_recordings_that_agree_narrow_nothing() -> None:
    found = dispersion(_fit(np.ones(4), 100), 0, ["a", "b", "c", "d"])
    assert found is not None and found.factors[0] >= 1.0


@pytest.mark.parametrize("means", [[1.0], [1.0, 2.0]])
def test_of_few_recordings_the_spread_is_unknown_and_so_is_how_much_they_differ(means: list[float]) -> None:
    found = dispersion(_fit(np.array(means), 100), 0, list(range(len(means))))
    assert found is not None and not found.without
    assert found.factors[0] == pytest.approx(t.ppf(0.975, POOLED_RECORDINGS) / norm.ppf(0.975), rel=1e-12)
