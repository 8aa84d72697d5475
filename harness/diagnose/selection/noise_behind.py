"""The sensors' noise as it is behind a fit: at first behind the nominal model, later behind what was found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.angle_waves import without_waves
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.noise_colour import Colour, estimate_colour
from harness.diagnose.estimation.scatter import quietest
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.beam_search import Effort, grow
from harness.diagnose.selection.constants.search import HOPELESS_COST_RATIO
from harness.diagnose.selection.constants.starts import MOTION_HARMONICS, SAME_NOISE_DIFFERENCE
from harness.diagnose.selection.fitted_again import fitted_again
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


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
        seldom = _seldom(problem, c)
        found = estimate_colour(segments, seldom * interval, motion_hz, motion_hz / MOTION_HARMONICS)
        if seldom > 1.0:
            # Its readings have no neighbours among the samples: each counts for as much as slow noise leaves it.
            found = Colour(found.std / np.sqrt(found.effective_fraction), interval=interval)
        floor = quietest(problem, c) / np.sqrt(problem.train[0].averaged)
        out.append(found if found.std >= floor else Colour(floor, interval=interval))
    return tuple(out)


def _seldom(problem: Problem, channel: int) -> float:
    """Samples from one reading of a channel to the next, one where every sample has one."""
    gaps = [np.diff(np.flatnonzero(np.isfinite(run.values[channel]))) for run in problem.train]
    pooled = np.concatenate(gaps)
    return float(np.median(pooled)) if len(pooled) else 1.0


def under_its_own_noise(
    study: Study,
    ordered: list[Fit],
    motion_hz: float,
    effort: Effort,
    progress: Callable[[str], None],
    reached: list[Study],
    *,
    quieter: bool = False,
) -> tuple[Study, list[Fit]] | None:
    """The search gone on with under the noise behind its best set; None where that is no other noise.

    reached: told of the study before it is searched, for what there is if the time is up.

    quieter: only where noise is quieter than was thought. Behind a nominal model that is far off, what that leaves passes for
    noise, in which an effect that is weaker by far than the strongest one does not show.
    """
    before, best = study.likelihood.colours, ordered[0]
    if best.score >= HOPELESS_COST_RATIO * study.samples:
        return None
    after = colours_from(study.problem, study.likelihood, best, study.predictor, motion_hz)
    if not (_quieter(before, after) if quieter else _differ(before, after)):
        return None
    other = Study(
        study.problem, study.predictor, replace(study.likelihood, colours=after), study.candidates, study.windows,
        first_states=study.first_states, swing=study.swing, hints=study.hints, before=study,
    )  # fmt: skip
    empty = study.known(Hypothesis()) or study.empty()
    seeds = fitted_again(other, ordered[: 2 * effort.beam], best)
    other.fit(Hypothesis(), [empty.x], empty)
    reached.append(other)
    return other, grow(other, seeds, effort, progress)


def _quieter(before: Sequence[Colour], after: Sequence[Colour]) -> bool:
    """Whether any channel's noise has turned out to be quieter than was thought, from one sample to the next."""
    return any(
        np.log(a.innovation[1] / b.innovation[1]) > SAME_NOISE_DIFFERENCE for a, b in zip(before, after, strict=True)
    )


def _differ(before: Sequence[Colour], after: Sequence[Colour]) -> bool:
    """Whether noise estimates differ by more than tests at the usual sizes of recordings would notice."""
    return any(
        abs(np.log(a.std / b.std)) > SAME_NOISE_DIFFERENCE
        or abs(np.log(a.innovation[1] / b.innovation[1])) > SAME_NOISE_DIFFERENCE
        for a, b in zip(before, after, strict=True)
    )
