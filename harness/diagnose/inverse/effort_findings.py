"""Findings of efforts: their numbers, evidence, grades, and what else they could be."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from harness.diagnose.answer.findings import in_words
from harness.diagnose.claims.grades import ESTABLISHED, LIKELY, POSSIBLE
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_grades import estimates, grade, repeatability, without_each
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_words import InWords, gathered, untold_together
from harness.diagnose.inverse.force_over_position import of_any_shape
from harness.diagnose.problem.deadline import TimeUp
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.effect import SiteKind
from harness.system import System

UNREPEATED = ("whether what was found repeats in every recording", "grades may be too low")
UNREDUCED = (
    "fits without each effect that is told",
    "what stands in their place says that effects are surer than they are",
)
UNRIVALLED = (
    "what else could stand in the place of each effect claimed",
    "more effects may be as likely as those told",
)


@dataclass(frozen=True, eq=False)
class EffortFindings:
    """Findings as the document has them; those more than possible in words, and what these cannot be told from; effects that cannot
    be told apart, in pairs; titles of those that a force over their joint's position does for as well."""

    rows: Sequence[dict[str, Any]]
    titles: Sequence[str]
    rivals: Sequence[str]
    pairs: Sequence[tuple[Candidate, Candidate]]
    of_any_shape: Sequence[str] = ()


def effort_findings(
    system: System, study: EffortStudy, best: EffortFit, *, remainder: bool, doubtful: Collection[str] = ()
) -> EffortFindings:
    """All findings of a set.

    remainder: whether more than noise is left beside it. doubtful: keys of members that are no more than possible.
    """
    deadline = study.data.model.deadline
    weights = {key: study.criterion(f) for key, f in study.fits.items()}
    lowest = min(weights.values())
    share = {key: float(np.exp(-0.5 * (w - lowest))) for key, w in weights.items()}
    total = sum(share.values())
    findings, firm, pairs = [], list[InWords](), list[tuple[Candidate, Candidate]]()
    members = range(len(best.hypothesis.members))
    # What every finding needs comes before what it may do without, which takes what time there is.
    without = [
        deadline.attempt(*UNREDUCED, partial(study.reduce, best, k), partial(study.seen_without, best, k))
        for k in members
    ]
    apart = [study.heldout_z(without[k], best) for k in members]
    grades = [grade(study, best, k, without[k], [], rivals=None, remainder=remainder) for k in members]
    shapeless: frozenset[int] = deadline.attempt(*UNRIVALLED, lambda: of_any_shape(study, best), frozenset)
    again: list[tuple[str, EffortFit]] = deadline.attempt(
        *UNREPEATED, lambda: without_each((study.data, study.held), best), lambda: []
    )
    for k, member in enumerate(best.hypothesis.members):
        values, units = estimates(best, study.nominal, k), _units(system, member)
        smaller = without[k]
        alike: list[tuple[Candidate, EffortFit]] | None = deadline.attempt(
            *UNRIVALLED, partial(study.rivals, best, k), lambda: None
        )
        others = [c for c, _ in alike or ()]
        names = [c.effect.name if c.site == member.site else c.key for c in others]
        repeats = repeatability(again, study.nominal, k)
        rivals = None if alike is None else bool(names)
        with suppress(TimeUp):
            grades[k] = grade(study, best, k, smaller, repeats, rivals=rivals, remainder=remainder)
        # What the time was up for might have found something in its place.
        how = LIKELY if deadline.not_tried and grades[k] == ESTABLISHED else grades[k]
        how = grades[k] = POSSIBLE if k in shapeless or member.key in doubtful else how
        probability = sum(s for key, s in share.items() if member.key in key) / total
        findings.append(
            {
                "effect": member.effect.name,
                "site": member.site,
                "parameters": {name: e.document(units[name]) for name, e in values.items()},
                "evidence": {
                    "delta_bic": study.criterion(smaller) - study.criterion(best), "probability": probability,
                    "heldout_sigma": apart[k],
                },
                "indistinguishable_from": names,
                "grade": how,
                "repeatability": repeats,
            }
        )  # fmt: skip
        if how != POSSIBLE:
            firm.append(InWords(member.effect.title, member.site, values, units, tuple(map(in_words, names))))
        pairs += [(member, c) for c in others]
    order = {name: k for k, name in enumerate(system.joint_names)}
    firm.sort(key=lambda f: order.get(f.site.split(".")[0], len(order)))
    shaped = [f"{m.effect.title} at {m.site}" for k, m in enumerate(best.hypothesis.members) if k in shapeless]
    return EffortFindings(findings, gathered(firm), untold_together(firm), pairs, shaped)


def _units(system: System, member: Candidate) -> dict[str, str]:
    """Units of a member's parameters."""
    joint = (
        system.joint(member.site.split(".")[0]) if member.effect.site in (SiteKind.JOINT, SiteKind.CHANNEL) else None
    )
    units = member.effect.units(
        prismatic=joint is not None and joint.prismatic, channel_unit=joint.position_unit if joint else "rad"
    )
    return dict(zip(member.effect.parameter_names, units, strict=True))
