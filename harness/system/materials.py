"""Densities and Young's moduli of common engineering materials."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """A class of materials: ranges of density [kg/m³] and Young's modulus [Pa]; whether links are seldom made of it."""

    name: str
    density: tuple[float, float]
    youngs_modulus: tuple[float, float]
    rare: bool = False


# Ranges after the tables of density and Young's modulus in M. F. Ashby, Materials Selection in Mechanical Design,
# Butterworth-Heinemann, appendix, and Cambridge University Engineering Department, Materials Data Book, 2003, part II;
# copper alloys widened to brasses.
MATERIALS = (
    Material("carbon or spring steel", (7800.0, 7900.0), (200e9, 216e9)),
    Material("stainless steel", (7600.0, 8100.0), (189e9, 210e9)),
    Material("cast iron", (7050.0, 7250.0), (165e9, 180e9)),
    Material("nickel alloy", (8830.0, 8950.0), (190e9, 220e9)),
    Material("copper alloy", (8200.0, 8940.0), (96e9, 148e9)),
    Material("titanium alloy", (4400.0, 4800.0), (90e9, 120e9)),
    Material("aluminium alloy", (2500.0, 2900.0), (68e9, 82e9)),
    Material("magnesium alloy", (1740.0, 1950.0), (42e9, 47e9)),
    Material("zinc alloy", (4950.0, 7000.0), (68e9, 95e9), rare=True),
    Material("lead alloy", (10000.0, 11400.0), (12.5e9, 15e9), rare=True),
    Material("tungsten alloy", (17800.0, 19600.0), (310e9, 380e9), rare=True),
    Material("alumina", (3500.0, 3980.0), (215e9, 413e9), rare=True),
    Material("glass", (2170.0, 2550.0), (61e9, 74e9), rare=True),
    Material("carbon-fibre composite", (1500.0, 1600.0), (69e9, 150e9)),
    Material("glass-fibre composite", (1750.0, 1970.0), (15e9, 28e9)),
    Material("wood along the grain", (600.0, 800.0), (6e9, 20e9)),
    Material("acrylic", (1160.0, 1220.0), (2.24e9, 3.8e9)),
    Material("polycarbonate", (1140.0, 1210.0), (2.0e9, 2.44e9)),
    Material("ABS", (1010.0, 1210.0), (1.1e9, 2.9e9)),
    Material("nylon", (1120.0, 1140.0), (2.62e9, 3.2e9)),
    Material("epoxy", (1110.0, 1400.0), (2.35e9, 3.08e9)),
    Material("acetal (POM)", (1390.0, 1430.0), (2.5e9, 5.0e9)),
    Material("polyethylene", (939.0, 960.0), (0.62e9, 0.90e9)),
)
# Osmium, the densest element at 22 590 kg/m³, and the lightest rigid foams (Ashby, as above): no link lies beyond.
DENSEST = 22590.0
LIGHTEST = 16.0
