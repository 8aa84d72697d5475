"""By how much friction and efforts differ between recordings, beside a set of laws and the force over the state that all share.

Bearings warm up, grease moves and drives lose torque, so that the same laws do not return to the digit. Beside the set that is told
and its force, each recording may have more or less dry and viscous friction at every joint, and of every effort that was recorded:
random effects, normal, of a size that is at its likeliest. That is told, and has no part in choosing laws: with it in the evidence
of every set, a weight that was there was not told any more from drops whose friction was the same, and as many wrong laws were told
where friction differed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from harness.diagnose.estimation.beside_state_force import looked_at
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.state_force import Level, Likeliest
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.selection.outcome import Outcome


@dataclass(frozen=True)
class Between:
    """Standard deviations between recordings, by joint; empty where recordings need nothing of their own.

    friction: of dry friction, and as of viscous friction at a typical speed (RMS) [N·m or N]; gain: of efforts, as a share.
    """

    friction: Mapping[str, float] = field(default_factory=dict)
    gain: Mapping[str, float] = field(default_factory=dict)


def between_recordings(outcome: Outcome, fitted: Fit) -> Between:
    """What differs between recordings: twice the log-likelihood over nothing, or over the other kind alone, parts sets of laws."""
    evidence = outcome.evidence
    if evidence is None:
        return Between()
    study = outcome.study
    found = evidence.beside(study, fitted)
    if found.shape is None or found.nodes is None:
        return Between()
    there = replace(fitted, x=found.x, states=found.states)
    force = evidence.force.with_levels(found.predictor, evidence.rough, there)
    if force is None or force.level is None:
        return Between()
    objective, held = study.objective_under(evidence.rough, fitted), study.whole(fitted.hypothesis)
    # Runs with the force of all recordings, seen again as they answer to what each may have by itself.
    nodes = np.concatenate([found.nodes, np.zeros(len(force.joint) - len(found.nodes))])
    point = looked_at(evidence.force, objective, found.nodes, found.x, found.states, held)
    sums = replace(point, nodes=nodes).sums(force)
    shape = replace(found.shape, sizes=np.concatenate([found.shape.sizes, force.usual[force.joints :]]))
    kinds = [kind for kind in Level if kind in force.level]
    weighed: dict[tuple[Level, ...], Likeliest] = {
        own: force.likeliest(sums, shape, levels=own) for own in {(), *((kind,) for kind in kinds), tuple(kinds)}
    }
    told = tuple(kinds)
    while told:
        # Without the kind that is missed least.
        fewer = min(((*told[:k], *told[k + 1 :]) for k in range(len(told))), key=lambda own: weighed[own].value)
        if weighed[fewer].value - weighed[told].value >= UNPARTED_EVIDENCE:
            break
        told = fewer
    sizes = weighed[told].force.sizes.reshape(-1, force.joints)
    recorded = {
        kind: [j for j in range(force.joints) if np.any((force.level == kind) & (force.joint == j))] for kind in told
    }

    def of(kind: Level, unit: float) -> dict[str, float]:
        return {force.names[j]: float(unit * sizes[kind, j]) for j in recorded.get(kind, [])}

    return Between(of(Level.FRICTION, force.torque), of(Level.GAIN, 1.0))
