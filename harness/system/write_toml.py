"""Systems to the project's own TOML, which says all of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import tomli_w

from harness.system.description import Array, Beam, Joint, JointType, Link, System
from harness.system.flexible_link import flexible_link, rectangle_torsion_constant
from harness.system.rotation import to_rpy
from harness.system.tolerances import OF_BEAMS, OF_JOINTS, OF_LINKS, own_tolerances
from harness.system.toml_loops import write_gimbals, write_loops

# Where derived numbers agree this well, the table says what they were derived from.
_SAME = 1e-12


def to_toml(system: System) -> tuple[str, tuple[str, ...]]:
    """TOML text of a system, and what it leaves out (mass added to a beam by hand, nothing else), one line each."""
    left_out: list[str] = []
    document: dict[str, Any] = {"name": system.name}
    if system.base != "base":
        document["base"] = system.base
    document["gravity"] = _list(system.gravity)
    document["tolerance"] = system.tolerance
    document["joint"] = [_joint(joint) | own_tolerances(system, OF_JOINTS, joint.name) for joint in system.joints]
    document["link"] = [
        _link(link, left_out) | own_tolerances(system, OF_LINKS if link.beam is None else OF_BEAMS, link.name)
        for link in system.links
    ]
    document |= write_loops(system.loops)
    document |= write_gimbals(system.gimbals)
    if system.attachments:
        document["effect"] = [
            {"name": a.effect, "site": a.site, "parameters": dict(a.parameters)}
            | ({"std": dict(a.std)} if a.std else {})
            for a in system.attachments
        ]
    return tomli_w.dumps(document), tuple(left_out)


def _list(values: Array) -> list[float]:
    return [float(x) for x in values]


def _joint(joint: Joint) -> dict[str, Any]:
    table: dict[str, Any] = {
        "name": joint.name,
        "type": str(joint.type),
        "parent": joint.parent,
        "child": joint.child,
        "origin": {"xyz": _list(joint.xyz), "rpy": _list(to_rpy(joint.rotation))},
    }
    if joint.type is not JointType.FIXED and not joint.turns_in_space:
        table["axis"] = _list(joint.axis)
    if joint.type is JointType.UNIVERSAL:
        table["axis2"] = _list(joint.axis2)
    if joint.type is JointType.HELICAL:
        table["pitch"] = float(joint.pitch)
    if joint.mimic is not None:
        mimic = joint.mimic
        table["mimic"] = {"joint": mimic.joint, "multiplier": float(mimic.multiplier), "offset": float(mimic.offset)}
    for key in ("armature", "damping", "friction", "stiffness", "rest_position"):
        if getattr(joint, key) != 0.0:
            table[key] = float(getattr(joint, key))
    limits = {key: float(getattr(joint, key)) for key in ("lower", "upper", "effort", "velocity")}
    finite = {key: value for key, value in limits.items() if math.isfinite(value)}
    if finite:
        table["limits"] = finite
    return table


def _six(tensor: Array) -> list[float]:
    t = np.asarray(tensor)
    return [float(x) for x in (t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2])]


def _link(link: Link, left_out: list[str]) -> dict[str, Any]:
    if link.gravcomp:
        left_out.append(f"link {link.name!r}: gravity compensation {link.gravcomp:g}")
    if link.beam is not None:
        bare = flexible_link(link.name, link.beam)
        if not np.allclose(bare.mass, link.mass, rtol=1e-9) or not np.allclose(bare.inertia, link.inertia, rtol=1e-6):
            left_out.append(f"link {link.name!r}: mass or inertia beyond that of its beam and payload")
        return {"name": link.name} | _beam(link.beam)
    if link.mass == 0.0 and not np.any(link.inertia):
        return {"name": link.name, "mass": 0.0}
    end = {} if link.end is None else {"end": _list(link.end)}
    return {"name": link.name, "mass": link.mass, "com": _list(link.com), "inertia": _six(link.inertia)} | end


def _same(a: float, b: float) -> bool:
    return bool(abs(a - b) <= _SAME * abs(b))


def _beam(beam: Beam) -> dict[str, Any]:
    table: dict[str, Any] = {
        "length": beam.length,
        "direction": _list(beam.direction),
        "bending": _list(beam.bending),
    }
    w, t, e = beam.width, beam.thickness, beam.youngs_modulus
    section: dict[str, float]
    # A beam whose Young's modulus nobody knows is said by EI alone: 1 Pa and second moments of that value.
    material = {"youngs_modulus": 1.0 if math.isnan(e) else e}
    rectangular = (
        _same(e * w * t**3 / 12.0, beam.bending_stiffness)
        and (not beam.bending2 or _same(e * t * w**3 / 12.0, beam.bending_stiffness2))
        and (beam.torsion_modes == 0 or _same(beam.polar_inertia, (w * w + t * t) / 12.0 * beam.mass / beam.length))
    )
    if rectangular:
        section = {"width": w, "thickness": t}
        torsion_constant = rectangle_torsion_constant(w, t)
        area = w * t
        by_density = beam.density * area * beam.length
    else:
        section = {"second_moment": beam.bending_stiffness / material["youngs_modulus"]}
        if beam.bending2:
            section["second_moment2"] = beam.bending_stiffness2 / material["youngs_modulus"]
        torsion_constant = 1.0
        by_density = float("nan")
        if beam.torsion_modes:
            # Area is chosen so that ρ I_p = (I1 + I2) / A · mass / length comes out as it is.
            section.setdefault("second_moment2", section["second_moment"])
            moments = section["second_moment"] + section["second_moment2"]
            section["area"] = moments * beam.mass / beam.length / beam.polar_inertia
            section["torsion_constant"] = torsion_constant
    if math.isfinite(beam.half_depth) and not (rectangular and _same(beam.half_depth, t / 2.0)):
        section["half_depth"] = beam.half_depth
    if beam.torsion_modes:
        material["shear_modulus"] = beam.torsional_stiffness / torsion_constant
    if math.isfinite(by_density) and _same(by_density, beam.mass):
        material["density"] = beam.density
    else:
        table["mass"] = beam.mass
    if beam.material_damping:
        material["damping"] = beam.material_damping
    table["section"] = section
    table["material"] = material
    table["modes"] = beam.modes
    if beam.torsion_modes:
        table["torsion_modes"] = beam.torsion_modes
    if beam.bending2:
        table["bending2"] = True
    if beam.modal_damping:
        table["modal_damping"] = list(beam.modal_damping)
    if beam.mode_stiffness:
        table["mode_stiffness"] = list(beam.mode_stiffness)
    table["geometric_stiffening"] = beam.geometric_stiffening
    if beam.payload:
        table["payload"] = beam.payload
    if np.any(beam.payload_inertia):
        table["payload_inertia"] = _six(beam.payload_inertia)
    if beam.shapes != "auto":
        table["shapes"] = beam.shapes
    if beam.shape_samples is not None:
        table["shape_samples"] = [_list(row) for row in np.asarray(beam.shape_samples)]
    return table
