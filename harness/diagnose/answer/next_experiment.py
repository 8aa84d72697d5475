"""The next experiment, as the answer tells it."""

from __future__ import annotations

from typing import Any

from harness.diagnose.answer.explain import NO_FINDING
from harness.diagnose.claims.conclude import Claim, Conclusion
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.experiment.constants import PARTED_SIGMAS
from harness.diagnose.experiment.design import propose
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.study import Study

PROPOSED = ("the next experiment", NO_FINDING)


def _differing_in(study: Study, best: Fit, claim: Claim, rival: Candidate) -> tuple[Fit, Fit | None]:
    """Two fits that differ by a claim and its rival alone: of the best set, or of one with another effect beside both."""
    kept = best.hypothesis.identity - {claim.candidate.key}
    if rival.key not in claim.beside:
        return best, study.fits.get(kept | {rival.key})
    for key in kept:
        for partner in claim.beside[rival.key]:
            rest = (kept - {key}) | {partner}
            first, other = study.fits.get(rest | {claim.candidate.key}), study.fits.get(rest | {rival.key})
            if first is not None and other is not None:
                return first, other
    return best, None


def next_experiment(outcome: Outcome, conclusion: Conclusion) -> dict[str, Any]:
    """The experiment that would part what these recordings cannot; none if there was no time to look for it."""
    return outcome.predictor.deadline.attempt(
        *PROPOSED, lambda: _proposed(outcome, conclusion), lambda: {"what": "", "separates": []}
    )


def _proposed(outcome: Outcome, conclusion: Conclusion) -> dict[str, Any]:
    study = outcome.study
    pairs: list[tuple[Fit, Fit, tuple[str, ...]]] = []
    for claim in conclusion.claims:
        for rival in claim.rival_candidates:
            first, other = _differing_in(study, conclusion.best, claim, rival)
            if other is not None:
                pairs.append((first, other, (claim.candidate.effect.name, rival.effect.name)))
    runner_up = ""
    if not pairs and conclusion.best.hypothesis.members:
        # Nothing is left open; the runner-up would still be the first to doubt.
        for other in outcome.ordered:
            names = {m.effect.name for m in other.hypothesis.members} ^ {
                m.effect.name for m in conclusion.best.hypothesis.members
            }
            if names and len(other.hypothesis.members) == len(conclusion.best.hypothesis.members):
                pairs.append((conclusion.best, other, tuple(sorted(names))))
                runner_up = " + ".join(other.hypothesis.keys)
                break
    proposal = propose(study, pairs[:3])
    if proposal is None:
        return {"what": "", "separates": []}
    if runner_up and proposal.separation < PARTED_SIGMAS:
        return {"what": "", "separates": []}
    if runner_up:
        # The recordings part the two already: the answer lists no such pair, so none is named here.
        what = f"{proposal.what}, where the likeliest set beside what is told ({runner_up}) would show most that it is wrong"
        return {"what": what, "separates": [], "expected_sigma": proposal.separation}
    return {"what": proposal.what, "separates": list(proposal.separates), "expected_sigma": proposal.separation}
