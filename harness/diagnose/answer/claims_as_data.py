"""What is claimed as plain data: findings with their numbers, their grades and what they cannot be told from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from harness.diagnose.answer.findings import MODIFIED_BY
from harness.diagnose.answer.zeros import Zero
from harness.diagnose.claims.conclude import Claim, Conclusion
from harness.diagnose.claims.held_out_only import held_names
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.outcome import Outcome


def units_of(problem: Problem, member: Candidate) -> dict[str, str]:
    """Units of what an effect at its site has numbers for, by its parameters."""
    system = problem.system
    joints = {j.name: j.prismatic for j in system.joints} | {g.name: g.slides for g in system.gimbals}
    unit = next((c.unit for c in problem.channels if c.name == member.site), "")
    units = member.effect.units(prismatic=joints.get(member.site, False), channel_unit=unit)
    return dict(zip(member.effect.parameter_names, units, strict=True))


def finding_rows(
    outcome: Outcome, conclusion: Conclusion, values: dict[str, dict[str, Estimate]], zeros: dict[str, list[Zero]],
    grades: dict[str, str], again: dict[str, list[dict[str, Any]]],
) -> list[dict[str, Any]]:  # fmt: skip
    """What is claimed; effects that modify another one at their site are told with it."""
    own = [
        (
            c.candidate,
            {
                **_finding(outcome, c, values[c.candidate.key], zeros[c.candidate.key], conclusion.only_held),
                "grade": grades[c.candidate.key],
                **({"repeatability": again[c.candidate.key]} if again[c.candidate.key] else {}),
            },
        )
        for c in conclusion.claims
    ]
    whole = []
    for member, finding in own:
        kept = (f for c, f in own if c.site == member.site and c.effect.name in member.effect.modifies)
        modified = next(kept, None)
        if modified is None:
            whole.append(finding)
        else:
            modified.setdefault(MODIFIED_BY, []).append(finding)
    return whole


def _finding(
    outcome: Outcome, claim: Claim, values: dict[str, Estimate], zeros: list[Zero], only_held: Sequence[str]
) -> dict[str, Any]:
    units = units_of(outcome.problem, claim.candidate)
    return {
        "effect": claim.candidate.effect.name,
        "site": claim.candidate.site,
        "parameters": {name: e.document(units[name]) for name, e in values.items()},
        "evidence": {
            "delta_bic": claim.delta_bic,
            "probability": claim.probability,
            "class_probability": claim.of_class,
            "heldout_sigma": claim.heldout_z,
        },
        **rivals_as_data(claim),
        **({"zeros": zeros} if zeros else {}),
        **({"shows_only_in": held_names(outcome)} if claim.candidate.key in only_held else {}),
    }


def rivals_as_data(claim: Claim) -> dict[str, Any]:
    """What a claim cannot be told from, as it stands in its finding."""
    site = claim.candidate.site
    beside = {_short(key, site): list(partners) for key, partners in claim.beside.items()}
    told = [_short(rival.key, site) for rival in _plainest_first(claim)]
    return {"indistinguishable_from": told, **({"only_beside": beside} if beside else {})}


def _plainest_first(claim: Claim) -> list[Candidate]:
    """What a claim cannot be told from; where laws act alike, the plain one is met more often than its fit says."""
    return sorted(claim.rival_candidates, key=lambda rival: rival.effect.plainness)


def plainer_rivals(claim: Claim) -> list[Candidate]:
    """Rivals at the same place that are plainer than what is claimed, and could stand there by themselves."""
    own = claim.candidate
    return [
        rival
        for rival in _plainest_first(claim)
        if rival.site == own.site
        and rival.effect.side == own.effect.side
        and rival.key not in claim.beside
        and rival.effect.plainness < own.effect.plainness
    ]


def _short(key: str, site: str) -> str:
    """The effect's name alone where it sits at the same site, else with its own."""
    name, _, at = key.partition("@")
    return name if at == site else key
