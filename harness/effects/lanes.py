"""Systems with effects in them put into the native lanes: one model, one parameter row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.effects.catalogue import understood
from harness.effects.effect import Effect
from harness.errors import UnsupportedError
from harness.system import Attachment, System
from harness.system.description import Array

if TYPE_CHECKING:
    from harness.denoc.lanes.model import LaneModel

USER_PARAMETERS = 4  # that a row has slots for
BOUNDLESS = 1e6  # N·m, stands for a drive without a range of force: its digits have to leave those of the force


def lane_model(system: System, user: Sequence[Effect] = ()) -> LaneModel:
    """Lanes of a system, with the law that its attachments need beyond the built-in ones.

    user: effects of the user's own that may be attached, now or in later rows.
    Raises UnsupportedError if two different laws would be needed: the lanes carry one.
    """
    from harness.denoc.joint_laws.address import commanded_servo, servo, teeth
    from harness.denoc.lanes.model import LaneModel

    known = understood()
    attached = [known[a.effect] for a in system.attachments if a.effect in known]
    needed: dict[str, Callable[..., float]] = {
        effect.name: effect.user.torque for effect in (*attached, *user) if effect.user is not None
    }
    if any(attachment.effect == "backlash" for attachment in system.attachments):
        needed["backlash"] = teeth
    if system.drives:
        needed["actuators"] = commanded_servo if any(drive.gain for drive in system.drives) else servo
    if len(needed) > 1:
        raise UnsupportedError(
            f"{' and '.join(sorted(needed))} together need two laws of their own", mend="simulate them one at a time"
        )
    return LaneModel(system, law=next(iter(needed.values()), None))


def lane_row(model: LaneModel, system: System, user: Sequence[Effect] = ()) -> Array:
    """Parameter row of a system of the model's topology, its attachments included, shape (P,).

    Attached sensor and input effects change no row. Of a drive with a gain the command comes as the effort of its joint. Stops
    stand at both ends of a joint's range.
    """
    row = model.row(system)
    known = {**understood(), **{effect.name: effect for effect in user}}
    for attachment in system.attachments:
        write_attachment(row, model, attachment, known)
    for drive in system.drives:
        # A range that is not the same both ways is a constant force and one that is.
        low = max(drive.lower, drive.together[0], -BOUNDLESS)
        high = min(drive.upper, drive.together[1], BOUNDLESS)
        middle = 0.5 * (low + high)
        row[model.slot(drive.joint, "constant_torque")] += middle
        _write_user(
            row, model, drive.joint, (drive.offset - middle, drive.stiffness, drive.damping, 0.5 * (high - low))
        )
    for stop in system.stops:
        for name, value in (
            ("stop_both", 1.0),
            ("stop_lower", stop.lower),
            ("stop_angle", stop.upper),
            ("stop_stiffness", stop.stiffness),
            ("stop_damping", stop.damping),
            ("stop_inertia", stop.inertia),
        ):
            row[model.slot(stop.joint, name)] = value
    return row


def write_attachment(row: Array, model: LaneModel, attachment: Attachment, known: Any) -> None:
    """Put one attached dynamics effect into a row (P,) in place."""
    if attachment.effect == "backlash":
        # The coupling that ``drive_side`` made: its teeth are the model's extra law.
        p = attachment.parameters
        values = (0.5 * p["gap"], p["stiffness"], p["damping"])
        _write_user(row, model, attachment.site, values)
        return
    effect = known.get(attachment.effect)
    if effect is None:
        raise UnsupportedError(
            f"attached effect {attachment.effect!r} is not in the catalogue", mend="load the file that defines it"
        )
    values = effect.values(attachment.parameters)
    if effect.user is not None:
        _write_user(row, model, attachment.site, values)
    elif effect.law is not None:
        before = row.copy()
        effect.law.write(row[None, :], model, attachment.site, values[None, :])
        for slot, parameter in zip(effect.law.slots, effect.parameters, strict=True):
            if parameter.neutral == 0.0 and parameter.name not in (
                "phase",
                "periods",
                "frequency",
                "stribeck_velocity",
            ):
                row[model.slot(attachment.site, slot)] += before[model.slot(attachment.site, slot)]


def _write_user(row: Array, model: LaneModel, site: str, values: Any) -> None:
    row[model.slot(site, "user_scale")] = 1.0
    for k, value in enumerate(values):
        row[model.slot(site, f"user_{k + 1}")] = value


def rows(model: LaneModel, systems: Sequence[System]) -> Array:
    """Rows of several systems of one topology, shape (B, P)."""
    return np.stack([lane_row(model, system) for system in systems])
