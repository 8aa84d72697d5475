"""One diagnosis from posed problem to selected hypothesis: noise, short windows, free runs, held-out judgement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.angle_waves import without_waves
from harness.diagnose.estimation.discrepancy import Discrepancy
from harness.diagnose.estimation.horizon import Horizon
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.misfit import Misfit
from harness.diagnose.estimation.noise_colour import Colour, estimate_colour
from harness.diagnose.estimation.scatter import crude_colours, quietest
from harness.diagnose.estimation.vibration_windows import stages
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.deadline import Deadline, TimeUp
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window, cut
from harness.diagnose.selection.beam_search import Effort, grow, polish, transfer
from harness.diagnose.selection.dissipation_starts import ordinary
from harness.diagnose.selection.effort_hold import better_the_other_way, either_way
from harness.diagnose.selection.model_error import Structure, begun_ordinary, reweighed, under_model_error
from harness.diagnose.selection.short_window_starts import (
    begun,
    far_off,
    few_suffice,
    ordinary_by_way_of_shorter,
    very_short,
)
from harness.diagnose.selection.state_evidence import Evidence
from harness.diagnose.selection.study import FAR, HOPELESS, Study

Array = NDArray[np.float64]

SWINGS = 1.5  # periods of the slowest swing in a short window
MOTION_HARMONICS = 8.0  # of the slowest swing, below which a misfit is expected to have its power
NONLINEAR = 3.0  # times the noise's cost, beyond which free runs of the nominal model say little about what is missing
RETAINED = 24  # sets that are kept when all are weighed anew
SAME_NOISE = 0.03  # relative difference of noise estimates that changes nothing


def colours_from(
    problem: Problem, likelihood: Likelihood, fitted: Fit, predictor: Predictor, motion_hz: float
) -> tuple[Colour, ...]:
    """Noise of every channel from the residuals of a fit."""
    pieces: list[list[Array]] = [[] for _ in problem.channels]
    places: list[list[Array]] = [[] for _ in problem.channels]
    for window in fitted.windows:
        run = problem.runs[window.run]
        prediction = predictor.predict(fitted.hypothesis, fitted.x[None, :], [(0, window, fitted.states[window])])[0]
        raw = prediction - run.values[:, window.first : window.last]
        for c in range(len(problem.channels)):
            good = np.isfinite(raw[c])
            if good.sum() >= 32:
                pieces[c].append(raw[c][good])
                places[c].append(prediction[c][good])
    out = []
    for c, segments in enumerate(pieces):
        if not segments:
            out.append(likelihood.colours[c])
            continue
        if (problem.channels[c].quantity, problem.channels[c].unit) == ("position", "rad"):
            segments, _ = without_waves(segments, places[c], problem.steps[c])
        interval = problem.train[0].interval
        found = estimate_colour(segments, interval, motion_hz, motion_hz / MOTION_HARMONICS)
        floor = quietest(problem, c) / np.sqrt(problem.train[0].averaged)
        out.append(found if found.std >= floor else Colour(floor, interval=interval))
    return tuple(out)


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
        kept = sorted(before.fits.values(), key=before.criterion)[:RETAINED]
        self.ordered = sorted((after.fit(f.hypothesis, [f.x], f) for f in kept), key=after.criterion)
        self.empty = after.known(Hypothesis()) or after.empty()
        self.best = after.fit(best.hypothesis, [best.x], best)
        frozen = np.ones(len(self.nominal.x), dtype=bool)
        self.nominal = fit(self.training.objective(Hypothesis()), self.nominal.x, self.nominal.states, fixed=frozen)
        return self.best


def investigate(
    problem: Problem,
    candidates: Sequence[Candidate],
    frequency: float,
    *,
    effort: Effort | None = None,
    progress: Callable[[str], None] = lambda _: None,
    structure: Structure = lambda study, fitted, of_state: 0.0,
    deadline: Deadline | None = None,
) -> Outcome:
    """Search for the set of effects that the recordings speak for.

    frequency: of the slowest swing [Hz]. structure: see ``under_model_error``. deadline: by which the search is left with what has
    been found till then; ``TimeUp`` is raised where not even the nominal model was fitted in time.
    """
    deadline = deadline or Deadline()
    predictor = Predictor(problem, deadline=deadline)
    period = 1.0 / frequency
    reached: list[Study] = []
    try:
        final, ordered = _search(predictor, tuple(candidates), period, effort or Effort(), progress, reached, structure)
    except TimeUp:
        if not reached:
            raise
        final = next((s for s in reversed(reached) if any(f.hypothesis.members for f in s.fits.values())), reached[-1])
        ordered = []
        deadline.leave(*_left_by_the_search(final))
    with deadline.spared():
        empty = final.known(Hypothesis()) or final.empty()
        ordered = ordered or sorted(final.fits.values(), key=final.criterion)
        own = tuple(w for w in final.windows if w.run < len(problem.train))
        held = tuple(w for w in final.windows if w.run >= len(problem.train))
        training = final.unfitted(final.likelihood, own)
        frozen = np.ones(len(final.predictor.nominal), dtype=bool)
        states = {w: empty.states[w] for w in own}
        nominal = fit(training.objective(Hypothesis()), np.zeros(len(frozen)), states, fixed=frozen)
    return Outcome(
        final.problem, final.predictor, final, training, nominal, empty, ordered[0], ordered, held,
        MOTION_HARMONICS * frequency, period,
    )  # fmt: skip


def _search(
    predictor: Predictor,
    candidates: tuple[Candidate, ...],
    period: float,
    effort: Effort,
    progress: Callable[[str], None],
    reached: list[Study],
    structure: Structure,
) -> tuple[Study, list[Fit]]:
    """The last study of the search and its fits, best first.

    period: of the slowest swing [s]. reached: every study that was begun, one after another, for what there is if the time is up.
    """
    problem, deadline = predictor.problem, predictor.deadline
    motion_hz = MOTION_HARMONICS / period
    likelihood = Likelihood(problem, crude_colours(problem), lead=0.0)
    horizon = Horizon(problem, predictor, 2.0 * np.pi / period)
    with deadline.spared():
        # The nominal model and its noise: without these there is no answer at all.
        short = horizon.calm(cut(problem.runs, range(len(problem.runs)), SWINGS * period))
        first = _led_in(problem, predictor, likelihood, short, period)
        for _ in range(2):
            likelihood = replace(likelihood, colours=colours_from(problem, likelihood, first, predictor, motion_hz))
            study = Study(problem, predictor, likelihood, candidates, short, first_states=first.states, swing=period)
            study.fit(Hypothesis(), [first.x], first)
            study, first = (study, study.empty()) if deadline.over else either_way(study, study.empty())
            problem, predictor, likelihood = study.problem, study.predictor, study.likelihood
            if deadline.over:
                break
        reached.append(study)
    predictor.shorten(np.array([min(colour.std, colour.innovation[1]) for colour in likelihood.colours]))
    progress("short windows")
    groups = horizon.joined(first)

    def lengthened(short: Study) -> tuple[Study, Fit]:
        """The study of joined windows with the efforts of the short ones, and its nominal model."""
        longer = Study(
            short.problem, short.predictor, short.likelihood, candidates, groups,
            first_states=first.states, swing=period, hints=short.tests,
        )  # fmt: skip
        found = longer.fit(Hypothesis(), [first.x], first.beginning(groups))
        reached.append(longer)
        return longer, found

    long_study, empty = lengthened(study)
    progress("free runs of the nominal model")
    seeds, fine = [empty], None
    if empty.score > NONLINEAR * long_study.samples:
        # Rigs are at first too damped or not enough: where that is most of it, nothing need be looked for that leads there.
        fine = very_short(study)
        usual = ordinary_by_way_of_shorter(study, fine)
        early = None
        if usual is not None:
            early = begun_ordinary(
                long_study, usual, period, effort, progress, structure, reached,
                partial(few_suffice, study, usual, effort, progress),
            )  # fmt: skip
        if early is not None and early[0].likelihood.discrepancy is not None:
            return early
        seeds += [long_study.fit(f.hypothesis, [f.x], f) for f in early[1]] if early else []
    beginnings = begun(study, fine or very_short(study), effort, progress) if far_off(study, first) else []
    if beginnings and groups == short:
        seeds += beginnings
    if groups != short and (empty.score > NONLINEAR * long_study.samples or study.stretched(first)):
        # Far from the truth, free runs have many wrong valleys; short windows have few. They find where to begin. What was
        # bent beyond its tolerance is far from the truth too, however well it fits.
        if not any(map(study.only_noise, beginnings)):
            beginnings += ordinary(study, first)
        short_study, ordered = _begun_with(study, [first, *beginnings], effort, progress)
        if short_study is not study:
            reached.append(short_study)
            long_study, empty = lengthened(short_study)
            seeds = [empty]
        seeds += transfer(long_study, [f for f in ordered if f.hypothesis.members], 2 * effort.beam, progress)
    if min(f.score for f in seeds) > NONLINEAR * long_study.samples:
        seeds += ordinary(long_study, empty)
        progress("friction and drag together")
    likeliest = min(seeds, key=long_study.criterion)
    held_study, _ = either_way(long_study, likeliest)
    if held_study is not long_study:
        long_study, seeds = held_study, _again(held_study, seeds, likeliest)
        reached.append(long_study)
        progress("efforts held between samples")
    long_study, ordered = _other_way(long_study, grow(long_study, seeds, effort, progress), effort, progress)
    reached.append(long_study)
    quieter = _under_its_own_noise(long_study, ordered, motion_hz, effort, progress, quieter=True)
    if quieter is not None:
        long_study, ordered = quieter
        reached.append(long_study)
    # What is more than noise is weighed with a force that is left out; where nothing is, noise is the measure again.
    under = under_model_error(long_study, ordered, period, effort, progress, structure, reached)
    if under is not None and under[0].likelihood.discrepancy is None:
        long_study, ordered, under = replace(under[0], hints=long_study.hints), under[1], None
        reached.append(long_study)
    empty = long_study.known(Hypothesis()) or long_study.fit(Hypothesis(), [empty.x], empty)
    final = long_study
    if under is None:
        # The noise once more, now behind the best model; a last round under it if it has changed.
        refined = _under_its_own_noise(long_study, ordered, motion_hz, effort, progress)
        if refined is not None:
            final, ordered = refined
            reached.append(final)
        final, ordered = _other_way(final, polish(final, ordered, effort, progress), effort, progress)
    final, ordered = under or (final, ordered)
    if final.known(Hypothesis()) is None:
        final.fit(Hypothesis(), [empty.x], empty)
    return final, ordered


PROMISED = 3  # effects named that were to be fitted next


def _left_by_the_search(study: Study) -> tuple[str, str]:
    """What a search that was left in the middle has not tried, and what that may change."""
    best = min(study.fits.values(), key=study.criterion)
    members = len(best.hypothesis.members)
    tests = (t for t in study.tests.get(best.hypothesis.identity, {}).values() if t is not None)
    following = [
        t.candidate.key
        for t in sorted(tests, key=lambda t: -t.gain)
        if t.gain > study.price(t.candidate, members) and best.hypothesis.with_(t.candidate).identity not in study.fits
    ][:PROMISED]
    what = f"sets of effects beyond the {len(study.fits)} that were fitted, of {len(study.candidates)} effects at their sites"
    if following:
        what += f"; next would have come {', '.join(following)}"
    return what, "another set of effects may explain the recordings better, or as well"


def _begun_with(
    study: Study, seeds: Sequence[Fit], effort: Effort, progress: Callable[[str], None]
) -> tuple[Study, list[Fit]]:
    """Sets on short windows for whole runs to begin with; efforts are held from where that shows on."""
    held: list[Study] = []

    def shows(best: Fit) -> bool:
        other, _ = either_way(study, best)
        if other is not study:
            held.append(other)
        return bool(held)

    ordered = grow(study, seeds, effort, progress, to_begin_with=True, stop=shows)
    if not held:
        return study, ordered
    progress("efforts held between samples")
    again = _again(held[0], ordered[: 2 * effort.beam], ordered[0])
    return held[0], grow(held[0], again, effort, progress, to_begin_with=True)


def _under_its_own_noise(
    study: Study,
    ordered: list[Fit],
    motion_hz: float,
    effort: Effort,
    progress: Callable[[str], None],
    *,
    quieter: bool = False,
) -> tuple[Study, list[Fit]] | None:
    """The search gone on with under the noise behind its best set; None where that is no other noise.

    quieter: only where noise is quieter than was thought. Behind a nominal model that is far off, what that leaves passes for
    noise, in which an effect that is weaker by far than the strongest one does not show.
    """
    before, best = study.likelihood.colours, ordered[0]
    if best.score >= HOPELESS * study.samples:
        return None
    after = colours_from(study.problem, study.likelihood, best, study.predictor, motion_hz)
    if not (_quieter(before, after) if quieter else _differ(before, after)):
        return None
    other = Study(
        study.problem, study.predictor, replace(study.likelihood, colours=after), study.candidates, study.windows,
        first_states=study.first_states, swing=study.swing, hints=study.hints, before=study,
    )  # fmt: skip
    empty = study.known(Hypothesis()) or study.empty()
    seeds = _again(other, ordered[: 2 * effort.beam], best)
    other.fit(Hypothesis(), [empty.x], empty)
    return other, grow(other, seeds, effort, progress)


def _again(study: Study, fits: Sequence[Fit], best: Fit) -> list[Fit]:
    """Fits of another study from where those stand that do not leave far more than the best one."""
    return [study.fit(f.hypothesis, [f.x], f) for f in fits if f is best or f.score < FAR * best.score]


def _other_way(
    study: Study, ordered: list[Fit], effort: Effort, progress: Callable[[str], None]
) -> tuple[Study, list[Fit]]:
    """The search with efforts taken the other way (held, smooth), gone on with from there, where the best set is better so."""
    turned = better_the_other_way(study, ordered, 2 * effort.beam)
    if turned is None:
        return study, ordered
    progress("efforts taken otherwise")
    return turned[0], grow(*turned, effort, progress)


def _led_in(
    problem: Problem, predictor: Predictor, likelihood: Likelihood, windows: Sequence[Window], period: float
) -> Fit:
    """The nominal model fitted on short windows, by way of shorter ones where its vibrations could slip by a cycle."""
    near: Fit | None = None
    x = np.zeros(len(predictor.nominal))
    ways = [*stages(problem, windows), tuple(windows)]
    for k, cuts in enumerate(ways):
        if near is not None and predictor.deadline.over and k < len(ways) - 1:
            continue
        study = Study(problem, predictor, likelihood, (), cuts, swing=period)
        near = study.fit(Hypothesis(), [x], None if near is None else near.beginning(cuts))
        x = near.x
    assert near is not None
    return near


def _quieter(before: Sequence[Colour], after: Sequence[Colour]) -> bool:
    """Whether any channel's noise has turned out to be quieter than was thought, from one sample to the next."""
    return any(np.log(a.innovation[1] / b.innovation[1]) > SAME_NOISE for a, b in zip(before, after, strict=True))


