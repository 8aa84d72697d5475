"""The next experiment: rivals are simulated in experiments one could do, and the one that parts them best is proposed.

A rival keeps its initial state free, and its parameters as far as the recordings at hand leave them open. A motion so sensitive
that a hypothesis would not find back to itself is not proposed, nor a release from farther away. A law that contains the other as
a special case predicts whatever that does for the little that it cost, so no motion parts the two: what to measure directly is
said.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.experiment.constants import (
    PARTED_SIGMAS,
    PLAINLY_PARTED_SIGMAS,
    SPEED_STEPS_A_SWING,
    USUAL_AMPLITUDE,
)
from harness.diagnose.experiment.separation import separation
from harness.diagnose.experiment.trials import Trial, directly, trials
from harness.diagnose.problem.hypothesis import contains
from harness.diagnose.selection.study import Study
from harness.system import System


@dataclass(frozen=True)
class Proposal:
    """An experiment in words, the effects it parts, and by how many standard deviations of noise.

    Beyond ``PLAINLY_PARTED_SIGMAS``, by at least so many.
    """

    what: str
    separates: tuple[str, ...]
    separation: float


def propose(study: Study, pairs: list[tuple[Fit, Fit, tuple[str, ...]]]) -> Proposal | None:
    """The first experiment that plainly parts the first pair of rivals that any can part, or the one that parts it best; None
    without rivals.

    pairs: fits of rival hypotheses, and the names of the effects they disagree on.
    """
    if not pairs:
        return None
    best: Proposal | None = None
    for first, second, names in pairs:
        at_most = _at_most(first, second)
        if at_most < PARTED_SIGMAS:
            if best is None or at_most > best.separation:
                best = Proposal("", names, at_most)
            continue
        sensitive: dict[str, float] = {}
        for trial in _considered(study, first, second):
            # What is let go from farther away moves more wildly still.
            if trial.far and trial.far >= sensitive.get(trial.site, np.inf):
                continue
            size = separation(
                study, first, second, trial, 0.0 if best is None else best.separation, PLAINLY_PARTED_SIGMAS
            )
            if np.isnan(size):
                size = 0.0
                if trial.far:
                    sensitive[trial.site] = trial.far
            if best is None or size > best.separation:
                best = Proposal(trial.what, names, size)
            if size > PLAINLY_PARTED_SIGMAS:
                break
        if best is not None and best.separation >= PARTED_SIGMAS:
            return best
    if best is None:
        # Nothing can be let go or driven where no joint moves.
        best = Proposal("", pairs[0][2], 0.0)
    if best.separation < PARTED_SIGMAS:
        families = {m.effect.name: m.effect.family for pair in pairs for f in pair[:2] for m in f.hypothesis.members}
        return Proposal(
            "none of the releases, drives and further sensors considered would part them: "
            + directly(families[name] for name in best.separates),
            best.separates,
            best.separation,
        )
    return best


def _at_most(first: Fit, second: Fit) -> float:
    """By how many standard deviations any experiment could part two hypotheses, where the second one's law can be the first one's.

    It then predicts what that one does, for what that cost it in the recordings at hand. Infinite where it cannot be.
    """
    special = [m for m in first.hypothesis.members if m.key not in second.hypothesis.identity]
    wider = [m for m in second.hypothesis.members if m.key not in first.hypothesis.identity]
    if len(special) != 1 or len(wider) != 1 or not contains(wider[0], special[0]):
        return np.inf
    return float(np.sqrt(max(first.score - second.score, 0.0)))


def _considered(study: Study, first: Fit, second: Fit) -> list[Trial]:
    """Trials with the first joint, which moves everything, and with the one where two hypotheses disagree."""
    system = study.problem.system
    duration = float(max(run.duration for run in study.problem.train))
    if system.gimbals:
        return []  # how a body in space is let go is more than a position and a speed
    joints = dict.fromkeys([*system.joint_names[:1], *_disputed(system, first, second)])
    dependent = study.predictor.mechanism(first.hypothesis).model.dependent
    if dependent:
        # Where a closed mechanism is let go is told by those that lead.
        joints = dict.fromkeys(name for name in system.joint_names if name not in dependent)
    return [
        trial for joint in joints for trial in trials(system, joint, duration, study.swing, *_extents(study, joint))
    ]


def _disputed(system: System, first: Fit, second: Fit) -> list[str]:
    """Joints at which, or at whose links, effects sit that only one of two hypotheses has."""
    carried_by = {joint.child: joint.name for joint in system.movable_joints}
    members = {m.key: m for fitted in (first, second) for m in fitted.hypothesis.members}
    owners = [
        members[key].site.rsplit(".", 1)[0] for key in sorted(first.hypothesis.identity ^ second.hypothesis.identity)
    ]
    joints = [carried_by.get(owner, owner) for owner in owners]
    return [joint for joint in joints if joint in system.joint_names]


def _extents(study: Study, joint: str) -> tuple[float, float]:
    """How far and how fast a joint moves in the recordings; by typical ones where its position is not measured."""
    row = study.problem.position_of(joint)
    far, fast = [], []
    for run in study.problem.train if row is not None else ():
        apart = max(1, round(study.swing / SPEED_STEPS_A_SWING / run.interval))
        values = run.values[row]
        if len(values) <= apart:
            continue
        far.append(np.nanmax(np.abs(values), initial=0.0))
        fast.append(np.nanmax(np.abs(values[apart:] - values[:-apart]), initial=0.0) / (apart * run.interval))
    extent = float(max(far, default=0.0)) or USUAL_AMPLITUDE
    return extent, float(max(fast, default=0.0)) or 2.0 * np.pi * extent / study.swing
