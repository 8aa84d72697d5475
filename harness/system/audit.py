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
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.system.description import Link, System
from harness.system.inertia import impossible
from harness.system.load import load
from harness.system.materials import DENSEST, LIGHTEST, MATERIALS
from harness.system.read_toml import read_toml
from harness.system.slips import Slip, slips
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
# A hundred thousand times less likely than the best [nats] is not worth a look.
LOST = 12.0
# A term of χ² above this (3σ) contradicts.
CONTRADICTION = 9.0
_SHOWN = 8
_LENGTHS = ("length", "width", "thickness")
_UNITS = {
    "length": "m",
    "width": "m",
    "thickness": "m",
    "mass": "kg",
    "density": "kg/m³",
    "youngs_modulus": "Pa",
    "hub_inertia": "kg·m²",
    "payload": "kg",
}


@dataclass(frozen=True)
class Finding:
    """Something a table says that cannot be, or hardly: severity "impossible", "implausible" or "note"."""

    severity: str
    site: str
    what: str


@dataclass(frozen=True)
class Change:
    """One number put right: stated and corrected value in SI, and the slip that made the one of the other."""

    quantity: str
    stated: float
    corrected: float
    slip: str


@dataclass(frozen=True)
class Correction:
    """A set of changes that would explain the table of a link.

    score: ½ χ² + Σ cost [nats], lower is better. probability: among all that was tried. agrees: no term of χ² above 9.
    density [kg/m³], material: what the corrected table implies. frequencies: on its hub, with its payload [Hz].
    """

    site: str
    changes: tuple[Change, ...]
    score: float
    probability: float
    agrees: bool
    density: float
    material: str
    frequencies: tuple[float, ...]

    def __str__(self) -> str:
        told = [
            f"{c.quantity} {c.stated:g} → {c.corrected:g} {_UNITS[c.quantity]} ({c.slip})" for c in self.changes
        ] or ["as it stands"]
        told_frequencies = ", ".join(f"{f:.4g}" for f in self.frequencies)
        return (
            f"{self.site}: {'; '.join(told)}: {self.density:.0f} kg/m³ ({self.material}), bends at {told_frequencies} Hz;"
            f" score {self.score:.1f}"
        )


@dataclass(frozen=True)
class Audit:
    """What an audit found: findings, and for each link that needs them the ranked corrections."""

    source: str
    findings: tuple[Finding, ...]
    corrections: tuple[Correction, ...]

    @property
    def possible(self) -> bool:
        """Whether nothing stated is impossible or implausible."""
        return all(finding.severity == "note" for finding in self.findings)

    def to_json(self) -> dict[str, Any]:
        """The same for programs, schema ``denoc.audit/1``."""
        return {
            "schema": "denoc.audit/1",
            "source": self.source,
            "possible": self.possible,
            "findings": [vars(finding) for finding in self.findings],
            "corrections": [
                vars(c) | {"changes": [vars(change) for change in c.changes], "frequencies": list(c.frequencies)}
                for c in self.corrections
            ],
        }


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
    tables, rigid, source = _gather(system, findings)
    for name, frequencies in measured.items():
        if name not in tables:
            known = ", ".join(tables) or "none"
            raise InputError(
                f"link {name!r} has measured frequencies but is not a flexible link", mend=f"known: {known}"
            )
        if not all(math.isnan(f) or (math.isfinite(f) and f > 0.0) for f in frequencies):
            raise InputError(f"measured frequencies of {name!r} must be positive", mend="give them in Hz")
    corrections: list[Correction] = []
    for name, table in tables.items():
        heard = tuple(float(f) for f in measured.get(name, ()))
        terms, facts = _evaluate(table, heard)
        found = _tell(name, table, terms, facts, heard)
        findings += found
        if any(finding.severity != "note" for finding in found):
            corrections += _correct(name, table, heard)
    for link in rigid:
        findings += _rigid(link)
    return Audit(source, tuple(findings), tuple(corrections))


def _gather(
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
        raw = None if text.lstrip().startswith("<") else tomllib.loads(text)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
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
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value) or value < 0.0:
                raise InputError(
                    f"link {name!r}: {key} is {value!r}", mend="an audit needs a positive number", source=source
                )
        table = _positive({key: float(value) for key, value in values.items()})
        missing = [key for key in (*_LENGTHS, "youngs_modulus") if key not in table]
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


@dataclass(frozen=True)
class _Facts:
    """What a table implies: density [kg/m³], mass [kg], nearest material."""

    density: float
    mass: float
    material: str


def _evaluate(
    table: Mapping[str, float], heard: Sequence[float], *, worst: float = math.inf
) -> tuple[dict[str, float], _Facts]:
    """χ² by term, and what the table implies; frequencies are left out once the rest is above ``worst``."""
    length, width, thickness = (table[key] for key in _LENGTHS)
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
        for k, (f, own) in enumerate(zip(heard, _frequencies(table, mass, len(heard)), strict=True), start=1):
            if not math.isnan(f):
                terms[f"frequency {k}"] = (math.log(own / f) / FREQUENCY_SIGMA) ** 2
    return terms, _Facts(density, mass, MATERIALS[nearest].name)


def _outside(value: float, bounds: tuple[float, float]) -> float:
    """Distance of a value from a range, in logarithms; zero inside."""
    return max(math.log(bounds[0] / value), math.log(value / bounds[1]), 0.0)


def _beyond(ratio: float) -> float:
    """Soft doubt about a ratio above one."""
    return (math.log(ratio) / USUAL_SIGMA) ** 2 if ratio > 1.0 else 0.0


