"""Whether data held out are noise about what the training recordings foretell, their uncertainty included.

A free run of the likeliest numbers alone asks too much of few recordings: where these leave a direction of the numbers open, it
parts from data held out by many times the noise although the model is right. What is to be expected of a right one is the posterior
predictive distribution (Gelman, Meng and Stern, Statistica Sinica 6 (1996) 733): readings scatter about the motions of all numbers
that the training recordings leave likely. Their χ² is the least, over the numbers, of what is left of the data held out and of what
the training recordings lose; that least is the fit of all recordings, so that it is what they add to the cost of the training's.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.constants import TEST_CHANCE
from harness.diagnose.criticism.remainder import above_floor
from harness.diagnose.criticism.residual_correlation import by_channel, follows_itself
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome, added, judge


def level(outcome: Outcome, held: Fit) -> float:
    """What is left of the data held out, over the noise [1]."""
    return _over_noise(outcome, held.cost)


def parts(outcome: Outcome, held: Fit) -> bool:
    """Whether a free run parts from data held out by more than noise.

    Noise there may be louder than elsewhere; it is a misfit if its samples follow one another.
    """
    return _misfit(outcome, held.cost, held)


def foretold(outcome: Outcome, fitted: Fit) -> bool:
    """Whether what a set, fitted to the training recordings, leaves of the data held out may be noise; fitted: to all of them."""
    return not parts(outcome, judge(outcome, fitted)) or not _misfit(outcome, added(outcome, fitted), fitted)


def _misfit(outcome: Outcome, squares: float, seen: Fit) -> bool:
    loud = above_floor(_over_noise(outcome, squares), outcome.study.likelihood)
    return loud and follows_itself(by_channel(seen, outcome.held_windows)) < TEST_CHANCE


def _over_noise(outcome: Outcome, squares: float) -> float:
    return float(np.sqrt(squares / max(outcome.study.likelihood.samples(outcome.held_windows), 1.0)))
