"""The augmented model: the nominal one with its quantities refitted and what was found attached to it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.diagnose.hypothesis import Array, Candidate, Nominal, scaled
from harness.diagnose.uncertainty import Estimate
from harness.effects.room import STATED
from harness.system import Attachment, System


def augmented(
    system: System,
    nominal: Sequence[Nominal],
    deviations: Array,
    found: Iterable[tuple[Candidate, Mapping[str, Estimate]]],
) -> System:
    """The system with its nominal quantities as fitted and the findings attached, with their standard deviations.

    deviations: (number of nominal,) fitted, in standard deviations of the tolerance. found: each effect with its parameters [SI].
    """
    system = scaled(system, nominal, list(np.exp(system.tolerance * deviations)))
    attachments = []
    # What modifies another effect stands behind it, as a reader expects.
    for candidate, parameters in sorted(found, key=lambda pair: bool(pair[0].effect.modifies)):
        attachment = Attachment(
            candidate.effect.name,
            candidate.site,
            {name: estimate.value for name, estimate in parameters.items()},
            {name: estimate.std for name, estimate in parameters.items() if estimate.std is not None},
        )
        less = less_than_stated(system, attachment)
        if less is None:
            attachments.append(attachment)
        else:
            system = less
    return replace(system, attachments=(*system.attachments, *attachments))


def less_than_stated(system: System, attachment: Attachment) -> System | None:
    """The system with less damping or dry friction than its joint states, if that is what the attachment says.

    Less than the model states is no effect to attach, but another number in the model.
    """
    field = STATED.get(attachment.effect)
    if field is None:
        return None
    value = next(iter(attachment.parameters.values()))
    if value >= 0.0:
        return None
    joint = system.joint(attachment.site)
    return system.replace_joint(replace(joint, **{field: max(getattr(joint, field) + value, 0.0)}))
