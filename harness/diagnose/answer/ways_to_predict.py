"""Ways to predict recordings: a set of laws fitted to some of them, alone or with the force over the state that it leaves out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.constants import LONGER_PIECES_RATIO, PIECE_SWINGS, PREDICTION_STEPS
from harness.diagnose.estimation.beside_state_force import Beside, beside
from harness.diagnose.estimation.constants import FEWEST_WINDOW_SAMPLES
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.estimation.state_force import Force, StateForce
from harness.diagnose.estimation.state_force_in_parts import in_parts
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.state_evidence import Evidence
from harness.effects.effect import Effect, SiteKind
from harness.effects.force_table import ForceTable

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Learned:
    """A fit, and the table of the force over the state that acts in it, if one does."""

    fitted: Fit
    table: ForceTable | None = None


class Way(Protocol):
    """A way to predict."""

    def learned(self, windows: Sequence[Window]) -> Learned | None:
        """As these training windows teach it; None where they teach nothing."""


@dataclass(frozen=True, eq=False)
class Alone:
    """A set by least squares of what the sensors read, from the numbers ``x`` and initial states as far as they are known."""

    outcome: Outcome
    hypothesis: Hypothesis
    x: Array
    known: Mapping[Window, Array] = field(default_factory=dict)

    def learned(self, windows: Sequence[Window]) -> Learned:
        """As whole windows teach it, begun at ``x`` and where ever longer pieces lead from there.

        Over whole windows a model that leaves something out has many valleys; over half a swing it has few, and what fits there
        lies near the valley of pieces a few times as long (Bock's multiple shooting, with fewer and fewer shots).
        """
        outcome, hypothesis, windows = self.outcome, self.hypothesis, tuple(windows)
        objective, usual = by_sensors(outcome, hypothesis), states(outcome, hypothesis, windows)
        starts = [(self.x, {w: self.known.get(w, usual[w]) for w in windows})]
        led: Fit | None = None
        for cuts in longer_and_longer(outcome, windows):
            read = {w: outcome.study.read_off(hypothesis, w) for w in cuts}
            x = self.x if led is None else led.x
            near = read if led is None else {**read, **led.beginning(cuts).states}
            led = fit(objective.on(cuts), x, near, most_steps=PREDICTION_STEPS, others=[read])
        if led is not None:
            starts.append((led.x, dict(led.beginning(windows).states)))
        whole = objective.on(windows)
        ends = [fit(whole, x, at, most_steps=2 * PREDICTION_STEPS) for x, at in starts]
        return Learned(min(ends, key=lambda f: f.score))


@dataclass(frozen=True, eq=False)
class WithForce:
    """A set with the force over the state that it leaves out as a law of its own. fitted: the set to the training windows."""

    outcome: Outcome
    evidence: Evidence
    fitted: Fit

    def learned(self, windows: Sequence[Window]) -> Learned | None:
        outcome, force, hypothesis = self.outcome, self.evidence.force, self.fitted.hypothesis
        found = self.evidence.beside(outcome.training, self.fitted)
        if tuple(windows) != self.fitted.windows:
            own = Alone(outcome, hypothesis, self.fitted.x, self.fitted.states).learned(windows).fitted
            objective = outcome.training.objective_under(self.evidence.rough, own)
            near = replace(found, states={w: found.states.get(w, own.states[w]) for w in own.windows})
            inside = in_parts(force, outcome.predictor.runs, own.windows)
            found = beside(inside, objective, own, outcome.training.whole(hypothesis), [near])
        if found.nodes is None or found.shape is None:
            return None
        table = _table(force, found, found.nodes, found.shape)
        effect = table.effect()
        members = [_at(outcome, site, effect) for site in table.joints]
        if not all(members):
            return None
        larger = Hypothesis((*hypothesis.members, *(m for m in members if m is not None)))
        x = np.concatenate([found.x, np.arange(len(members), dtype=float)])
        return Learned(free_run(outcome, larger, x, windows), table)


def longer_and_longer(outcome: Outcome, windows: Sequence[Window]) -> list[tuple[Window, ...]]:
    """Windows cut into pieces of half a swing, of a few times as much, and so on, as far as they are cut at all."""
    out: list[tuple[Window, ...]] = []
    swings = PIECE_SWINGS
    while True:
        cuts = pieces(outcome, windows, swings)
        if cuts == tuple(windows):
            return out
        out.append(cuts)
        swings *= LONGER_PIECES_RATIO


def pieces(outcome: Outcome, windows: Sequence[Window], swings: float) -> tuple[Window, ...]:
    """Windows cut into pieces of about so many swings, as far as samples allow."""
    out: list[Window] = []
    for window in windows:
        run = outcome.problem.runs[window.run]
        lasts = run.duration * window.size / len(run.time)
        count = min(round(lasts / (swings * outcome.period)), window.size // FEWEST_WINDOW_SAMPLES)
        out += equal_parts(window, max(count, 1))
    return tuple(out)


def can_have_force(outcome: Outcome, hypothesis: Hypothesis) -> bool:
    """Whether lanes have room for a force over the state beside a set: they carry one law beyond their own."""
    system = outcome.problem.system
    taken = any(m.effect.user is not None or m.effect.adds_coordinates for m in hypothesis.members)
    return not (taken or system.drives or system.attachments)


def by_sensors(outcome: Outcome, hypothesis: Hypothesis) -> Objective:
    """Least squares of what the sensors read in the training windows."""
    return replace(outcome.training.objective(hypothesis), likelihood=outcome.study.likelihood.of_sensors)


def states(outcome: Outcome, hypothesis: Hypothesis, windows: Sequence[Window]) -> dict[Window, Array]:
    """Initial states to begin at."""
    every = outcome.study.states_for(hypothesis)
    return {w: every[w] if w in every else outcome.study.read_off(hypothesis, w) for w in windows}


def free_run(outcome: Outcome, hypothesis: Hypothesis, x: Array, windows: Sequence[Window]) -> Fit:
    """Nothing but the initial states fitted."""
    objective = by_sensors(outcome, hypothesis).on(tuple(windows))
    frozen = np.ones(len(x), dtype=bool)
    return fit(objective, x, states(outcome, hypothesis, windows), fixed=frozen, most_steps=PREDICTION_STEPS)


def _table(force: StateForce, found: Beside, nodes: Array, shape: Force) -> ForceTable:
    """The force as it acts: the nodes say how much of it is too little."""
    rows = [force.table(number, -nodes, shape) for number in range(force.joints)]
    first = np.array([(p[0], v[0]) for p, v, _ in rows])
    step = np.array([(p[1] - p[0], v[1] - v[0]) for p, v, _ in rows])
    return ForceTable(tuple(force.names), first, step, np.array([acting for _, _, acting in rows]))


def _at(outcome: Outcome, site: str, effect: Effect) -> Candidate | None:
    """An effect as a member at a joint; None where nothing else could be, and natural sizes are not known."""
    for candidate in outcome.study.candidates:
        if candidate.site == site and candidate.effect.site is SiteKind.JOINT:
            return replace(candidate, effect=effect)
    return None
