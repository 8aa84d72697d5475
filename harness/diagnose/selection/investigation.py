"""One diagnosis from posed problem to selected hypothesis: a first look, openings, whole runs, the force that is left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from harness.diagnose.estimation.horizon import Horizon
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.reach import check_reach
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.constants import NOISE_ALONE_SHARE, NOISE_SEARCH_SHARE
from harness.diagnose.problem.deadline import Deadline, Spared, TimeUp
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.beam_search import Effort, grow, polish
from harness.diagnose.selection.constants.search import PROMISED_EFFECTS
from harness.diagnose.selection.constants.starts import MOTION_HARMONICS
from harness.diagnose.selection.effort_hold import better_the_other_way, either_way
from harness.diagnose.selection.first_look import first_look
from harness.diagnose.selection.fitted_again import fitted_again
from harness.diagnose.selection.model_error import Laws, Structure, under_model_error
from harness.diagnose.selection.noise_behind import under_its_own_noise
from harness.diagnose.selection.opening import Opened, Opening
from harness.diagnose.selection.openings.catalogue import openings
from harness.diagnose.selection.outcome import Outcome, as_stated
from harness.diagnose.selection.study import Study

SEARCHED = "further sets of effects that might leave only noise", "few effects may explain all that is left"


def investigate(
    problem: Problem,
    candidates: Sequence[Candidate],
    frequency: float,
    *,
    effort: Effort | None = None,
    progress: Callable[[str], None] = lambda _: None,
    structure: Structure = lambda study, fitted, of_state: 0.0,
    laws: Laws = dict,
    deadline: Deadline | None = None,
) -> Outcome:
    """Search for the set of effects that the recordings speak for.

    frequency: of the slowest swing [Hz]. structure, laws: see ``under_model_error``. deadline: by which the search is left with
    what has been found till then; ``TimeUp`` is raised where not even the nominal model was fitted in time, InputError where the
    recordings are beyond what the model's loops can reach.
    """
    deadline = deadline or Deadline()
    predictor = Predictor(problem, deadline=deadline)
    check_reach(predictor)
    period = 1.0 / frequency
    reached: list[Study] = []
    try:
        final, ordered = _search(
            predictor, tuple(candidates), period, effort or Effort(), progress, reached, structure, laws
        )
    except TimeUp:
        if not reached:
            raise
        final, ordered = _last_with_effects(reached), []
        deadline.leave(*_left_by_the_search(final))
    with deadline.spared(Spared.TO_ITS_END):
        empty = final.known(Hypothesis()) or final.empty()
        ordered = ordered or sorted(final.fits.values(), key=final.criterion)
        own = tuple(w for w in final.windows if w.run < len(problem.train))
        held = tuple(w for w in final.windows if w.run >= len(problem.train))
        training = final.unfitted(final.likelihood, own)
        nominal = as_stated(training, {w: empty.states[w] for w in own})
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
    laws: Laws,
) -> tuple[Study, list[Fit]]:
    """The last study of the search and its fits, best first.

    period: of the slowest swing [s]. reached: every study that was begun, one after another, for what there is if the time is up.
    """
    motion_hz = MOTION_HARMONICS / period
    horizon = Horizon(predictor.problem, predictor, 2.0 * np.pi / period)
    short, first = first_look(predictor, candidates, period, horizon)
    reached.append(short)
    short.predictor.shorten(np.array([min(c.std, c.innovation[1]) for c in short.likelihood.colours]))
    progress("short windows")
    opened = Opened(short, first, horizon.joined(first), effort, progress, structure, laws, reached)
    progress("free runs of the nominal model")
    # The first one may find that a force is left out, and goes on beside that; the others know noise alone.
    first_of_all, *others = openings().values()
    first_of_all.go(opened)
    if opened.answer is not None:
        return opened.answer

    def so_far() -> tuple[Study, list[Fit]]:
        study = _last_with_effects(reached)
        return study, sorted(study.fits.values(), key=study.criterion)

    few = any(opened.short.only_noise(f) for f in opened.short.fits.values() if f.hypothesis.members)
    long_study, ordered = predictor.deadline.within(
        NOISE_ALONE_SHARE if few else NOISE_SEARCH_SHARE, *SEARCHED,
        lambda: _under_noise(opened, others, motion_hz), so_far,
    )  # fmt: skip
    # What is more than noise is weighed with a force that is left out; where nothing is, noise is the measure again.
    under = under_model_error(long_study, ordered, period, effort, progress, structure, reached, laws=laws)
    if under is not None and under[0].likelihood.discrepancy is None:
        long_study, ordered, under = replace(under[0], hints=long_study.hints), under[1], None
        reached.append(long_study)
    empty = long_study.known(Hypothesis()) or long_study.fit(Hypothesis(), [opened.empty.x], opened.empty)
    final = long_study
    if under is None:
        # The noise once more, now behind the best model; a last round under it if it has changed.
        refined = under_its_own_noise(long_study, ordered, motion_hz, effort, progress, reached)
        if refined is not None:
            final, ordered = refined
        final, ordered = _other_way(final, polish(final, ordered, effort, progress), effort, progress)
    final, ordered = under or (final, ordered)
    if final.known(Hypothesis()) is None:
        final.fit(Hypothesis(), [empty.x], empty)
    return final, ordered


def _under_noise(opened: Opened, others: Sequence[Opening], motion_hz: float) -> tuple[Study, list[Fit]]:
    """The search for sets that leave nothing but noise: its last study and the fits of that, best first."""
    effort, progress, reached = opened.effort, opened.progress, opened.reached
    for opening in others:
        opening.go(opened)
    study, seeds = opened.long, opened.seeds
    likeliest = min(seeds, key=study.criterion)
    held_study, _ = either_way(study, likeliest)
    if held_study is not study:
        study, seeds = held_study, fitted_again(held_study, seeds, likeliest)
        reached.append(study)
        progress("efforts held between samples")
    study, ordered = _other_way(study, grow(study, seeds, effort, progress), effort, progress)
    reached.append(study)
    quieter = under_its_own_noise(study, ordered, motion_hz, effort, progress, reached, quieter=True)
    if quieter is not None:
        study, ordered = quieter
    return study, ordered


def _last_with_effects(reached: Sequence[Study]) -> Study:
    """The last study in which a set of effects was fitted; without any, the last one."""
    return next((s for s in reversed(reached) if any(f.hypothesis.members for f in s.fits.values())), reached[-1])


def _left_by_the_search(study: Study) -> tuple[str, str]:
    """What a search that was left in the middle has not tried, and what that may change."""
    best = min(study.fits.values(), key=study.criterion)
    members = len(best.hypothesis.members)
    tests = (t for t in study.tests.get(best.hypothesis.identity, {}).values() if t is not None)
    following = [
        t.candidate.key
        for t in sorted(tests, key=lambda t: -t.gain)
        if t.gain > study.price(t.candidate, members) and best.hypothesis.with_(t.candidate).identity not in study.fits
    ][:PROMISED_EFFECTS]
    what = f"sets of effects beyond the {len(study.fits)} that were fitted, of {len(study.candidates)} effects at their sites"
    if following:
        what += f"; next would have come {', '.join(following)}"
    return what, "another set of effects may explain the recordings better, or as well"


def _other_way(
    study: Study, ordered: list[Fit], effort: Effort, progress: Callable[[str], None]
) -> tuple[Study, list[Fit]]:
    """The search with efforts taken the other way (held, smooth), gone on with from there, where the best set is better so."""
    turned = better_the_other_way(study, ordered, 2 * effort.beam)
    if turned is None:
        return study, ordered
    progress("efforts taken otherwise")
    return turned[0], grow(*turned, effort, progress)
