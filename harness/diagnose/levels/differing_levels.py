"""What a diagnosis says of friction that differs from recording to recording, where recordings ask for it.

The laws that the diagnosis claims, or finds likeliest where it doubts friction, are fitted once more with a level of one kind of
friction, dry or viscous, for every training recording (``levels.levels``), if that was not equal at a chance that leaves no doubt
(``levels.unequal_friction``). Where both kinds might do it, that is told which leaves less.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import chi2

from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.rivals import ranking
from harness.diagnose.criticism.constants import TEST_CHANCE
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.levels.constants import FURTHEST_LEVEL, LEAST_DIFFERENCE, RANKED_HYPOTHESES, TIED_SPREAD
from harness.diagnose.levels.kinds import KINDS, Kind
from harness.diagnose.levels.levels import LevelFit, fit_levels, free_run_error, labels
from harness.diagnose.levels.unequal_friction import Unequal, rubbing, unequal_friction
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.outcome import Outcome
from harness.effects.room import STATED
from harness.recording.recording import Recording
from harness.system import Attachment, System

HOW = (
    "Laws and levels are fitted to the training recordings alone, with one level for all (shared) or one each (levelled). What is "
    "held out is predicted with the last training recording's level, its initial state fitted. That levels differ was judged on "
    "all recordings."
)


@dataclass(frozen=True, eq=False)
class Differing:
    """Levels of friction that differ: for programs, in a sentence, and the model at the last training recording's level."""

    document: Mapping[str, Any]
    sentence: str
    system: System


def differing_levels(
    outcome: Outcome, conclusion: Conclusion, train: Sequence[Recording], heldout: Sequence[Recording]
) -> Differing | None:
    """Levels of friction of the training recordings, or None where one level for all is enough or none can be told.

    train, heldout: the recordings behind the problem's runs.
    """
    if not comparable(outcome.problem):
        return None
    found = [of_kind for kind in KINDS if (of_kind := _of_kind(outcome, conclusion, kind, train)) is not None]
    if not found:
        return None
    kind, fitted, asked, shared, levelled = min(found, key=lambda of_kind: of_kind[-1].cost)
    anew = [_anew(outcome, fitted, k) for k in range(len(outcome.problem.runs))]
    rows: list[dict[str, Any]] = [
        {
            "recording": name, "held_out": False, "factor": levelled.levels[name], "std": levelled.level_std[name],
            "shared_rmse": shared.rmse[name], "levelled_rmse": levelled.rmse[name],
        }
        for name in labels(train)
    ]  # fmt: skip
    for recording, breaks in zip(heldout, anew[len(train) :], strict=True):
        before, after = (free_run_error(one.system, recording, anew=breaks) for one in (shared, levelled))
        rows.append(
            {
                "recording": recording.name, "held_out": True, "factor": None, "std": None,
                "shared_rmse": before, "levelled_rmse": after,
            }
        )  # fmt: skip
    document = {
        "kind": kind.name,
        "joints": list(rubbing(outcome.study, fitted, kind)),
        "chance": asked.chance,
        "recordings": rows,
        "laws": [_law(attachment) for attachment in levelled.system.attachments],
        "how": HOW,
    }
    return Differing(document, _sentence(kind, asked, rows), levelled.system)


def _of_kind(
    outcome: Outcome, conclusion: Conclusion, kind: Kind, train: Sequence[Recording]
) -> tuple[Kind, Fit, Unequal, LevelFit, LevelFit] | None:
    """A set and what recordings ask of its friction of a kind, and the set refitted with one level and with one each; None where
    one is enough or none can be told."""
    study, deadline = outcome.study, outcome.predictor.deadline
    fitted = next((f for f in _shortlist(outcome, conclusion, kind) if rubbing(study, f, kind)), None)
    if fitted is None or not _can_be_levelled(fitted):
        return None
    asked = unequal_friction(study, fitted, kind)
    if asked is None or asked.chance > TEST_CHANCE or float(np.ptp(asked.levels)) < LEAST_DIFFERENCE:
        return None
    if float(np.max(np.abs(np.log(asked.levels)))) > FURTHEST_LEVEL - 1e-9:
        return None  # so much more or less is asked of what hardly acts, for want of something else
    start, anew = _start(outcome, fitted), [_anew(outcome, fitted, k) for k in range(len(train))]
    shared = fit_levels(start, train, kind=kind, spread=TIED_SPREAD, anew=anew, deadline=deadline)
    levelled = fit_levels(shared.system, train, kind=kind, anew=anew, deadline=deadline)
    return None if _equal(levelled) else (kind, fitted, asked, shared, levelled)


