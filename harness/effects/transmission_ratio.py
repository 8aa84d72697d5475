"""A joint that follows another farther, or less far, than modelled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.errors import InputError
from harness.system import Coupling, System


def _scale(system: System, site: str, parameters: Mapping[str, float]) -> System:
    coupling = next((loop for loop in system.loops if loop.name == site), None)
    if not isinstance(coupling, Coupling) or coupling.leader is None:
        raise InputError(f"{site!r} is no joint that follows another", mend="a ratio is that of such a joint")
    place, *powers = coupling.coefficients
    first, second, third, fourth = (parameters["factor"] * value for value in powers)
    other = replace(coupling, coefficients=(place, first, second, third, fourth))
    return replace(system, loops=tuple(other if loop is coupling else loop for loop in system.loops))


EFFECT = Effect(
    name="transmission_ratio",
    title="transmission ratio off",
    family=Family.INERTIA,
    site=SiteKind.LOOP,
    parameters=(
        Parameter(
            "factor",
            "1",
            "how far the following joint moves for the leading one, over what the model says",
            lower=-100.0,
            upper=100.0,
            neutral=1.0,
            scale=Scale(0.02),
            starts=(1.0, -1.0, 5.0, -5.0),
            plausible=Plausible(Scale(0.05), "one tooth of a wheel of twenty; belts creep by a hundredth"),
        ),
    ),
    signature="Where both joints are recorded, one moves as the other times another number; where one is, the inertia and the "
    "weight that it feels of the other are off.",
    shows_in="recordings of both joints",
    source="Shigley and Mischke, Mechanical Engineering Design (1989), ch. 13: train value of gears.",
    expressed_by={
        "denoc": "coefficients of the coupling",
        "mujoco": "polycoef of the joint equality",
        "pinocchio": "factor of the mimic joint",
    },
    needs=("motion", "coupling"),
    confusable_with=("sensor_gain", "added_inertia", "payload_mass"),
    reshape=Reshape(_scale),
)
