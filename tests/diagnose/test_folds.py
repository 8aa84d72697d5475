"""How a training recording is divided where there is only one to learn to predict from."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from harness.diagnose.answer.constants import FEWEST_FOLD_SAMPLES
from harness.diagnose.answer.cross_validation import Leaves, chosen, groups
from harness.diagnose.problem.windows import Window


@pytest.mark.parametrize(("samples", "parts"), [(40, 1), (60, 2), (83, 3), (100, 4), (5000, 4)])
def test_a_single_stretch_is_cut_into_as_many_parts_as_it_has_samples_for(samples: int, parts: int) -> None:
    folds = groups((Window(0, 10, 10 + samples),))
    assert len(folds) == parts
    (cuts,) = zip(*folds, strict=True)
    assert (cuts[0].first, cuts[-1].last) == (10, 10 + samples)
    assert all(one.last == other.first for one, other in pairwise(cuts))
    assert all(cut.size >= FEWEST_FOLD_SAMPLES for cut in cuts)


def test_two_recordings_are_left_out_by_halves() -> None:
    assert groups((Window(0, 0, 100), Window(1, 0, 60), Window(1, 60, 120))) == [
        (Window(0, 0, 50),), (Window(0, 50, 100),), (Window(1, 0, 60),), (Window(1, 60, 120),),
    ]  # fmt: skip


def test_four_recordings_are_left_out_one_by_one() -> None:
    windows = tuple(Window(run, first, first + 40) for run in range(4) for first in (0, 40))
    assert groups(windows) == [windows[2 * k : 2 * k + 2] for k in range(4)]


def test_more_recordings_than_groups_are_left_out_together() -> None:
    folds = groups([Window(run, 0, 40) for run in range(20)])
    assert [len(fold) for fold in folds] == [4, 4, 3, 3, 3, 3]
    assert {w.run for fold in folds for w in fold} == set(range(20))


def _leaves(groups_of: list[float], numbers: int) -> Leaves:
    squares = 1e6 * np.array(groups_of)
    return Leaves(squares, squares, np.full(len(squares), 500.0), numbers)


def test_fewer_numbers_stand_where_stretches_disagree() -> None:
    # Logarithms of ½, 2, 2 and ½: their mean is nothing, that of the first three half a standard error.
    assert chosen([_leaves([0.9, 2.0, 2.0, 0.5], 3), _leaves([1.0, 1.0, 1.0, 1.0], 9)]) == 0


def test_more_numbers_are_worth_it_where_every_group_says_so() -> None:
    assert chosen([_leaves([2.0, 1.9, 2.1, 2.0], 3), _leaves([1.0, 1.0, 1.0, 1.0], 9)]) == 1


def test_a_group_that_every_model_is_far_off_in_does_not_outvote_the_others() -> None:
    assert chosen([_leaves([100.0, 2.0, 2.0, 2.0], 9), _leaves([120.0, 1.0, 1.0, 1.0], 3)]) == 1


def test_what_is_better_by_less_than_the_noise_is_not_better() -> None:
    still = Leaves(np.zeros(4), np.zeros(4), np.full(4, 500.0), 9)
    moving = Leaves(np.full(4, 1e-9), np.full(4, 1e-9), np.full(4, 500.0), 3)
    assert chosen([still, moving]) == 1


def test_what_leads_nowhere_is_not_chosen() -> None:
    nothing = [np.inf] * 4
    assert chosen([_leaves(nothing, 0), _leaves([1.0] * 4, 5)]) == 1
    assert chosen([_leaves(nothing, 0)]) is None
