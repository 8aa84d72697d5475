"""What an audit of a parameter table answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

_UNITS = {
    "length": "m",
    "width": "m",
    "thickness": "m",
    "mass": "kg",
    "density": "kg/m³",
    "youngs_modulus": "Pa",
    "armature": "kg·m²",
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

    rank: 1 for the best; those of equal scores share one, and only more evidence can part them.
    score: ½ χ² + Σ cost [nats], lower is better. probability: its share among all that was tried, which is
    no probability that it is true. agrees: no term of χ² above 9.
    density [kg/m³], material: what the corrected table implies. frequencies: on its hub, with its payload [Hz].
    """

    site: str
    rank: int
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
    def ties(self) -> tuple[tuple[Correction, ...], ...]:
        """Groups of corrections of a link of which one is as good as the other, the best first."""
        groups: dict[tuple[str, int], list[Correction]] = {}
        for correction in self.corrections:
            groups.setdefault((correction.site, correction.rank), []).append(correction)
        return tuple(tuple(group) for group in groups.values() if len(group) > 1)

    @property
    def worst(self) -> str:
        """Severity of the gravest finding, "note" if there is none."""
        found = {finding.severity for finding in self.findings}
        return next((severity for severity in ("impossible", "implausible") if severity in found), "note")

    @property
    def possible(self) -> bool:
        """Whether nothing stated is impossible or implausible."""
        return self.worst == "note"

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
