"""Inertia about a joint's axis that the model does not know: a hub, a rotor behind a gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.system import System


def _add(system: System, site: str, parameters: Mapping[str, float]) -> System:
    joint = system.joint(site)
    return system.replace_joint(replace(joint, armature=joint.armature + parameters["inertia"]))


EFFECT = Effect(
    name="added_inertia",
    title="added inertia (hub, reflected rotor)",
    family=Family.INERTIA,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "inertia",
            "kg*m**2",
            "added to the joint's armature; through a gear, rotor inertia times the square of the ratio",
            lower=0.0,
            scale=Scale(0.05, inertia=1),
            starts=(0.4, 4.0),
            linear_unit="kg",
            plausible=Plausible(
                Scale(1.0, inertia=1),
                "rotors seen through gears are as heavy as the arm they drive (Armstrong et al., ICRA 1986)",
            ),
        ),
    ),
    signature="The swing is slower than modelled by the same factor at every amplitude, and gravity torque is right.",
    shows_in="a free swing shows only its ratio to the gravity moment; a known torque shows it itself",
    source="Featherstone, Rigid Body Dynamics Algorithms (2008), §9.6: rotor inertia behind a gear.",
    expressed_by={
        "denoc": "joint armature",
        "mujoco": "joint armature",
        "pinocchio": "model.armature",
        "exudyn": "inertia on the joint's coordinate",
        "analytic": "closed form of the compound pendulum",
    },
    needs=("motion",),
    confusable_with=("payload_mass", "com_offset", "clock_skew", "joint_stiffness", "servo_gain", "servo_torque"),
    reshape=Reshape(_add),
)