def _frequencies(table: Mapping[str, float], mass: float, count: int) -> tuple[float, ...]:
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


def _tell(
    name: str, table: Mapping[str, float], terms: Mapping[str, float], facts: _Facts, heard: Sequence[float]
) -> list[Finding]:
    """The contradictions of a table in words; if there are none, what it implies."""
    found = []
    if terms["material"] > CONTRADICTION:
        beyond = facts.density > DENSEST or facts.density < LIGHTEST
        dimensions = " × ".join(f"{1e3 * table[key]:g}" for key in _LENGTHS)
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
        "hub inertia": f"hub inertia {table.get('hub_inertia', 0.0):g} kg·m² is "
        f"{table.get('hub_inertia', 0.0) / (facts.mass * table['length'] ** 2 / 3.0):.3g} times the link's own",
        "payload": f"payload {table.get('payload', 0.0):g} kg is {table.get('payload', 0.0) / facts.mass:.3g} times the link",
        "slenderness": "its section is too large for its length to be a slender beam",
        "length": f"length {table['length']:g} m is not that of a machine's link",
    }
    found += [Finding("implausible", name, what) for term, what in words.items() if terms[term] > CONTRADICTION]
    own = _frequencies(table, facts.mass, max(len(heard), 1))
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


_Changes = tuple[tuple[str, Slip], ...]


@dataclass(frozen=True)
class _Trial:
    """A set of undone slips: their cost, and the score without and with frequencies (inf where not worth computing)."""

    changes: _Changes
    cost: float
    plain: float
    score: float


def _correct(name: str, table: Mapping[str, float], heard: Sequence[float]) -> list[Correction]:
    """The best sets of one or two undone slips, of three where two do not suffice; ranked, the table as it stands too."""
    trials = [_try(table, heard, (), 0.0, math.inf)]

    def extend(bases: Sequence[_Trial]) -> None:
        best = min(trial.score for trial in trials)
        for base in bases:
            touched = {key for key, _ in base.changes}
            for changes, cost in singles:
                if base.cost + cost > best + LOST or touched & {key for key, _ in changes}:
                    continue
                key = _key(base.changes + changes)
                if key not in seen:
                    seen.add(key)
                    trial = _try(table, heard, base.changes + changes, base.cost + cost, best)
                    best = min(best, trial.score)
                    trials.append(trial)

    singles = _singles(table)
    seen = {_key(())}
    extend(trials[:1])
    pairs_from = len(trials)
    extend(trials[1:pairs_from])
    first = min(trials, key=lambda t: t.score)
    if not _correction(name, table, heard, first, 1.0).agrees:
        # Two do not suffice. A third is tried on the best pairs only: best at all, and best before frequencies, which
        # a third may mend.
        pairs = trials[pairs_from:]
        chosen = sorted(pairs, key=lambda t: t.score)[:100] + sorted(pairs, key=lambda t: t.plain)[:200]
        extend(list(dict.fromkeys(chosen)))
    ranked = sorted(trials, key=lambda t: t.score)
    total = sum(math.exp(ranked[0].score - trial.score) for trial in ranked)
    return [
        _correction(name, table, heard, trial, math.exp(ranked[0].score - trial.score) / total)
        for trial in ranked[:_SHOWN]
        if math.isfinite(trial.score)
    ]


def _singles(table: Mapping[str, float]) -> list[tuple[_Changes, float]]:
    singles: list[tuple[_Changes, float]] = []
    for key, value in table.items():
        singles += [(((key, slip),), slip.cost) for slip in slips(value, length=key in _LENGTHS)]
    # One slip for all lengths at once: the whole drawing in millimetres or centimetres.
    for factor, unit in ((1e-3, "mm"), (1e-2, "cm")):
        together = tuple((key, Slip(table[key] * factor, f"lengths in {unit}", 0.0)) for key in _LENGTHS)
        singles.append((together, math.log(100.0 * 2.0)))
    return singles


def _key(changes: _Changes) -> frozenset[tuple[str, float]]:
    return frozenset((quantity, round(math.log(slip.value), 9)) for quantity, slip in changes)


def _corrected(table: Mapping[str, float], changes: _Changes) -> dict[str, float]:
    return dict(table) | {key: slip.value for key, slip in changes}


def _try(table: Mapping[str, float], heard: Sequence[float], changes: _Changes, cost: float, best: float) -> _Trial:
    """Score a set of slips; without frequencies if it is lost before them."""
    terms, _ = _evaluate(_corrected(table, changes), heard, worst=2.0 * (best + LOST - cost))
    plain = cost + 0.5 * sum(value for key, value in terms.items() if not key.startswith("frequency"))
    score = cost + 0.5 * sum(terms.values())
    if any(not math.isnan(f) for f in heard) and plain > best + LOST:
        score = math.inf
    return _Trial(changes, cost, plain, score)


def _correction(
    name: str, table: Mapping[str, float], heard: Sequence[float], trial: _Trial, probability: float
) -> Correction:
    corrected = _corrected(table, trial.changes)
    terms, facts = _evaluate(corrected, heard)
    return Correction(
        site=name,
        changes=tuple(Change(key, table[key], slip.value, slip.what) for key, slip in trial.changes),
        score=trial.score,
        probability=probability,
        agrees=all(term <= CONTRADICTION for key, term in terms.items() if key != "rarity"),
        density=facts.density,
        material=facts.material,
        frequencies=_frequencies(corrected, facts.mass, max(len(heard), 1)),
    )


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
