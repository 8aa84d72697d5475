"""How a training recording is divided where there is only one to learn to predict from."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from harness.diagnose.answer.predictive import FEWEST_IN_PART, _folds
from harness.diagnose.problem.windows import Window


@pytest.mark.parametrize(("samples", "parts"), [(40, 1), (60, 2), (83, 3), (100, 4), (5000, 4)])
def test_a_single_stretch_is_cut_into_as_many_parts_as_it_has_samples_for(samples: int, parts: int) -> None:
    outcome: Any = SimpleNamespace(training=SimpleNamespace(windows=(Window(0, 10, 10 + samples),)))
    folds = _folds(outcome)
    assert len(folds) == parts
    (cuts,) = zip(*folds, strict=True)
    assert (cuts[0].first, cuts[-1].last) == (10, 10 + samples)
    assert all(one.last == other.first for one, other in pairwise(cuts))
    assert all(cut.size >= FEWEST_IN_PART for cut in cuts)


def test_several_recordings_are_left_out_one_by_one() -> None:
    windows = (Window(0, 0, 40), Window(1, 0, 40), Window(1, 40, 80))
    outcome: Any = SimpleNamespace(training=SimpleNamespace(windows=windows))
    assert _folds(outcome) == [windows[:1], windows[1:]]
