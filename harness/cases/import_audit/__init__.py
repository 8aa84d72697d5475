"""Which field of a model file each engine's reader passes over, and what that costs in motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.cases.import_audit.ignored import Ignored, as_dict, units_of
from harness.cases.import_audit.mjcf import mjcf_fields
from harness.cases.import_audit.urdf import urdf_fields
from harness.engines.readers.register import root_of
from harness.errors import InputError
from harness.system import load
from harness.system.loop import explicit
from harness.system.lowering import freed, one_degree

SCHEMA = "denoc.import/1"

__all__ = ["SCHEMA", "Ignored", "as_dict", "audit_import"]


def audit_import(path: str | Path, *, physical: bool = True, allow: Sequence[str | Path] = ()) -> tuple[Ignored, ...]:
    """Every field of a URDF or MJCF that some reader passes over, with what it costs; the costliest first.

    Raises InputError for a file that cannot be read, and for TOML, which no engine reads.
    """
    source = Path(path)
    # Runs with a field and without are those of independent joints; what mimics and polynomials cost is how far they depart.
    read = load(source, physical=physical, allow=allow)
    curved = explicit(read.loops)
    system = one_degree(freed(replace(read, loops=() if curved else read.loops)), "an audit of readers")
    kind = root_of(source)
    if not kind:
        raise InputError("is no URDF or MJCF, and no other engine reads it", mend="give a .urdf or .xml", source=source)
    folders = [Path(folder) for folder in allow]
    following = sum(joint.mimic is not None for joint in read.joints) + len(curved)
    found = urdf_fields(source, system, folders) if kind == "robot" else mjcf_fields(source, system, folders, following)
    units = units_of(system)
    ordered = sorted(found, key=lambda row: -max(row.force or 0.0, row.motion or 0.0))
    return tuple(replace(row, units=units) for row in ordered)
