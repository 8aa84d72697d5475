"""What tells that efforts were held from each sample to the next, whatever is fitted: a set without lateness, and a quality note.

How an effort was logged is a convention and no physics that a model left out, so it is no effect. To a mechanism a held effort is a
smooth one that is half an interval late, in every drive alike.
"""

from __future__ import annotations

from harness.diagnose.problem.hypothesis import Hypothesis
from harness.effects.catalogue import catalogue
from harness.recording.recording import QualityNote, Recording

LATE = "actuator_delay"


def late(hypothesis: Hypothesis) -> bool:
    """Whether a set has something in it that acts late or is read late."""
    kin = {LATE, *catalogue()[LATE].confusable_with}
    return any(member.effect.name in kin for member in hypothesis.members)


def held_notes(recording: Recording) -> list[QualityNote]:
    """What is told of every effort of a recording that was found to be held."""
    return [
        QualityNote(
            "held_effort",
            effort.column or effort.name,
            "acts from each sample to the next, as a controller's command does, or half an interval late",
            "taken as held",
            len(recording.time),
            size=0.5 * recording.interval,
        )
        for effort in recording.efforts
    ]
