"""How well a parameter table of a flexible link agrees with physics and with measured frequencies: χ² by term."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.system.audit_tables import LENGTHS
from harness.system.materials import MATERIALS
from harness.system.strip_frequency import strip_frequencies

# 1σ of what is compared, in logarithms: catalogue densities and moduli, tables' two digits, a measured frequency.
DENSITY_SIGMA = 0.03
MODULUS_SIGMA = 0.05
MASS_SIGMA = 0.03
FREQUENCY_SIGMA = 0.02
# Links of ceramics, glass or lead are one in a hundred: 2 ln 100 in χ², as for a slip.
RARITY = 2.0 * math.log(100.0)
# A hub, a payload or an aspect ratio beyond what is usual is doubted softly: one σ is a factor of ten.
USUAL_SIGMA = math.log(10.0)
# A term of χ² above this (3σ) contradicts.
CONTRADICTION = 9.0


@dataclass(frozen=True)
class Facts:
    """What a table implies: density [kg/m³], mass [kg], nearest material."""

    density: float
    mass: float
    material: str


def evaluate(
    table: Mapping[str, float], heard: Sequence[float], *, worst: float = math.inf
) -> tuple[dict[str, float], Facts]:
    """χ² by term, and what the table implies; frequencies are left out once the rest is above ``worst``."""
    length, width, thickness = (table[key] for key in LENGTHS)
    volume = length * width * thickness
    terms: dict[str, float] = {}
    density = table["mass"] / volume if "mass" in table else table["density"]
    mass = density * volume
    if "mass" in table and "density" in table:
        terms["mass against density"] = (math.log(density / table["density"]) / MASS_SIGMA) ** 2
    distances = [
        (_outside(density, m.density) / DENSITY_SIGMA) ** 2
        + (_outside(table["youngs_modulus"], m.youngs_modulus) / MODULUS_SIGMA) ** 2
        + (RARITY if m.rare else 0.0)
        for m in MATERIALS
    ]
    nearest = int(np.argmin(distances))
    terms["rarity"] = RARITY if MATERIALS[nearest].rare else 0.0
    terms["material"] = distances[nearest] - terms["rarity"]
    inertia = mass * length**2 / 3.0
    terms["hub inertia"] = _beyond(table.get("hub_inertia", 0.0) / inertia)
    terms["payload"] = _beyond(table.get("payload", 0.0) / (10.0 * mass))
    terms["slenderness"] = _beyond(20.0 * thickness / length) + _beyond(width / length)
    # Links of machines are between a millimetre and a hundred metres long.
    terms["length"] = _beyond(length / 100.0) + _beyond(1e-3 / length)
    if heard and sum(terms.values()) <= worst:
        for k, (f, own) in enumerate(zip(heard, own_frequencies(table, mass, len(heard)), strict=True), start=1):
            if not math.isnan(f):
                terms[f"frequency {k}"] = (math.log(own / f) / FREQUENCY_SIGMA) ** 2
    return terms, Facts(density, mass, MATERIALS[nearest].name)


def _outside(value: float, bounds: tuple[float, float]) -> float:
    """Distance of a value from a range, in logarithms; zero inside."""
    return max(math.log(bounds[0] / value), math.log(value / bounds[1]), 0.0)


def _beyond(ratio: float) -> float:
    """Soft doubt about a ratio above one."""
    return (math.log(ratio) / USUAL_SIGMA) ** 2 if ratio > 1.0 else 0.0


def own_frequencies(table: Mapping[str, float], mass: float, count: int) -> tuple[float, ...]:
    stiffness = table["youngs_modulus"] * table["width"] * table["thickness"] ** 3 / 12.0
    values = strip_frequencies(
        stiffness,
        mass,
        table["length"],
        hub_inertia=table.get("hub_inertia", 0.0),
        payload=table.get("payload", 0.0),
        count=count,
    )
    return tuple(float(f) for f in values)
