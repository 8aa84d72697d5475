"""What a search ended with, and how well its sets predict what they were not fitted to."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from harness.diagnose.estimation.discrepancy import Discrepancy
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.misfit import Misfit
from harness.diagnose.estimation.objective import States
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.constants.search import RETAINED_SETS
from harness.diagnose.selection.model_error import reweighed
from harness.diagnose.selection.state_evidence import Evidence
from harness.diagnose.selection.study import Study


@dataclass(eq=False)
class Outcome:
    """What the search ended with, for judging and telling.

    study: fits on all recordings, by which sets of effects are weighed. training: fits on the training recordings alone, whose
    parameters are those that are told and judged on the data held out. judged, alone: fits on the data held out, of nothing but
    initial states, and of everything. straight: training fits with the nominal quantities as stated. nominal: as stated, initial
    states fitted (training).
    """

    problem: Problem
    predictor: Predictor
    study: Study
    training: Study
    nominal: Fit
    empty: Fit
    best: Fit
    ordered: list[Fit]
    held_windows: tuple[Window, ...]
    motion_hz: float
    period: float
    judged: dict[int, tuple[Fit, Fit]] = field(default_factory=dict)
    alone: dict[frozenset[str], Fit] = field(default_factory=dict)
    straight: dict[frozenset[str], Fit] = field(default_factory=dict)
    read: dict[int, tuple[Fit, Fit]] = field(default_factory=dict)

    @property
    def evidence(self) -> Evidence | None:
        """The measure of sets beside a force over the state; None where there is none, or channels do not answer to forces."""
        left = self.study.likelihood.discrepancy
        if not isinstance(left, Misfit) or left.state is None:
            return None
        return Evidence(left.state, left.sensors)

    @property
    def noise(self) -> tuple[float, ...]:
        """Standard deviations of the channels' sensors [channel unit]: as estimated, or as readings scatter beside a force.

        What a likelihood needs beside such a force is not the sensor's alone.
        """
        likelihood = self.study.likelihood
        return tuple(c.std for c in (likelihood.colours if self.force is None else crude_colours(self.problem)))

    @property
    def force(self) -> Discrepancy | None:
        """The force that every hypothesis leaves out, None where noise is all there is."""
        found = self.study.likelihood.discrepancy
        return found.force if isinstance(found, Misfit) else None

    def reweigh(self, best: Fit) -> Fit:
        """Weigh all by what this set leaves, where the set that was best till now leaves another size; the same set, fitted so."""
        after = reweighed(self.study, best)
        if after is None:
            return best
        before, training = self.study, self.training
        for found in (self.judged, self.alone, self.straight, self.read):
            found.clear()
        self.study = after
        self.training = after.unfitted(after.likelihood, training.windows, training)
        kept = sorted(before.fits.values(), key=before.criterion)[:RETAINED_SETS]
        self.ordered = sorted((after.fit(f.hypothesis, [f.x], f) for f in kept), key=after.criterion)
        self.empty = after.known(Hypothesis()) or after.empty()
        self.best = after.fit(best.hypothesis, [best.x], best)
        self.nominal = as_stated(self.training, self.nominal.states)
        return self.best


def as_stated(training: Study, states: States) -> Fit:
    """The nominal model as it is stated, in the windows of a study: no more than initial states fitted, from these or as read."""
    x, nothing = np.zeros(len(training.predictor.nominal)), Hypothesis()
    every = np.ones(len(x), dtype=bool)
    return fit(training.objective(nothing), x, states, fixed=every, others=training.others(nothing))


def trained(outcome: Outcome, fitted: Fit) -> Fit:
    """The same hypothesis fitted to the training recordings alone, from where it stands."""
    if fitted.windows == outcome.training.windows:
        return fitted
    known = outcome.training.fits.get(fitted.hypothesis.identity)
    return known or outcome.training.fit(fitted.hypothesis, [fitted.x], fitted)


def judge(outcome: Outcome, fitted: Fit) -> Fit:
    """The free run over the held-out windows of what was fitted to the training: nothing but the initial states is fitted."""
    return judged(outcome, fitted, trained(outcome, fitted))


def judge_straight(outcome: Outcome, fitted: Fit) -> Fit:
    """The same for a hypothesis whose nominal quantities are held to what is stated: what it predicts without bending the model."""
    key = fitted.hypothesis.identity
    if key not in outcome.straight:
        training, k = outcome.training, len(outcome.predictor.nominal)
        x = trained(outcome, fitted).x.copy()
        x[:k] = 0.0
        held = np.arange(len(x)) < k
        outcome.straight[key] = fit(
            training.objective(fitted.hypothesis), x,
            training.states_for(fitted.hypothesis, fitted), fixed=held, others=training.others(fitted.hypothesis),
        )  # fmt: skip
    return judged(outcome, fitted, outcome.straight[key])


def judged(outcome: Outcome, fitted: Fit, own: Fit) -> Fit:
    """What ``own``, fitted to the training alone, predicts of the data held out. fitted: on all recordings, for its states."""
    known = outcome.judged.get(id(own))
    if known is not None:
        return known[1]
    states = {}
    for window in outcome.held_windows:
        state = fitted.states.get(window)
        if state is None:
            state = outcome.study.read_off(fitted.hypothesis, window)
        states[window] = state
    frozen = np.ones(len(own.x), dtype=bool)
    held = fit(
        outcome.study.objective(own.hypothesis).on(outcome.held_windows), own.x, states, fixed=frozen,
        others=outcome.study.others(own.hypothesis, outcome.held_windows),
    )  # fmt: skip
    outcome.judged[id(own)] = (own, held)
    return held


def as_read(outcome: Outcome, fitted: Fit) -> Fit:
    """The fit with initial states that bring it as near to the readings as it comes: what a free run leaves, for telling.

    Under a likelihood with a force that is left out, states are fitted to what that force does not explain.
    """
    sensors = outcome.study.likelihood.of_sensors
    if sensors is outcome.study.likelihood:
        return fitted
    known = outcome.read.get(id(fitted))
    if known is None:
        objective = outcome.study.objective_under(sensors, fitted)
        every = np.ones(len(fitted.x), dtype=bool)
        others = outcome.study.others(fitted.hypothesis, fitted.windows)
        known = outcome.read[id(fitted)] = (
            fitted,
            fit(objective, fitted.x, fitted.states, fixed=every, others=others),
        )
    return known[1]


def heldout_z(outcome: Outcome, smaller: Fit, larger: Fit) -> float:
    """How much less the data held out cost under the larger hypothesis, in standard deviations; negative if they cost more.

    The cost that they add to a fit of the training data when all is fitted again (a predictive likelihood): so what the training
    leaves uncertain is not held against either hypothesis, and what only soaks up the training's error gains nothing. Where even
    the larger leaves more than noise there, deviations are as large as what it leaves.
    """
    least = added(outcome, larger)
    gain = added(outcome, smaller) - least
    level = max(least / max(outcome.study.likelihood.samples(outcome.held_windows), 1.0), 1.0)
    return float(np.sign(gain) * np.sqrt(abs(gain) / level))


def training_gain(outcome: Outcome, smaller: Fit, larger: Fit) -> float:
    """How much better the larger hypothesis fits the training data alone."""
    return _within(outcome, smaller) - _within(outcome, larger)


def added(outcome: Outcome, fitted: Fit) -> float:
    """Cost that the data held out add.

    Either fit bounds the other: the one of all recordings costs no less on the training data than those do by themselves, and no
    more in all than the training fit carried on to the data held out. A fit that has ended in a wrong valley is so found out.
    """
    carried_on = trained(outcome, fitted).score + judge(outcome, fitted).cost
    return max(min(fitted.score, carried_on) - _within(outcome, fitted), 0.0)


def _within(outcome: Outcome, fitted: Fit) -> float:
    """Score of a hypothesis on the training data alone."""
    own = trained(outcome, fitted)
    pairs = zip(fitted.windows, fitted.linear.residuals, strict=True)
    return min(own.score, fitted.prior + sum(float(r @ r) for window, r in pairs if window in own.windows))
