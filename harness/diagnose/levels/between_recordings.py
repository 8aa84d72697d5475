"""By how much friction differs between recordings, beside a set of laws and the force over the state that all of them share.

Bearings warm up and grease moves, so that the same laws do not return to the digit. Beside the set that is told and its force, each
recording may have more or less dry and viscous friction at every joint: random effects, normal, of a size that is at its likeliest.
That is told, and has no part in choosing laws: with it in the evidence of every set, a weight that was there was not told any more
from drops whose friction was the same, and as many wrong laws were told where friction differed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.diagnose.estimation.beside_state_force import looked_at
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.selection.outcome import Outcome


def between_recordings(outcome: Outcome, fitted: Fit) -> Mapping[str, float]:
    """Standard deviation between recordings of dry friction, as of viscous friction at a typical speed (RMS), by joint [N·m or N].

    Empty where recordings need no friction of their own: twice the log-likelihood over none is below what parts sets of laws.
    """
    evidence = outcome.evidence
    if evidence is None:
        return {}
    study = outcome.study
    found = evidence.beside(study, fitted)
    if found.shape is None or found.nodes is None:
        return {}
    there = replace(fitted, x=found.x, states=found.states)
    force = evidence.force.with_levels(found.predictor, evidence.rough, there)
    if force is None:
        return {}
    objective, held = study.objective_under(evidence.rough, fitted), study.whole(fitted.hypothesis)
    # Runs with the force of all recordings, seen again as they answer to what each may have by itself.
    nodes = np.concatenate([found.nodes, np.zeros(len(force.joint) - len(found.nodes))])
    point = looked_at(evidence.force, objective, found.nodes, found.x, found.states, held)
    sums = replace(point, nodes=nodes).sums(force)
    shape = replace(found.shape, sizes=np.concatenate([found.shape.sizes, force.usual[force.joints :]]))
    with_own, without = (force.likeliest(sums, shape, levels=levels) for levels in (True, False))
    if without.value - with_own.value < UNPARTED_EVIDENCE:
        return {}
    sizes = with_own.force.sizes[force.joints :] * force.torque
    return {name: float(size) for name, size in zip(force.names, sizes, strict=True)}
