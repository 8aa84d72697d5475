"""Which set of laws recordings speak for where every one of them leaves a force out.

Sets are weighed with the force that they leave integrated out, as a function of the state (``estimation.state_force``), and of
those that are not parted so the plainest is taken: what nobody would look for first needs evidence of its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from harness.diagnose.estimation.beside_state_force import Beside, along_the_recordings, beside
from harness.diagnose.estimation.effective_samples import hanging_together
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.objective import LOST
from harness.diagnose.estimation.state_force import StateForce
from harness.diagnose.problem.hypothesis import EVERYWHERE, Candidate
from harness.diagnose.selection.scans.catalogue import scanned
from harness.diagnose.selection.study import Study
from harness.effects.scale import pull

UNPARTED = 10.0  # twice the logarithm of the odds, below which sets cannot be told apart (Kass and Raftery, JASA 90 (1995) 773)


@dataclass(frozen=True, eq=False)
class Evidence:
    """What recordings say of sets with the force that these leave integrated out. rough: noise as the channels scatter."""

    force: StateForce
    rough: Likelihood

    def beside(self, study: Study, fitted: Fit) -> Beside:
        """A set and the force that it leaves out, together; however the set was weighed for the fit that this begins at."""
        key = fitted.hypothesis.identity, fitted.windows
        if key not in self.force.known:
            self.force.known[key] = _beside(self.force, study, self.rough, fitted)
        found: Beside = self.force.known[key]
        return found

    def criterion(self, study: Study, fitted: Fit) -> float:
        """−2 log of how likely the recordings are under a set, the price of its numbers, and how plausible they and its members
        are; infinite of a fit that has lost the recordings.

        Every joint rubs or is damped as a rule; of other plain laws about one is expected to be missing, and one of all the rest.
        """
        if fitted.score >= LOST:
            return np.inf
        found = self.beside(study, fitted)
        prior = study.paid(fitted) + study.surprise(replace(fitted, x=found.x))
        return found.surprise + prior + sum(_odds(study, m) for m in fitted.hypothesis.members)


def _beside(force: StateForce, study: Study, rough: Likelihood, fitted: Fit) -> Beside:
    return beside(force, study.objective_under(rough, fitted), fitted, study.whole(fitted.hypothesis))


def evidence_over_the_state(study: Study, rough: Likelihood, along: Fit, reference: Fit) -> Evidence | None:
    """The measure for sets of a study; None where channels do not answer linearly to forces.

    along: the fit that is nearest to the recordings; forces act along its motion with what it leaves out made up for.
    reference: the plainest explanation; a test is calibrated by what it holds to be true.
    """
    if reference.score >= LOST:
        return None
    held, torque = study.whole(along.hypothesis), pull(study.problem.system)
    force = along_the_recordings(study.objective_under(rough, along), along, held, torque, study.swing)
    if force is None:
        return None
    usual = _beside(force, study, rough, reference)
    force.together = np.maximum(hanging_together([r.reshape(force.channels, -1) for r in usual.residuals]), 1.0)
    force.shape = usual.shape
    return Evidence(force, rough)


def placed(member: Candidate) -> bool:
    """Whether an effect was chosen among many places: numbers of periods, frequencies, angles."""
    return scanned(member) or "phase" in member.effect.parameter_names


def without_placed(study: Study, fitted: Fit) -> Fit:
    """The fit without what was chosen among many places: beside a force over the state such a law is a piece of that force.

    One of the places always fits some of what any force does, and recordings of one rig repeat that.
    """
    while any(map(placed, fitted.hypothesis.members)):
        fitted = study.reduce(fitted, [placed(member) for member in fitted.hypothesis.members].index(True))
    return fitted


def plainest(weighed: Iterable[tuple[float, Fit]]) -> Fit:
    """Of fits that are not parted from the best one by their criteria, the one that leaves least with the fewest curious laws.

    Laws that are no plain ones can be bent to what nobody has named. Of plain laws and an unknown force that do as well, the laws
    say more.
    """
    rows = list(weighed)
    lowest = min(value for value, _ in rows)
    alike = [(value, fitted) for value, fitted in rows if value < lowest + UNPARTED]
    return min(alike, key=lambda row: (curious(row[1]), row[1].cost))[1]


def _odds(study: Study, member: Candidate) -> float:
    """Twice the logarithm of the odds against a member, before anything is recorded."""
    if member.effect.name in EVERYWHERE:
        return 2.0 * float(np.log(2.0))
    alike = sum(candidate.effect.plain == member.effect.plain for candidate in study.candidates)
    return 2.0 * (float(np.log(max(alike, 2))) + member.effect.rarity)


def curious(fitted: Fit) -> int:
    """How many members are no plain laws."""
    return sum(not member.effect.plain for member in fitted.hypothesis.members)
