"""Kinds of friction whose level may differ from recording to recording, each by itself."""

from __future__ import annotations

from dataclasses import dataclass

from harness.diagnose.levels.constants import LEVEL_SPREAD, VISCOUS_LEVEL_SPREAD


@dataclass(frozen=True)
class Kind:
    """slots: of a lane's row, which a level multiplies. acting: those of them that say whether a joint has such friction.

    laws: effects that are of this kind. spread: of a level's logarithm before anything is recorded.
    """

    name: str
    slots: tuple[str, ...]
    acting: tuple[str, ...]
    laws: tuple[str, ...]
    spread: float


DRY = Kind(
    "dry friction",
    ("coulomb_torque", "static_torque", "mu_radius", "dahl_torque", "dahl_stiffness"),
    ("coulomb_torque", "static_torque", "mu_radius", "dahl_torque"),
    ("coulomb_friction", "stribeck_friction", "load_dependent_friction", "dahl_friction"),
    LEVEL_SPREAD,
)
VISCOUS = Kind("viscous damping", ("damping",), ("damping",), ("viscous_damping",), VISCOUS_LEVEL_SPREAD)
KINDS = (DRY, VISCOUS)
