"""What is told of the force that the augmented model still leaves out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.criticism.left_force import Place, left_force, place_of
from harness.diagnose.levels.between_recordings import Between
from harness.diagnose.selection.outcome import Outcome
from harness.effects.scale import references


@dataclass(frozen=True)
class AtJoint:
    """The force left out at one joint: standard deviation, its unit, its share of the natural force there, its memory [s].

    between, gain: standard deviation between recordings of friction there, and of the effort as a share of it; 0 where they need
    none of their own. fleeting: whether it keeps for no longer than could be told.
    """

    joint: str
    size: float
    unit: str
    share: float
    memory: float
    between: float = 0.0
    gain: float = 0.0
    fleeting: bool = False


@dataclass(frozen=True)
class LeftOut:
    """The force left out at every joint, and the one place where most of it lies."""

    joints: tuple[AtJoint, ...]
    place: Place | None

    @property
    def largest(self) -> AtJoint:
        """Where it is largest against the natural force of its joint."""
        return max(self.joints, key=lambda one: one.share)

    def document(self) -> list[dict[str, Any]]:
        """As plain data, a row a joint."""
        rows: list[dict[str, Any]] = []
        for one in self.joints:
            row: dict[str, Any] = {
                "joint": one.joint, "size": one.size, "unit": one.unit, "share": one.share, "memory": one.memory
            }  # fmt: skip
            if one.between > 0.0:
                row["between_recordings"] = one.between
            if one.gain > 0.0:
                row["effort_gain_between_recordings"] = one.gain
            if self.place is not None and self.place.joint == one.joint:
                row["place"] = {"where": self.place.where, "share": self.place.share, "of_time": self.place.of_time}
            rows.append(row)
        return rows


def left_out(outcome: Outcome, conclusion: Conclusion, between: Between) -> LeftOut | None:
    """The force that the best set leaves out; None where noise is all that is left.

    between: what differs between recordings.
    """
    force = outcome.force
    if force is None:
        return None
    rows = []
    for joint, size in zip(force.joints, force.sizes, strict=True):
        unit = outcome.problem.system.joint(joint).force_unit
        natural = references(outcome.problem.system, joint).torque
        friction, gain = (of.get(joint, 0.0) for of in (between.friction, between.gain))
        rows.append(AtJoint(joint, size, unit, size / natural, force.memory, friction, gain, force.fleeting))
    problem = outcome.problem
    left = left_force(outcome, conclusion.best, force)
    return LeftOut(tuple(rows), place_of(problem.system, [run.name for run in problem.runs], left))


def explained_share(rows: Sequence[Mapping[str, Any]]) -> float | None:
    """Share of the nominal model's mean-square mismatch on data held out that the augmented model removes.

    rows: of ``fit``, a row a channel; channels are weighed by their noise. None where the nominal model leaves nothing.
    """
    before, after = (
        float(np.sum([(row[which]["heldout_rmse"] / row["noise_floor"]) ** 2 for row in rows]))
        for which in ("nominal", "augmented")
    )
    if not np.isfinite(before) or not np.isfinite(after) or before <= 0.0:
        return None
    return 1.0 - after / before
