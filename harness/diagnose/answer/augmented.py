"""The augmented model: the nominal one with its quantities refitted and what was found attached to it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.problem.hypothesis import Array, Candidate, Nominal, bent_by, scaled
from harness.effects.attach import apply
from harness.effects.catalogue import understood
from harness.effects.room import STATED
from harness.system import Attachment, System


def augmented(
    system: System,
    nominal: Sequence[Nominal],
    x: Array,
    found: Iterable[tuple[Candidate, Mapping[str, Estimate]]],
) -> System:
    """The system with its nominal quantities as fitted and the findings attached, with their standard deviations.

    x: parameter vector, the nominal quantities' deviations first [standard deviations of the tolerance]. found: each effect with
    its parameters [SI].
    """
    bent = scaled(system, nominal, list(bent_by(nominal, x[: len(nominal)])))
    # What modifies another effect stands behind it, as a reader expects.
    return attached(
        bent,
        [
            Attachment(
                candidate.effect.name,
                candidate.site,
                {name: estimate.value for name, estimate in parameters.items()},
                {name: estimate.std for name, estimate in parameters.items() if estimate.std is not None},
            )
            for candidate, parameters in sorted(found, key=lambda pair: bool(pair[0].effect.modifies))
        ],
    )


def attached(system: System, further: Iterable[Attachment]) -> System:
    """The system with further attachments; what takes away from stated dissipation is another number in the model instead."""
    own = []
    for attachment in further:
        law = understood().get(attachment.effect)
        if law is not None and law.of_servo:
            # A file names no servo whose gain could be changed: its spring and damper are numbers of the joint's.
            system = apply(system, attachment)
            continue
        less = _less_than_stated(system, attachment)
        if less is None:
            own.append(attachment)
        else:
            system = less
    return replace(system, attachments=(*system.attachments, *own))


def _less_than_stated(system: System, attachment: Attachment) -> System | None:
    """The system with less damping or dry friction than its joint states, if that is what the attachment says."""
    field = STATED.get(attachment.effect)
    if field is None:
        return None
    value = next(iter(attachment.parameters.values()))
    if value >= 0.0:
        return None
    gimbal = next((g for g in system.gimbals if g.name == attachment.site), None)
    if gimbal is not None:
        less = replace(gimbal, **{field: max(getattr(gimbal, field) + value, 0.0)})
        return replace(system, gimbals=tuple(less if g is gimbal else g for g in system.gimbals))
    joint = system.joint(attachment.site)
    return system.replace_joint(replace(joint, **{field: max(getattr(joint, field) + value, 0.0)}))
