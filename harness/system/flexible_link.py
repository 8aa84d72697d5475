"""A flexible link from its dimensions and material, or from its stiffness and mass given outright."""

from __future__ import annotations

import math

import numpy as np

from harness.system.description import Array, Beam, Link, constant
from harness.system.inertia import combine
from harness.system.table import TableReader

# Shapes of higher Euler-Bernoulli modes are exact here, but a slender beam has no 20th mode: shear and rotary
# inertia, which are left out, dominate long before.
MOST_MODES = 20
SHAPES = ("auto", "clamped_free", "tip_mass", "hub", "samples")
# Mass and density both given must agree within 3σ of the stated tolerance, and never have to within less than 3 %:
# tables print two digits.
PRINTED_MASS = 0.03


def flexible_link(name: str, beam: Beam) -> Link:
    """The link a beam makes: mass, centre of mass and inertia of beam and payload, undeformed.

    The beam counts as a slender line, so that a link whose modes are frozen has ρ l³/3 + m_p l² about its joint;
    the rotary inertia of the cross-section (smaller by (thickness / length)²) is left out.
    """
    direction = np.asarray(beam.direction)
    across = np.eye(3) - np.outer(direction, direction)
    line = beam.mass * beam.length**2 / 12.0 * across
    mass, com, inertia = combine(
        (beam.mass, direction * beam.length / 2.0, line),
        (beam.payload, direction * beam.length, np.asarray(beam.payload_inertia)),
    )
    return Link(name=name, mass=mass, com=constant(com), inertia=constant(inertia), beam=beam)


def read_flexible_link(table: TableReader, name: str, tolerance: float) -> Link:
    """A flexible link from its TOML table. Raises InputError for what cannot be a beam."""
    length = table.number("length", positive=True)
    direction = table.direction("direction", mend="add direction = [0, 0, -1], from the joint to the tip")
    bending = _bending(table, direction)
    modes = table.count("modes", 1, most=MOST_MODES)
    torsion_modes = table.count("torsion_modes", 0, most=MOST_MODES)
    bending2 = table.flag("bending2", False)
    section = _Section(table, bending2, torsion_modes > 0)
    mass = _mass(table, section, length, tolerance)
    modal_damping = _a_mode(table, "modal_damping", modes)
    if any(not 0.0 <= ratio < 1.0 for ratio in modal_damping):
        table.refuse(
            "modal_damping has a ratio outside 0 to 1",
            "1 would be critical; give 0.005 for half a per cent",
            "modal_damping",
        )
    mode_stiffness = _a_mode(table, "mode_stiffness", modes)
    if any(factor <= 0.0 for factor in mode_stiffness):
        table.refuse(
            "mode_stiffness has a factor that is not positive", "1 is what EI gives the mode", "mode_stiffness"
        )
    shapes = table.text("shapes", "auto")
    if shapes not in SHAPES:
        table.refuse(f"unknown shapes {shapes!r}", "known: " + ", ".join(SHAPES), "shapes")
    payload = table.number("payload", 0.0, non_negative=True)
    payload_inertia = table.tensor("payload_inertia") if table.has("payload_inertia") else constant(np.zeros((3, 3)))
    if np.linalg.eigvalsh(payload_inertia)[0] < 0.0:
        table.refuse("payload_inertia has a negative principal moment", key="payload_inertia")
    beam = Beam(
        length=length,
        direction=direction,
        bending=bending,
        mass=mass,
        bending_stiffness=section.stiffness,
        bending_stiffness2=section.stiffness2,
        bending2=bending2,
        torsional_stiffness=section.torsional_stiffness,
        polar_inertia=section.polar_moment / section.area * mass / length if torsion_modes else 0.0,
        half_depth=section.half_depth,
        material_damping=section.damping,
        modes=modes,
        torsion_modes=torsion_modes,
        modal_damping=modal_damping,
        mode_stiffness=mode_stiffness,
        geometric_stiffening=table.flag("geometric_stiffening", True),
        payload=payload,
        payload_inertia=payload_inertia,
        shapes=shapes,
        shape_samples=_samples(table, shapes, modes),
        width=section.width,
        thickness=section.thickness,
        youngs_modulus=section.youngs_modulus,
        density=section.density,
    )
    if beam.coordinates == 0:
        table.refuse("a flexible link needs at least one mode", "set modes = 1, or give mass, com and inertia instead")
    return flexible_link(name, beam)


def _a_mode(table: TableReader, key: str, modes: int) -> tuple[float, ...]:
    """Numbers of the first modes; none if the key is not there."""
    values = tuple(table.numbers(key)) if table.has(key) else ()
    if len(values) > modes:
        table.refuse(f"{key} has {len(values)} numbers for {modes} mode(s)", "give at most one a mode", key)
    return values


def _bending(table: TableReader, direction: Array) -> Array:
    bending = np.asarray(table.direction("bending", mend="add bending = [1, 0, 0], across the link"))
    along = float(bending @ direction)
    if abs(along) > 1.0 - 1e-6:
        table.refuse("bending points along the link", "the deflection is across it: orthogonal to direction", "bending")
    if abs(along) > 1e-3:
        angle = math.degrees(math.acos(along))
        table.refuse(f"bending is {angle:.1f}° from direction", "make it orthogonal to direction", "bending")
    if abs(along) < 1e-15:
        return constant(bending)
    bending = bending - along * np.asarray(direction)
    return constant(bending / np.linalg.norm(bending))