def _differ(before: Sequence[Colour], after: Sequence[Colour]) -> bool:
    """Whether noise estimates differ by more than tests at the usual sizes of recordings would notice."""
    return any(
        abs(np.log(a.std / b.std)) > SAME_NOISE or abs(np.log(a.innovation[1] / b.innovation[1])) > SAME_NOISE
        for a, b in zip(before, after, strict=True)
    )


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
    held = fit(outcome.study.objective(own.hypothesis).on(outcome.held_windows), own.x, states, fixed=frozen)
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
        known = outcome.read[id(fitted)] = fitted, fit(objective, fitted.x, fitted.states, fixed=every)
    return known[1]


def heldout_z(outcome: Outcome, smaller: Fit, larger: Fit) -> float:
    """How much less the data held out cost under the larger hypothesis, in standard deviations; negative if they cost more.

    The cost that they add to a fit of the training data when all is fitted again (a predictive likelihood): so what the training
    leaves uncertain is not held against either hypothesis, and what only soaks up the training's error gains nothing. Where even
    the larger leaves more than noise there, deviations are as large as what it leaves.
    """
    added = _added(outcome, larger)
    gain = _added(outcome, smaller) - added
    level = max(added / max(outcome.study.likelihood.samples(outcome.held_windows), 1.0), 1.0)
    return float(np.sign(gain) * np.sqrt(abs(gain) / level))


def training_gain(outcome: Outcome, smaller: Fit, larger: Fit) -> float:
    """How much better the larger hypothesis fits the training data alone."""
    return _within(outcome, smaller) - _within(outcome, larger)


def _added(outcome: Outcome, fitted: Fit) -> float:
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
