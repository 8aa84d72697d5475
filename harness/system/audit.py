"""Is a parameter table possible at all, and if not, which slips would explain it?

For every flexible link the stated numbers are held against physics (mass against dimensions and density, density and
Young's modulus against engineering materials, hub inertia against the link's) and against measured frequencies. Where
that fails, one or two undone slips (three where two do not suffice) are tried and ranked by

    score = ½ χ² + Σ cost      [nats, lower is better],

χ² the misfit of what the corrected table implies, and cost the price of each slip (see ``slips``). Probability is
proportional to exp(-score) among everything tried, the table as it stands included.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.system.audit_evidence import CONTRADICTION, Facts, evaluate, own_frequencies
from harness.system.audit_findings import Audit, Correction, Finding
from harness.system.audit_search import correct
from harness.system.audit_tables import LENGTHS, gather
from harness.system.description import Link, System
from harness.system.inertia import impossible
from harness.system.materials import DENSEST, LIGHTEST
from harness.system.strip_frequency import strip_frequencies


def audit(
    system: str | Path | System | Mapping[str, Any], *, measured: Mapping[str, Sequence[float]] | None = None
) -> Audit:
    """Hold a parameter table against physics and measurement.

    system: a model file, a System, or the raw table of a TOML file (so that a table that could not be loaded can be
        audited). measured: bending frequencies [Hz] by link name, lowest first, nan for one not known; of the link on
        its hub, free to turn, with its payload and nothing else.
    Raises InputError for a file or table that cannot be read, and for a measured link that is not there.
    """
    measured = measured or {}
    findings: list[Finding] = []
    tables, rigid, source = gather(system, findings)
    for name, frequencies in measured.items():
        if name not in tables:
            known = ", ".join(tables) or "none"
            raise InputError(
                f"link {name!r} has measured frequencies but is not a flexible link", mend=f"known: {known}"
            )
        if not all(math.isnan(f) or (math.isfinite(f) and f > 0.0) for f in frequencies):
            raise InputError(f"measured frequencies of {name!r} must be positive", mend="give them in Hz")
        if not any(math.isfinite(f) for f in frequencies):
            raise InputError(f"no frequency of {name!r} was measured", mend="give at least one in Hz, or leave it out")
    corrections: list[Correction] = []
    for name, table in tables.items():
        heard = tuple(float(f) for f in measured.get(name, ()))
        terms, facts = evaluate(table, heard)
        found = _tell(name, table, terms, facts, heard)
        findings += found
        if any(finding.severity != "note" for finding in found):
            corrections += correct(name, table, heard)
    for link in rigid:
        findings += _rigid(link)
    return Audit(source, tuple(findings), tuple(corrections))


def _tell(
    name: str, table: Mapping[str, float], terms: Mapping[str, float], facts: Facts, heard: Sequence[float]
) -> list[Finding]:
    """The contradictions of a table in words; if there are none, what it implies."""
    found = []
    if terms["material"] > CONTRADICTION:
        beyond = facts.density > DENSEST or facts.density < LIGHTEST
        dimensions = " × ".join(f"{1e3 * table[key]:g}" for key in LENGTHS)
        what = f"{facts.mass:.4g} kg in {dimensions} mm is {facts.density:.0f} kg/m³, " + (
            "which no material has"
            if beyond
            else f"which no common material has together with E = {table['youngs_modulus'] / 1e9:.4g} GPa"
        )
        found.append(Finding("impossible" if beyond else "implausible", name, what))
    if terms.get("mass against density", 0.0) > CONTRADICTION:
        found.append(
            Finding(
                "impossible",
                name,
                f"mass {facts.mass:.4g} kg contradicts density {table['density']:g} kg/m³: the dimensions make it "
                f"{facts.density:.0f}",
            )
        )
    words = {
        "hub inertia": f"armature {table.get('hub_inertia', 0.0):g} kg·m² (hub inertia) is "
        f"{table.get('hub_inertia', 0.0) / (facts.mass * table['length'] ** 2 / 3.0):.3g} times the link's own",
        "payload": f"payload {table.get('payload', 0.0):g} kg is {table.get('payload', 0.0) / facts.mass:.3g} times the link",
        "slenderness": "its section is too large for its length to be a slender beam",
        "length": f"length {table['length']:g} m is not that of a machine's link",
    }
    found += [Finding("implausible", name, what) for term, what in words.items() if terms[term] > CONTRADICTION]
    own = own_frequencies(table, facts.mass, max(len(heard), 1))
    for k, f in enumerate(heard, start=1):
        if terms.get(f"frequency {k}", 0.0) > CONTRADICTION:
            found.append(
                Finding(
                    "implausible", name, f"bending mode {k} is at {own[k - 1]:.4g} Hz by the table, measured {f:g} Hz"
                )
            )
    clamped = strip_frequencies(
        table["youngs_modulus"] * table["width"] * table["thickness"] ** 3 / 12.0,
        facts.mass,
        table["length"],
        payload=table.get("payload", 0.0),
        clamped=True,
    )[0]
    found.append(
        Finding(
            "note",
            name,
            f"{facts.density:.0f} kg/m³ ({facts.material} is nearest); bends first at {own[0]:.4g} Hz on its hub, "
            f"{clamped:.4g} Hz clamped",
        )
    )
    return found


def _rigid(link: Link) -> list[Finding]:
    """What is doubtful about a rigid link's inertia."""
    found = []
    why = impossible(link.mass, np.asarray(link.inertia))
    if why is not None:
        found.append(Finding("impossible", link.name, why))
    if link.mass <= 0.0:
        return found
    moments = np.linalg.eigvalsh(np.asarray(link.inertia))
    distance = float(np.linalg.norm(link.com))
    largest = float(moments[-1])
    gyration = math.sqrt(max(largest, 0.0) / link.mass)
    if gyration > 10.0 * max(distance, 0.05):
        found.append(
            Finding(
                "implausible",
                link.name,
                f"radius of gyration {gyration:.3g} m with the centre of mass {distance:.3g} m from the joint: inertia in "
                "g·m², kg·mm² or a decimal point off?",
            )
        )
    # A slender uniform rod on its end has 1/3 of m d² about its centre and 4/3 of it about the joint.
    if distance > 0.0 and 1.25 < largest / (link.mass * distance**2) < 1.42 and moments[0] < 0.1 * largest:
        found.append(
            Finding(
                "note",
                link.name,
                f"inertia {largest:.4g} kg·m² is 4/3 m d² of a slender rod: given about the joint instead of the centre "
                "of mass?",
            )
        )
    return found