class _Section:
    """Cross-section and material of a beam: stiffnesses [N·m²] and what else the table says; nan where it is silent."""

    def __init__(self, table: TableReader, bending2: bool, torsion: bool) -> None:
        section = table.inner("section")
        if section is None:
            table.refuse(
                "'section' is missing", "add section = { width = …, thickness = … } or { area, second_moment }"
            )
        material = table.inner("material")
        if material is None:
            table.refuse("'material' is missing", "add material = { youngs_modulus = 2.0e11, density = 7850.0 }")
        nan = float("nan")
        self.youngs_modulus = material.number("youngs_modulus", positive=True)
        self.density = material.number("density", positive=True) if material.has("density") else nan
        self.damping = material.number("damping", 0.0, non_negative=True)
        rectangle = section.has("width") or section.has("thickness")
        self.width = section.number("width", positive=True) if rectangle else nan
        self.thickness = section.number("thickness", positive=True) if rectangle else nan
        if rectangle:
            if section.has("area") or section.has("second_moment"):
                section.refuse("width and thickness say it already", "take area and second_moment out, or the former")
            w, t = self.width, self.thickness
            self.area, second, second2 = w * t, w * t**3 / 12.0, t * w**3 / 12.0
            torsion_constant = rectangle_torsion_constant(w, t)
        else:
            self.area = section.number("area", positive=True) if section.has("area") else nan
            second = section.number("second_moment", positive=True, mend="or give width and thickness")
            second2 = section.number("second_moment2", positive=True) if section.has("second_moment2") else nan
            torsion_constant = (
                section.number("torsion_constant", positive=True) if section.has("torsion_constant") else nan
            )
        self.half_depth = self.thickness / 2.0
        if section.has("half_depth"):
            self.half_depth = section.number("half_depth", positive=True)
        if bending2 and math.isnan(second2):
            section.refuse(
                "bending2 = true needs the other second moment", "add second_moment2, or width and thickness"
            )
        self.stiffness = self.youngs_modulus * second
        self.stiffness2 = self.youngs_modulus * second2 if bending2 else 0.0
        self.polar_moment = second + second2
        shear = self._shear_modulus(material)
        self.torsional_stiffness = 0.0
        if torsion:
            if math.isnan(shear):
                material.refuse("torsion_modes need a shear modulus", "add shear_modulus or poissons_ratio")
            if math.isnan(torsion_constant + second2 + self.area):
                section.refuse("torsion_modes need the whole section", "add torsion_constant, second_moment2 and area")
            self.torsional_stiffness = shear * torsion_constant
        section.finish()
        material.finish()

    def _shear_modulus(self, material: TableReader) -> float:
        if material.has("shear_modulus"):
            return material.number("shear_modulus", positive=True)
        if material.has("poissons_ratio"):
            ratio = material.number("poissons_ratio")
            if not -1.0 < ratio <= 0.5:
                material.refuse(f"poissons_ratio {ratio:g} is not between -1 and 0.5", key="poissons_ratio")
            return self.youngs_modulus / (2.0 * (1.0 + ratio))
        return float("nan")


def rectangle_torsion_constant(width: float, thickness: float) -> float:
    """Torsion constant J of a solid rectangle [m⁴], within 0.5 %.

    Source: Young and Budynas, Roark's Formulas for Stress and Strain, 7th ed., table 10.1, case 4.
    """
    a, b = max(width, thickness) / 2.0, min(width, thickness) / 2.0
    return a * b**3 * (16.0 / 3.0 - 3.36 * b / a * (1.0 - b**4 / (12.0 * a**4)))


def _mass(table: TableReader, section: _Section, length: float, tolerance: float) -> float:
    """Mass of the beam alone [kg], given outright or by density; refused where the two contradict each other."""
    by_density = section.density * section.area * length
    if not table.has("mass"):
        if math.isnan(by_density):
            table.refuse("the mass of the beam is not given", "add mass, or density to material (and area to section)")
        return by_density
    mass = table.number("mass", positive=True)
    if not math.isnan(by_density) and abs(mass - by_density) > max(3.0 * tolerance, PRINTED_MASS) * by_density:
        table.refuse(
            f"density contradicts mass: {section.density:g} kg/m³ over {section.area * length:.4g} m³ is "
            f"{by_density:.4g} kg, mass says {mass:g} kg (density {mass / (section.area * length):.0f})",
            "give one of them, or run `denoc audit` on the table to see which is wrong",
            "mass",
        )
    return mass


def _samples(table: TableReader, shapes: str, modes: int) -> Array | None:
    if not table.has("shape_samples"):
        if shapes == "samples":
            table.refuse('shapes = "samples" needs shape_samples', "add rows of [station 0…1, shape 1, …]")
        return None
    if shapes != "samples":
        table.refuse("shape_samples are given but not used", 'set shapes = "samples"', "shape_samples")
    rows = table.table["shape_samples"]
    width = modes + 1
    if not isinstance(rows, list) or len(rows) < 3 or any(not isinstance(r, list) or len(r) != width for r in rows):
        table.refuse(f"shape_samples must be at least three rows of {width} numbers", key="shape_samples")
    samples = np.array(
        [
            TableReader({"shape_samples": row}, table.what, table.source, table.line).numbers("shape_samples")
            for row in rows
        ]
    )
    stations = samples[:, 0]
    if np.any(np.diff(stations) <= 0.0) or abs(stations[0]) > 1e-9 or abs(stations[-1] - 1.0) > 1e-9:
        table.refuse("stations of shape_samples must rise from 0 to 1", key="shape_samples")
    return constant(samples)
