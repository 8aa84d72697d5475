"""Where to begin when the nominal model is altogether off: windows so short that a wrong force has no time to lead far away.

A spring or a counterweight that the model does not have leaves it falling where the recording swings. Free runs over a swing say
nothing then. Over a few samples any force shows as what it is, an acceleration, and every effect that is a force is as good as
linear.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.diagnose.estimation.constants import FEWEST_WINDOW_SAMPLES
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.problem.windows import Window, equal_parts
from harness.diagnose.selection.beam_search import Effort, grow, tell, transfer
from harness.diagnose.selection.constants.starts import EXPLAINS_NOTHING_SHARE, ON_COURSE_SHARE, SHORT_WINDOW_PARTS
from harness.diagnose.selection.dissipation_starts import everywhere
from harness.diagnose.selection.score_tests import Score
from harness.diagnose.selection.study import Study


def far_off(study: Study, fitted: Fit) -> bool:
    """Whether a fit leaves much of how the readings vary within its windows, on any channel of any recording.

    Not asked of what bends, whose vibrations have short windows of their own (``vibration_windows``).
    """
    problem, predictor = study.problem, study.predictor
    if problem.system.flexible:
        return False
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    left: dict[tuple[int, int], list[float]] = {}
    for window, predicted in zip(
        fitted.windows, predictor.predict(fitted.hypothesis, fitted.x[None], lanes), strict=True
    ):
        read = problem.runs[window.run].values[:, window.first : window.last]
        for c in range(len(problem.channels)):
            good = np.isfinite(read[c])
            noise = study.likelihood.colours[c].std ** 2
            varies = float(np.var(read[c, good])) if good.any() else 0.0
            if varies > 4.0 * noise:
                miss = float(np.mean(np.clip(predicted[c, good] - read[c, good], -1e9, 1e9) ** 2))
                left.setdefault((window.run, c), []).append(miss / varies)
    return any(float(np.median(shares)) > EXPLAINS_NOTHING_SHARE for shares in left.values())


def branching(study: Study) -> bool:
    """Whether short windows are long for a mechanism: closed ones and bodies in space have motions far quicker than their slowest.

    Small errors grow manifold there within a swing, of the initial states, too.
    """
    return bool(study.problem.system.loops or study.problem.system.gimbals)


def very_short(study: Study) -> Study:
    """A study of pieces of a study's windows, with the nominal model fitted there."""
    likelihood = study.likelihood
    if branching(study):
        # What the nominal model leaves of a longer window is little of noise, beside which nothing would show here.
        likelihood = replace(likelihood, colours=crude_colours(study.problem))
    fine = Study(
        study.problem, study.predictor, likelihood, study.candidates, _pieces(study, SHORT_WINDOW_PARTS), swing=study.swing
    )  # fmt: skip
    fine.empty()
    return fine


def _pieces(study: Study, parts: int) -> tuple[Window, ...]:
    """Every window of a study in so many parts, as far as samples allow."""
    return tuple(
        piece
        for window in study.windows
        for piece in equal_parts(window, int(np.clip(window.size // FEWEST_WINDOW_SAMPLES, 1, parts)))
    )


def lengthened(study: Study, fine: Study, fitted: Fit) -> Fit:
    """The fit on a study's windows of a set that was fitted on very short ones, by way of windows twice as long each time."""
    near, parts = fitted, SHORT_WINDOW_PARTS // 2
    while parts > 1:
        cuts = _pieces(study, parts)
        middle = Study(study.problem, study.predictor, fine.likelihood, study.candidates, cuts, swing=study.swing)
        near, parts = middle.fit(near.hypothesis, [near.x], near.beginning(cuts)), parts // 2
    return study.fit(near.hypothesis, [near.x], near.beginning(study.windows))


def begun(study: Study, fine: Study, effort: Effort, progress: Callable[[str], None]) -> list[Fit]:
    """Fits on a study's windows of the sets that very short windows (``very_short``) ask for, best first."""
    progress("very short windows")
    ordered = grow(fine, [fine.empty()], effort, progress, to_begin_with=True)
    sets = [f for f in ordered if f.hypothesis.members]
    if branching(study):
        found = []
        for one in sets[: effort.beam]:
            found.append(lengthened(study, fine, one))
            tell(study, "short windows of " + " + ".join(one.hypothesis.keys), progress)
            if study.only_noise(found[-1]):
                # What could stand in its place has its turn where whole runs tell them apart.
                break
    else:
        found = transfer(study, sets, 2 * effort.beam, progress)
    return sorted(found, key=study.criterion)


def ordinary_by_way_of_shorter(study: Study, fine: Study) -> Fit | None:
    """The fit of ordinary dissipation on a study's windows, by way of very short ones, where it has no wrong valleys.

    The study of those is left as it is, for a search that begins there.
    """
    apart = replace(fine.unfitted(fine.likelihood), fits=dict(fine.fits))
    found = everywhere(apart, apart.empty())
    if found is None:
        return None
    return lengthened(study, apart, found) if branching(study) else everywhere(study, found)


def few_suffice(study: Study, usual: Fit, effort: Effort, progress: Callable[[str], None]) -> Fit | None:
    """Few effects that leave nothing but noise on a study's windows, if there are any.

    Begun from the nominal model and from ordinary dissipation: neither beginning knows of the other, beside which it might seem
    hopeless. Where few effects do not suffice, sets that grow go on taking away a little each, and the search is given up: what is
    left is no law of few effects, or no law of the catalogue. What is dear to run is looked for where nothing else suffices, and
    beside the nominal model alone.
    """
    progress("few effects that leave only noise")
    nothing = study.empty()
    tests: dict[frozenset[str], dict[str, Score | None]] = {}
    known = {first.hypothesis.identity: {first.hypothesis.identity: first} for first in (nothing, usual)}
    for beginning, candidates in ((nothing, study.cheap), (usual, study.cheap), (nothing, study.candidates)):
        # What was fitted without what is dear is fitted no other way beside it.
        fits = known[beginning.hypothesis.identity]
        apart = replace(study.unfitted(study.likelihood), candidates=candidates, fits=fits, tests=tests)
        stop = _OffCourse(study.samples, beginning.score - study.samples)
        found = grow(apart, [beginning], effort, progress, to_begin_with=True, stop=stop)
        study.fits.update({key: fitted for key, fitted in apart.fits.items() if key not in study.fits})
        if study.only_noise(found[0]):
            return found[0]
    return None


class _OffCourse:
    """Whether a search, asked after every round, takes away too little of what is left above the noise.

    samples: what noise alone leaves; above: what the beginning leaves beyond that.
    """

    def __init__(self, samples: float, above: float) -> None:
        self.samples = samples
        self.above = above

    def __call__(self, best: Fit) -> bool:
        before, self.above = self.above, best.score - self.samples
        return self.above > ON_COURSE_SHARE * before
