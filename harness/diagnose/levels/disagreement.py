"""Whether recordings disagree with one another: the same few laws explain each by itself, and not all of them together.

Runs of another rod, or from before and after a repair, given as one rig's: what a fit of all of them leaves has any shape
then, and no law of the catalogue earns its place. Asked is what a bench is changed by first, ordinary dissipation beside one
thing that is not as drawn, of each recording alone. Where a model error is common to all, no recording is explained by itself,
and nothing is said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.stats import chi2

from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.criticism.constants import COMPLETE_RESIDUAL_RATIO, TEST_CHANCE
from harness.diagnose.estimation.intervals import Estimate, estimates
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.levels.constants import APART_RATIO
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.selection.dissipation_starts import with_one_change
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.study import Study

EXPLAINED = ("consistent", "explained")


@dataclass(frozen=True, eq=False)
class Disagreement:
    """What recordings say by themselves that they do not say together.

    members: of the set that explains each. times: what it leaves of each, over its noise [1], by recording; together: of all at
    once. values: estimates of every member's parameters, by recording.
    """

    members: tuple[Candidate, ...]
    times: Mapping[str, float]
    together: float
    values: Mapping[str, Sequence[Mapping[str, Estimate]]]

    @cached_property
    def differing(self) -> list[tuple[int, str]]:
        """Members and parameters whose estimates no common value explains (χ² of their scatter), the most telling first."""
        rows = []
        for k, member in enumerate(self.members):
            for parameter in member.effect.parameters:
                own = [values[k][parameter.name] for values in self.values.values()]
                std = np.array([e.std or (e.high - e.low) / 4.0 for e in own])
                x = np.array([e.value for e in own])
                if not np.all(np.isfinite(std) & (std > 0.0)):
                    continue
                mean = float(np.sum(x / std**2) / np.sum(1.0 / std**2))
                square = float(np.sum(((x - mean) / std) ** 2))
                if float(chi2.sf(square, len(x) - 1)) < TEST_CHANCE:
                    rows.append((square, k, parameter.name))
        return [(k, name) for _, k, name in sorted(rows, reverse=True)]

    def document(self, units: Sequence[Mapping[str, str]]) -> dict[str, Any]:
        """For programs: the set, and of every recording what it leaves and its parameters; units: of every member's."""
        return {
            "effects": [member.key for member in self.members],
            "times_noise_together": self.together,
            "recordings": [
                {
                    "recording": name,
                    "times_noise": times,
                    "parameters": {
                        f"{member.key}.{key}": e.document(unit[key])
                        for member, own, unit in zip(self.members, self.values[name], units, strict=True)
                        for key, e in own.items()
                    },
                }
                for name, times in self.times.items()
            ],
            "differing": [f"{self.members[k].key}.{name}" for k, name in self.differing],
        }


def disagreement(outcome: Outcome, conclusion: Conclusion) -> Disagreement | None:
    """The smallest set that leaves noise of every recording by itself and far more of all together; None where there is none."""
    problem, study = outcome.problem, outcome.study
    names = [run.name for run in problem.runs]
    if conclusion.verdict in EXPLAINED or problem.same_recording or len(set(names)) < max(2, len(names)):
        return None
    if any(run.payload for run in problem.runs):
        return None
    # Noise that was estimated beside what all recordings leave together has the size of that.
    rough = study.likelihood.as_scattered
    alone = [study.unfitted(rough, tuple(w for w in study.windows if w.run == run)) for run in range(len(problem.runs))]
    known: set[frozenset[str]] | None = None
    # The shortest first: where a model error is common to all, that is soonest known to be unexplained.
    for own in sorted(alone, key=lambda one: one.samples):
        empty = own.empty()
        if not _leaves_noise(own, empty):
            with_one_change(own, empty)
        enough = {key for key, fitted in own.fits.items() if _leaves_noise(own, fitted)}
        if not enough:
            return None
        # A recording that the nominal model explains asks for nothing, and is explained by more.
        if frozenset() not in enough:
            known = enough if known is None else known & enough
    if not known:
        # None asks for anything, or no set explains all that do.
        return None
    likeliest = min(known, key=lambda key: sum(own.criterion(own.fits[key]) for own in alone if key in own.fits))
    hypothesis = next(own.fits[likeliest].hypothesis for own in alone if likeliest in own.fits)
    fits = _smallest(alone, [_of_one(own, hypothesis, alone) for own in alone])
    if not all(map(_leaves_noise, alone, fits)):
        return None
    hypothesis = fits[0].hypothesis
    together = _together(study.unfitted(rough), fits)
    if together < APART_RATIO:
        return None
    found = Disagreement(
        hypothesis.members,
        {name: _times(own, f) for name, own, f in zip(names, alone, fits, strict=True)},
        together,
        {
            name: [estimates(outcome.predictor, f, k) for k in range(len(hypothesis.members))]
            for name, f in zip(names, fits, strict=True)
        },
    )
    # Where no number differs, all together have only ended in a wrong valley.
    return found if found.differing else None


def _leaves_noise(study: Study, fitted: Fit) -> bool:
    return fitted.score <= COMPLETE_RESIDUAL_RATIO**2 * study.samples


def _smallest(alone: Sequence[Study], fits: Sequence[Fit]) -> Sequence[Fit]:
    """The fits less every member that no recording misses."""

    def asked(some: Sequence[Fit]) -> float:
        return sum(own.criterion(f) for own, f in zip(alone, some, strict=True))

    for key in fits[0].hypothesis.keys:
        smaller = [own.reduce(f, f.hypothesis.keys.index(key)) for own, f in zip(alone, fits, strict=True)]
        of_one = {f.hypothesis.identity for f in smaller} == {fits[0].hypothesis.identity - {key}}
        if of_one and asked(smaller) < asked(fits):
            fits = smaller
    return fits


def _of_one(own: Study, hypothesis: Hypothesis, others: Sequence[Study]) -> Fit:
    """The fit of a set to one recording, begun from where others have it."""
    known = own.fits.get(hypothesis.identity)
    starts = [study.fits[hypothesis.identity].x for study in others if hypothesis.identity in study.fits]
    return known or own.fit(hypothesis, starts, own.empty())


def _together(study: Study, fits: Sequence[Fit]) -> float:
    """What the set leaves of all recordings at once, over the noise, from where any one of them has it."""
    states = {window: state for f in fits for window, state in f.states.items()}
    near = replace(fits[0], windows=study.windows, states=states)
    starts = [np.mean([f.x for f in fits], axis=0), *(f.x for f in fits)]
    return _times(study, study.fit(fits[0].hypothesis, starts, near))


def _times(study: Study, fitted: Fit) -> float:
    return float(np.sqrt(max(fitted.score, 0.0) / study.samples))
