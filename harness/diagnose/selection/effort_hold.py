"""Whether recorded efforts act smoothly through their samples or are held from each to the next: the recordings tell.

That is no effect (see ``problem.held_efforts``), and costs none of the evidence; where the two are equally good, efforts are taken
as smooth, or as held if they look like commands (``problem.commands``).

It is asked of the nominal model, of ordinary dissipation beside it, of the first set that leaves little more than noise, and of
the best sets at the end: beside what else is missing, a late sensor looks the same. A drive that is late by two intervals is told
with that, not with one and a half; but where nothing is late once efforts are held, they are held, for that is a finding less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.held_efforts import held_notes, late
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.constants.search import FAR_COST_RATIO, HOPELESS_COST_RATIO
from harness.diagnose.selection.pruning import pruned
from harness.diagnose.selection.study import Study
from harness.recording.recording import Recording


def either_way(study: Study, fitted: Fit) -> tuple[Study, Fit]:
    """The study and a fit of it, or both with efforts held where that leaves plainly less, and little more than noise: beside what
    else the model left out, a sensor that is late would look the same."""
    if not study.problem.driven or study.problem.held:
        return study, fitted
    other = _turned(study)
    found = other.fit(fitted.hypothesis, [fitted.x], fitted)
    plainly = found.score < min(
        fitted.score - UNPARTED_EVIDENCE * other.loudness(found), HOPELESS_COST_RATIO * other.samples
    )
    return (other, found) if plainly else (study, fitted)


def better_the_other_way(study: Study, ordered: Sequence[Fit], count: int) -> tuple[Study, list[Fit]] | None:
    """The study with efforts taken the other way and its fits, if the best set there is better; the ``count`` best are tried.

    As good is enough to take efforts as what they look like: what only a half interval more or less in every delay parts is no
    reason for the other. It is one for holding where nothing then is late at all: a finding less, as good.
    """
    best = ordered[0]
    if not study.problem.driven or not (study.problem.held or late(best.hypothesis) or not study.only_noise(best)):
        return None
    other = _turned(study)
    near = [f for f in ordered[:count] if f.score < FAR_COST_RATIO * best.score]
    for fitted in near:
        other.fit(fitted.hypothesis, [fitted.x], fitted, target=best.score + UNPARTED_EVIDENCE * study.loudness(best))
    found = min(other.fits.values(), key=other.criterion)
    if late(found.hypothesis) and found.score < best.score + UNPARTED_EVIDENCE * study.loudness(best):
        found = pruned(other, found)
    gain = study.criterion(best) - other.criterion(found)
    least = -UNPARTED_EVIDENCE if study.problem.held != study.problem.commanded else UNPARTED_EVIDENCE
    if len(found.hypothesis.members) < len(best.hypothesis.members) and not late(found.hypothesis):
        least = 0.0
    if gain < least * study.loudness(best):
        return None
    return other, sorted(other.fits.values(), key=other.criterion)


def told(problem: Problem, recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings, with a quality note for every effort that was found to be held."""
    if not problem.held:
        return list(recordings)
    return [replace(r, quality=(*r.quality, *held_notes(r))) for r in recordings]


def _turned(study: Study) -> Study:
    """A study of the same windows and noise with efforts taken the other way, without any fits."""
    problem = replace(study.problem, held=not study.problem.held)
    return Study(
        problem, study.predictor.taking(problem), replace(study.likelihood, problem=problem), study.candidates, study.windows,
        first_states=study.first_states, swing=study.swing,
    )  # fmt: skip
