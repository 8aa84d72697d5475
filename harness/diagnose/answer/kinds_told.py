"""What is certain of a kind where no law of it is: that something takes energy at a joint, whichever law that is.

Beside a force that nobody has named, recordings of a real rig often leave dry friction, drag and damping about as likely as one
another, and all sets without any of them far behind.
"""

from __future__ import annotations

from collections.abc import Collection

from harness.diagnose.claims.constants import SURE_PROBABILITY
from harness.diagnose.claims.posterior import weighed
from harness.diagnose.selection.outcome import Outcome
from harness.effects.effect import Family


def certain_dissipation(outcome: Outcome, told: Collection[str]) -> str:
    """A sentence on joints whose dissipation is certain to be another one than modelled; none without such a joint.

    told: joints whose dissipation is told by a law already. By the sets that have been looked at beside the force that is left out.
    """
    if outcome.evidence is None:
        return ""
    sets = weighed(outcome, at_hand=True)
    sites = [
        (share, {m.site for m in fitted.hypothesis.members if m.effect.family is Family.DISSIPATION})
        for share, fitted in sets
    ]
    joints = [
        name
        for name in outcome.problem.system.joint_names
        if name not in told and sum(share for share, own in sites if name in own) >= SURE_PROBABILITY
    ]
    if not joints:
        return ""
    where = " and ".join(joints)
    return (
        f"That what brakes {where} is not as modelled is certain; whether it is dry friction, drag or damping is not."
    )
