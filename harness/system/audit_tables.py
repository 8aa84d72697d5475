"""The numbers an audit looks at, from a file, a system or raw tables; lenient where reading a system is strict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.system.audit_findings import Finding
from harness.system.description import Link, System
from harness.system.load import load
from harness.system.magnitudes import LEAST_LENGTH, LEAST_MASS, LENGTH, MASS, NUMBER
from harness.system.read_toml import parse_toml, read_toml

LENGTHS = ("length", "width", "thickness")
# The least and the most that is taken of each [SI], zero beside: what undoing slips makes of them must not overflow.
_TAKEN = {
    **dict.fromkeys(LENGTHS, (LEAST_LENGTH, LENGTH)),
    **dict.fromkeys(("mass", "payload"), (LEAST_MASS, MASS)),
    **dict.fromkeys(("density", "youngs_modulus", "hub_inertia"), (1.0 / NUMBER, NUMBER)),
}


def gather(
    system: str | Path | System | Mapping[str, Any], findings: list[Finding]
) -> tuple[dict[str, dict[str, float]], tuple[Link, ...], str]:
    """Tables of the flexible links by name, the rigid links, and what is audited."""
    if isinstance(system, System):
        return (
            _system_tables(system),
            tuple(k for k in system.links if k.beam is None),
            str(system.source or system.name),
        )
    if isinstance(system, Mapping):
        return _raw_tables(system), (), str(system.get("name", "table"))
    path = Path(system)
    raw: dict[str, Any] | None = None
    text = ""
    try:
        text = path.read_bytes().decode("utf-8-sig")
        raw = None if text.lstrip().startswith("<") else parse_toml(text)
    except (OSError, UnicodeDecodeError, InputError):
        pass  # `load` below says what is wrong, and where
    if raw is None:
        loaded = load(path, physical=False)
        return _system_tables(loaded), tuple(k for k in loaded.links if k.beam is None), str(path)
    try:
        loaded = read_toml(text, path, physical=False)
        rigid = tuple(link for link in loaded.links if link.beam is None)
    except InputError as error:
        # A table that contradicts itself cannot be loaded, which is when an audit is wanted most.
        findings.append(Finding("implausible", str(path), error.what))
        rigid = ()
    return _raw_tables(raw, path), rigid, str(path)


def _system_tables(system: System) -> dict[str, dict[str, float]]:
    tables: dict[str, dict[str, float]] = {}
    for link in system.links:
        beam = link.beam
        if beam is None or not math.isfinite(beam.width * beam.thickness * beam.youngs_modulus):
            continue
        tables[link.name] = _positive(
            {
                "length": beam.length,
                "width": beam.width,
                "thickness": beam.thickness,
                "mass": beam.mass,
                "youngs_modulus": beam.youngs_modulus,
                "hub_inertia": system.carrier(link.name).armature,
                "payload": beam.payload,
            }
        )
    return tables


def _raw_tables(raw: Mapping[str, Any], source: Path | None = None) -> dict[str, dict[str, float]]:
    armature = {}
    for joint in _listed(raw, "joint"):
        armature[joint.get("child")] = joint.get("armature", 0.0)
    tables: dict[str, dict[str, float]] = {}
    for link in _listed(raw, "link"):
        section, material = link.get("section"), link.get("material")
        if not isinstance(section, Mapping) or not isinstance(material, Mapping) or "width" not in section:
            continue
        name = str(link.get("name", f"link {len(tables) + 1}"))
        values = {
            "length": link.get("length"),
            "width": section.get("width"),
            "thickness": section.get("thickness"),
            "mass": link.get("mass", 0.0),
            "density": material.get("density", 0.0),
            "youngs_modulus": material.get("youngs_modulus"),
            "hub_inertia": armature.get(name, 0.0),
            "payload": link.get("payload", 0.0),
        }
        for key, value in values.items():
            if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < math.inf:
                raise InputError(
                    f"link {name!r}: {key} is {value!r}", mend="an audit needs a positive number", source=source
                )
            least, most = _TAKEN[key]
            if value and not least <= value <= most:
                raise InputError(
                    f"link {name!r}: {key} of {float(value):.3g} is beyond any mechanism",
                    mend=f"check the number and its unit; {least:g} to {most:g} is taken",
                    source=source,
                )
        table = _positive({key: float(value) for key, value in values.items()})
        missing = [key for key in (*LENGTHS, "youngs_modulus") if key not in table]
        if not missing and "mass" not in table and "density" not in table:
            missing = ["mass or density"]
        if missing:
            raise InputError(f"link {name!r}: {missing[0]} is missing or zero", mend="state it", source=source)
        tables[name] = table
    return tables


def _listed(raw: Mapping[str, Any], kind: str) -> list[Mapping[str, Any]]:
    items = raw.get(kind, [])
    return [item for item in items if isinstance(item, Mapping)] if isinstance(items, list) else []


def _positive(values: Mapping[str, float]) -> dict[str, float]:
    return {key: float(value) for key, value in values.items() if value > 0.0}
