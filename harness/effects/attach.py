"""Effects put into a system, and into the chain from the motion to the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from harness.effects.catalogue import effect
from harness.effects.effect import Effect
from harness.effects.room import with_room
from harness.errors import InputError
from harness.system import Attachment, Joint, System
from harness.system.closure import pins
from harness.system.suggest import did_you_mean

GAIN = "actuator_gain"  # what is left of a servo's gain once its feedback is in the description
# Laws that the description of a joint has fields for.
JOINT_FIELDS = ("viscous_damping", "coulomb_friction", "joint_stiffness")


def apply(system: System, attachment: Attachment) -> System:
    """The system with the effect in it; the given one is left as it is.

    What the description of a mechanism has a field for becomes that field (damping, friction, stiffness, armature, mass,
    gravity, beams, further bodies), beside what the model states of it; other joint and base laws, and effects of
    sensors and inputs, are kept as attachments.
    Raises InputError for an unknown effect or site, a parameter that is missing or outside physics, or a system that
    cannot have the effect.
    """
    law = effect(attachment.effect)
    check_site(law, system, attachment.site)
    law = with_room(law, system, attachment.site)
    values = law.named(law.values(attachment.parameters))
    if law.reshape is not None:
        changed = law.reshape.change(system, attachment.site, values)
        if not law.of_servo:
            return changed
        # Of what is commanded no field of the description says how much arrives.
        return replace(changed, attachments=(*changed.attachments, input_part(replace(attachment, parameters=values))))
    if law.name in JOINT_FIELDS and attachment.site not in [loop.name for loop in system.loops]:
        joint = system.joint(attachment.site)
        if joint not in system.joints:
            return _in_space(system, attachment.site, law.name, values)
        if law.name == "viscous_damping":
            return system.replace_joint(replace(joint, damping=joint.damping + values["coefficient"]))
        if law.name == "coulomb_friction":
            return system.replace_joint(replace(joint, friction=joint.friction + values["torque"]))
        return system.replace_joint(_beside_spring(joint, values["stiffness"], values["rest_angle"]))
    kept = tuple(a for a in system.attachments if (a.effect, a.site) != (attachment.effect, attachment.site))
    return replace(system, attachments=(*kept, replace(attachment, parameters=values)))


def input_part(attachment: Attachment) -> Attachment:
    """What is left to attach once the mechanism has its share: of a servo's gain, that of what is commanded."""
    return replace(attachment, effect=GAIN) if effect(attachment.effect).of_servo else attachment


def _in_space(system: System, site: str, law: str, values: Mapping[str, float]) -> System:
    """The system with damping or dry friction of joints that are one in space together."""
    field, value = ("damping", "coefficient") if law == "viscous_damping" else ("friction", "torque")
    more = (replace(g, **{field: getattr(g, field) + values[value]}) if g.name == site else g for g in system.gimbals)
    return replace(system, gimbals=tuple(more))


def _beside_spring(joint: Joint, stiffness: float, rest: float) -> Joint:
    """The joint with a second spring beside its own: stiffnesses add, the rest position is their weighted mean."""
    total = joint.stiffness + stiffness
    if total == 0.0:
        return joint
    mean = (joint.stiffness * joint.rest_position + stiffness * rest) / total
    return replace(joint, stiffness=total, rest_position=mean)


def compatible(attachments: Sequence[tuple[str, str]]) -> bool:
    """Whether (effect, site) pairs can stand together: none twice, none beside a simpler one that it contains."""
    if len(set(attachments)) != len(attachments):
        return False
    present = set(attachments)
    return not any((simpler, site) in present for name, site in attachments for simpler in effect(name).simpler)


def sensor_chain(attachments: Sequence[Attachment], channel: str) -> tuple[tuple[Effect, Attachment], ...]:
    """The sensor effects that act on a channel, in the order from the motion to the file."""
    acting = [(effect(a.effect), a) for a in attachments]
    chosen = [(e, a) for e, a in acting if e.sensor is not None and (e.sensor.every_channel or a.site == channel)]
    return tuple(sorted(chosen, key=lambda pair: pair[0].sensor.stage if pair[0].sensor else 0))


def input_chain(attachments: Sequence[Attachment], joint: str) -> tuple[tuple[Effect, Attachment], ...]:
    """The input effects that act on a joint's effort, in the order from the record to the joint."""
    acting = [(effect(a.effect), a) for a in attachments]
    chosen = [(e, a) for e, a in acting if e.input is not None and a.site == joint]
    return tuple(sorted(chosen, key=lambda pair: pair[0].input.stage if pair[0].input else 0))


def check_site(law: Effect, system: System, site: str) -> None:
    """InputError where a system has no such joint, loop, link or base; sites of sensors are not looked at."""
    known: tuple[str, ...]
    if law.site == "joint":
        known = (*system.joint_names, *(gimbal.name for gimbal in system.gimbals), *pins(system))
    elif law.site == "loop":
        known = tuple(loop.name for loop in system.loops)
    elif law.site == "link":
        known = tuple(link.name for link in system.links)
    elif law.site == "base":
        known = ("base",)
    else:
        return
    if site not in known:
        raise InputError(
            f"effect {law.name!r} sits at a {law.site}, and there is no {law.site} {site!r}",
            mend=did_you_mean(site, known),
        )