def comparable(problem: Problem) -> bool:
    """Whether the recordings are such that their friction can be compared: several free swings with every joint measured."""
    measured = {c.site for c in problem.channels if c.quantity == "position"}
    if problem.driven or problem.system.flexible or problem.same_recording or len(problem.train) < 2:
        return False
    if any(run.payload for run in problem.runs) or problem.system.loops or problem.system.gimbals:
        return False
    return measured.issuperset(problem.system.joint_names)


def _shortlist(outcome: Outcome, conclusion: Conclusion, kind: Kind) -> list[Fit]:
    """Sets whose friction of a kind may differ, the claimed one first, unless such friction of the likeliest one is doubted."""
    first = [conclusion.best, outcome.best]
    if any(key.partition("@")[0] in kind.laws for key in conclusion.doubted):
        # Friction that differs leaves a remainder, and the remainder is why friction is doubted.
        first.reverse()
    return [*first, *ranking(outcome, conclusion.best, RANKED_HYPOTHESES)]


def _can_be_levelled(fitted: Fit) -> bool:
    """Whether every member is a law of a joint, a change of the rigid mechanism or a sensor without a clock."""
    for member in fitted.hypothesis.members:
        effect = member.effect
        dated = effect.law is not None and effect.law.sideways
        clock = effect.sensor is not None and effect.sensor.every_channel
        if effect.adds_coordinates or dated or clock or effect.user is not None or effect.input is not None:
            return False
    return True


def _start(outcome: Outcome, fitted: Fit) -> System:
    """The nominal system with the members attached; where a member takes away what the model states, only the sum is."""
    system = outcome.problem.system
    attachments = []
    for k, member in enumerate(fitted.hypothesis.members):
        values = member.effect.named(outcome.predictor.effect_values(fitted.hypothesis, k, fitted.x))
        field = STATED.get(member.effect.name)
        if field is not None:
            joint = system.joint(member.site)
            (name, value), *_ = values.items()
            none: dict[str, Any] = {field: 0.0}
            system = system.replace_joint(replace(joint, **none))
            if getattr(joint, field) + value <= 0.0:
                continue
            values = {name: getattr(joint, field) + value}
        attachments.append(Attachment(member.effect.name, member.site, values))
    return replace(system, attachments=(*system.attachments, *attachments))


def _anew(outcome: Outcome, fitted: Fit, k: int) -> list[float]:
    """Times [s] from the first sample at which windows of recording k begin, but for the first."""
    time = outcome.problem.runs[k].time
    return [float(time[w.first] - time[0]) for w in fitted.windows if w.run == k and w.first > 0]


def _equal(found: LevelFit) -> bool:
    """Whether levels of a fit are all one within their own uncertainty, or too near to it to matter."""
    factors = np.array(list(found.levels.values())[:-1])
    std = np.array(list(found.level_std.values())[:-1])
    if not np.all(std > 0.0):
        return True
    square = float(np.sum(((factors - 1.0) / std) ** 2))
    return float(chi2.sf(square, len(factors))) > TEST_CHANCE or float(np.ptp([*factors, 1.0])) < LEAST_DIFFERENCE


def _law(attachment: Attachment) -> dict[str, Any]:
    return {
        "effect": attachment.effect,
        "site": attachment.site,
        "parameters": {k: {"value": v, "std": attachment.std.get(k)} for k, v in attachment.parameters.items()},
    }


def _sentence(kind: Kind, asked: Unequal, rows: Sequence[Mapping[str, Any]]) -> str:
    factors = ", ".join(f"{row['factor']:.3g}" for row in rows if not row["held_out"])
    return (
        f"{kind.name.capitalize()} differs from recording to recording beyond what one law for all explains (chance "
        f"{asked.chance:.1g}): in the training recordings it is {factors} times that of the last one."
    )
