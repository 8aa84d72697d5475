"""Which of several ways predicts best, by what each leaves of training stretches that it was not fitted to.

Stone, J. R. Statist. Soc. B 36 (1974) 111. A model is used from a state that is read off and from one that is known better, so a
stretch is predicted from both. Stretches differ in how far any model is off, so that what counts is by which factor one way is
better than another, stretch by stretch. The least of many such means is small by chance as well: of the ways within a standard
error of the best, the one with the fewest numbers is taken (Breiman et al., Classification and Regression Trees (1984), 3.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.constants import FEWEST_FOLD_SAMPLES, FEWEST_FOLDS, MOST_FOLDS
from harness.diagnose.answer.ways_to_predict import Way, by_sensors, free_run
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.outcome import Outcome

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Leaves:
    """Squares of what a way leaves of each group of stretches, in units of the sensors' noise: from initial states that are read
    off, and from those that fit best, (K,). samples: of each group (K,); numbers: how many the way has."""

    read: Array
    fitted: Array
    samples: Array
    numbers: int

    @property
    def error(self) -> Array:
        """Logarithm of the error of either kind together, beside noise that no way foretells, (K,)."""
        return np.asarray(0.25 * (np.log(self.read + self.samples) + np.log(self.fitted + self.samples)))

    @property
    def score(self) -> float:
        """Mean logarithm of the error."""
        return float(np.mean(self.error))


def chosen(rows: Sequence[Leaves]) -> int | None:
    """The way with the fewest numbers among those that are not parted from the best one; None where none leads anywhere."""
    usable = [k for k, row in enumerate(rows) if np.isfinite(row.score)]
    if not usable:
        return None
    best = min(usable, key=lambda k: rows[k].score)
    alike = [k for k in usable if k == best or not _parted(rows[k], rows[best])]
    return min(alike, key=lambda k: (rows[k].numbers, rows[k].score))


def _parted(way: Leaves, best: Leaves) -> bool:
    """Whether errors are larger than those of the best by more than a standard error of the difference, stretch by stretch."""
    worse = way.error - best.error
    count = len(worse)
    # The root mean square of so many samples of noise is not known more finely.
    noise = float(np.mean(0.5 / best.samples)) / count
    spread = np.sqrt(float(np.var(worse, ddof=1)) / count + noise)
    return bool(np.mean(worse) > spread)


def leaves(outcome: Outcome, way: Way, folds: Sequence[tuple[Window, ...]], numbers: int) -> Leaves:
    """What a way leaves of the training stretches when each group is predicted from the others."""
    read, fitted = np.full(len(folds), np.inf), np.full(len(folds), np.inf)
    channels = len(outcome.problem.channels)
    samples = np.array([float(channels * sum(window.size for window in fold)) for fold in folds])
    for k, fold in enumerate(folds):
        found = way.learned(tuple(w for other in (*folds[:k], *folds[k + 1 :]) for w in other))
        if found is None:
            break
        hypothesis, x = found.fitted.hypothesis, found.fitted.x
        objective = by_sensors(outcome, hypothesis).on(fold)
        ((read[k], _),) = objective.residuals([(x, {w: outcome.study.read_off(hypothesis, w) for w in fold})])
        fitted[k] = free_run(outcome, hypothesis, x, fold).cost
    return Leaves(read, fitted, samples, numbers)


def groups(windows: Sequence[Window]) -> list[tuple[Window, ...]]:
    """Training windows in groups to be left out one after the other: by recording, or by stretch where there are too few.

    A whole recording is cut, and each part predicted from where it begins.
    """
    runs = list(dict.fromkeys(w.run for w in windows))
    by_run = [[w for w in windows if w.run == run] for run in runs]
    each = -(-FEWEST_FOLDS // len(runs))
    out: list[tuple[Window, ...]] = []
    if each == 1:
        count = min(len(by_run), MOST_FOLDS)
        return [tuple(w for group in by_run[k::count] for w in group) for k in range(count)]
    for own in by_run:
        if len(own) == 1:
            parts = equal_parts(own[0], min(each, max(own[0].size // FEWEST_FOLD_SAMPLES, 1)))
            out += [(part,) for part in parts]
        else:
            pieces = np.array_split(np.arange(len(own)), min(each, len(own)))
            out += [tuple(own[k] for k in piece) for piece in pieces]
    return out
