"""Estimates of what is claimed, with intervals as far as recordings let them be."""

from __future__ import annotations

from harness.diagnose.claims.averaged import averaged
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.dissipation_beside import fit_dissipation_beside
from harness.diagnose.claims.rivals import with_the_same
from harness.diagnose.estimation.intervals import Estimate, across, estimates, no_more_exact_than_the_law
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.profile_likelihood import as_likely, profiled, spanning
from harness.diagnose.selection.state_evidence import Evidence


def intervals(outcome: Outcome, conclusion: Conclusion) -> dict[str, dict[str, Estimate]]:
    """Estimates of what is claimed, by the effect's key: as far as other valleys and other sets that are as likely let them be."""
    study, predictor, best = outcome.study, outcome.predictor, conclusion.best
    if outcome.evidence is not None and not conclusion.by_free_runs:
        return _beside_the_force(outcome, conclusion, outcome.evidence)
    # What shows in the data held out alone can only be told by them.
    source = outcome.study if conclusion.only_held else outcome.training
    fit_dissipation_beside(study, best, (claim.candidate for claim in conclusion.claims))
    own = source.sharpened(best if conclusion.only_held else conclusion.own)
    same = conclusion.own.hypothesis.keys == best.hypothesis.keys
    sharp: dict[frozenset[str], Fit] = {}
    values = {}
    for claim in conclusion.claims:
        k, key = claim.index, claim.candidate.key
        likely = with_the_same(outcome, best, key)
        sharp |= {f.hypothesis.identity: study.sharpened(f) for f in likely if f.hypothesis.identity not in sharp}
        others = (sharp[f.hypothesis.identity] for f in likely)
        alone = profiled(source, own, k, estimates(predictor, own, k))
        reached = across(
            claim.candidate,
            spanning(claim.candidate, alone, as_likely(study, best, k) if same else []),
            [estimates(predictor, f, f.hypothesis.keys.index(key)) for f in others],
        )
        values[key] = no_more_exact_than_the_law(claim.candidate, reached)
    return values


def _beside_the_force(
    outcome: Outcome, conclusion: Conclusion, evidence: Evidence, *, at_hand: bool = False
) -> dict[str, dict[str, Estimate]]:
    """Estimates of what is claimed beside a force over the state."""
    members = {claim.candidate.key: claim.candidate for claim in conclusion.claims}
    found = averaged(outcome, evidence, conclusion.own, at_hand=at_hand)
    return {key: no_more_exact_than_the_law(member, found[key]) for key, member in members.items()}


def curvatures(outcome: Outcome, conclusion: Conclusion) -> dict[str, dict[str, Estimate]]:
    """The same by what is at hand: the curvature of the one fit alone, or sets that have been looked at beside a force."""
    if outcome.evidence is not None and not conclusion.by_free_runs:
        return _beside_the_force(outcome, conclusion, outcome.evidence, at_hand=True)
    return {
        claim.candidate.key: estimates(
            outcome.predictor, conclusion.own, conclusion.own.hypothesis.keys.index(claim.candidate.key)
        )
        for claim in conclusion.claims
    }
