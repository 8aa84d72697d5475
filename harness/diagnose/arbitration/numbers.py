"""The numbers that models of one rig are compared by: base parameters, and the terms of the joints' laws that any of
them has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.joint_laws.laws import SLOTS
from harness.denoc.lanes.model import LaneModel
from harness.denoc.lanes.rows import INERTIA_SLOTS
from harness.diagnose.arbitration.base_parameters import (
    ARMATURE,
    BaseParameter,
    Key,
    base_parameters,
    inertial_parameters,
)
from harness.diagnose.arbitration.constants import LEAST_INERTIA_SHARE, LEAST_LAW_SHARE
from harness.effects.lanes import lane_row
from harness.effects.scale import References, references
from harness.system import System

Array = NDArray[np.float64]

USUAL = ("damping", "coulomb_torque")  # what every joint may have, whether a model says so or not
OF_DRIVES = ("constant_torque",)  # the same of joints that are driven: an amplifier's zero
# Terms that say where or how quickly another one acts: nothing by themselves, and held where a model has none.
SHAPES = (
    "stribeck_velocity", "rest_angle", "dahl_stiffness", "polynomial_rest", "cogging_periods", "cogging_phase", "stop_angle",
    "stop_damping", "stop_inertia", "creep_velocity", "soft_time", "soft_inertia",
)  # fmt: skip
NOT_FREED = (
    "cogging_periods",
    "creep_velocity",
    "soft_time",
    "soft_inertia",
    "user_scale",
    "user_1",
    "user_2",
    "user_3",
    "user_4",
)
POSITIVE = (
    "damping",
    "coulomb_torque",
    "static_torque",
    "quadratic_drag",
    "mu_radius",
    "stribeck_velocity",
    "dahl_stiffness",
    "dahl_torque",
)
PLAIN = {
    "damping": "viscous damping", "coulomb_torque": "dry friction", "static_torque": "dry friction at rest",
    ARMATURE: "rotor inertia",
    "stiffness": "spring", "rest_angle": "spring, slack at", "constant_torque": "constant torque", "quadratic_drag": "drag over v²",
    "mass": "mass",
}  # fmt: skip


@dataclass(frozen=True)
class Number:
    """One number of a model.

    joint: that it belongs to. key: site and name among a lane's parameters. label: as people read it. unit: SI. size:
    by which a change of it counts, positive. inertial: the base parameter that it is, None for a term of a joint's law.
    """

    joint: str
    key: Key
    label: str
    unit: str
    size: float
    inertial: BaseParameter | None = None

    @property
    def positive(self) -> bool:
        """Whether no body or joint has less than none of it."""
        return self.inertial is None and self.key[1] in POSITIVE

    @property
    def shape(self) -> bool:
        """Whether it says nothing where the term that it shapes is absent."""
        return self.key[1] in SHAPES


def numbers(models: Sequence[System], driven: bool = False) -> tuple[Number, ...]:
    """What rigid models of the same joints are compared by, the first one's base parameters first; driven: whether efforts act.

    A base parameter that one model has and another, by its geometry, has not is left out.
    """
    own = [{p.key: p for p in base_parameters(model)} for model in models]
    first = models[0]
    rows = [_row(model) for model in models]
    usual = (*USUAL, *OF_DRIVES) if driven else USUAL
    found: list[Number] = []
    for key, parameter in own[0].items():
        if all(key in other for other in own):
            joint = key[0] if key[1] == ARMATURE else first.carrier(key[0]).name
            values = [mine[key].value(inertial_parameters(model)) for mine, model in zip(own, models, strict=True)]
            found.append(_number(joint, key, values, references(first, joint), first, parameter))
    for name in first.joint_names:
        for slot in SLOTS:
            key = (name, slot.name)
            values = [lane[1][lane[0].slot(*key)] for lane in rows]
            if slot.name == ARMATURE or slot.name in NOT_FREED or not (slot.name in usual or any(values)):
                continue
            found.append(_number(name, key, values, references(first, name), first, None))
    return tuple(found)


def values(model: System, every: Sequence[Number]) -> Array:
    """A model's numbers [SI], by its own geometry, (K,)."""
    lane, row = _row(model)
    grouped = {p.key: p for p in base_parameters(model)}
    inertial = inertial_parameters(model)
    return np.array(
        [
            row[lane.slot(*n.key)] if n.inertial is None else grouped[n.key].value(inertial)
            for n in every
        ]
    )  # fmt: skip


def _row(model: System) -> tuple[LaneModel, Array]:
    lane = LaneModel(model)
    return lane, lane_row(lane, model)


def _number(
    joint: str, key: Key, values: Sequence[float], natural: References, system: System, parameter: BaseParameter | None
) -> Number:
    slides = system.joint(joint).prismatic
    least = (LEAST_LAW_SHARE if parameter is None else LEAST_INERTIA_SHARE) * _natural(
        key[1], natural, parameter is not None
    )
    size = max(*(abs(float(v)) for v in values), least)
    others = "" if parameter is None or not parameter.with_ else " with what acts like it"
    if parameter is None or key[1] == ARMATURE:
        label = f"{PLAIN.get(key[1], key[1].replace('_', ' '))} at {joint}"
    elif key[1] == "mass":
        label = f"mass of {key[0]}"
    else:
        kind, _, axes = key[1].partition("_")
        label = f"{'first moment' if kind == 'first' else 'inertia'} {axes} of {key[0]}"
    return Number(joint, key, label + others, _unit(key[1], slides, parameter is not None), size, parameter)


def _natural(name: str, natural: References, inertial: bool) -> float:
    """What would be much of a number at its joint [SI]."""
    if inertial:
        if name == "mass":
            return natural.mass
        return float(np.sqrt(natural.inertia * natural.mass)) if name.startswith("first") else natural.inertia
    if name in ("damping", "dahl_stiffness", "stop_damping"):
        return natural.inertia * natural.frequency
    if name == "quadratic_drag":
        return natural.inertia
    if name == "mu_radius":
        return natural.length
    if name in SHAPES:
        return 1.0
    return natural.torque


def _unit(name: str, slides: bool, inertial: bool) -> str:
    if inertial:
        if name in ("mass",) or (name == ARMATURE and slides):
            return "kg"
        return "kg*m" if name in INERTIA_SLOTS[1:4] else "kg*m**2"
    unit = next(slot.unit for slot in SLOTS if slot.name == name)
    unit = unit.replace("·", "*").replace("²", "**2").replace("³", "**3")
    if slides:
        # A term of a sliding joint is a force over metres.
        unit = unit.replace("N*m", "N", 1).replace("rad", "m")
    return unit
