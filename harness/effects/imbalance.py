"""A centre of mass beside the axis on which a balanced body is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.system import System
from harness.system.description import Array, constant

ACROSS = ("u", "v")
LITTLE = Scale(0.01, inertia=0.5, mass=-0.5)  # of the radius of gyration about the axis


def across(axis: Array) -> tuple[Array, Array]:
    """The directions u and v [1], in the body's frame, each of shape (3,), which with the axis are right-handed.

    u is square to the axis, toward that of the body's x, y and z (then x again) which comes after the one nearest to the axis.
    """
    along = np.asarray(axis) / np.linalg.norm(axis)
    following = np.eye(3)[(int(np.argmax(np.abs(along))) + 1) % 3]
    u = following - along * (along @ following)
    u = u / np.linalg.norm(u)
    return u, np.cross(along, u)


def _displace(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    directions = across(system.carrier(site).axis)
    moved = np.asarray(link.com) + sum(parameters[n] * way for n, way in zip(ACROSS, directions, strict=True))
    return system.replace_link(replace(link, com=constant(moved)))


def _shift(name: str, where: str) -> Parameter:
    return Parameter(
        name,
        "m",
        f"shift square to the joint's axis, {where}, mass and inertia about the centre of mass unchanged",
        scale=LITTLE,
        starts=(1.0, -1.0),
        plausible=Plausible(LITTLE, "a hundredth of the radius of gyration: screws, keys, a bore beside the middle"),
    )


EFFECT = Effect(
    name="imbalance",
    title="centre of mass beside its axis",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=(
        _shift("u", "toward the body's axis that follows, in the order x, y, z, x, the one nearest to the joint's"),
        _shift("v", "along axis × u"),
    ),
    signature="A torque of gravity once a turn, the same going and coming: the speed of a turning rotor wavers, and it "
    "comes to rest at one angle.",
    shows_in="motion over a good part of a turn about an axis that is not plumb, or on something that moves; an encoder's "
    "error once a turn does not grow as the rotor slows down, this does",
    source="ISO 21940-11:2016, Mechanical vibration, rotor balancing: static unbalance.",
    expressed_by={
        "denoc": "link inertia",
        "mujoco": "body inertia",
        "pinocchio": "link inertia",
        "exudyn": "body inertia",
    },
    needs=("motion", "rigid", "balanced"),
    confusable_with=("encoder_interpolation", "cogging_torque", "payload_mass", "constant_torque", "joint_stiffness"),
    reshape=Reshape(_displace),
)
