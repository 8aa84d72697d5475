"""What was found: the table of findings, how they repeat from recording to recording, how they hang together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.diagnose.answer.diagnosis import numbers_of, one_by_one
from harness.diagnose.answer.findings import in_words, none_of_stated, rivals_of
from harness.diagnose.answer.significant_digits import best, ends, rounded
from harness.recording.units import written
from harness.report.diagnosis.figures import correlated, repeated
from harness.report.diagnosis.sections.figure import Document, points


@dataclass(frozen=True)
class Findings:
    anchor: str = "findings"
    title: str = "What was found"
    template: str = "diagnosis_findings.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        found = one_by_one(document["findings"])
        if not found:
            return None
        rows = []
        for finding in found:
            common = {
                "effect": finding["effect"].replace("_", " "),
                "site": finding["site"],
                "grade": finding.get("grade"),
                "bic": (finding.get("evidence") or {}).get("delta_bic"),
                "rivals": ", ".join(rivals_of(finding, in_words)),
            }
            numbers = numbers_of(finding)
            rows += [
                {
                    **common, "parameter": name.replace("_", " "), "remark": none_of_stated(finding, name), "number": p["value"],
                    "value": best(p["value"], p.get("ci95")), "interval": ends(p.get("ci95")),
                    "unit": written(p["unit"]),
                }
                for name, p in numbers.items()
            ] or [{**common, "parameter": "", "remark": "", "number": None, "value": "", "interval": "", "unit": ""}]  # fmt: skip
        return {"rows": rows, "graded": any(row["grade"] for row in rows), "figure": rounded, "points": points}


@dataclass(frozen=True)
class Repeatability:
    anchor: str = "repeatability"
    title: str = "The same from recording to recording?"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        pictures = []
        every = [each for finding in one_by_one(document["findings"]) for each in _listed(finding.get("repeatability"))]
        how = (
            "with one recording left out"
            if any(each.get("left_out") for each in every)
            else "from each recording alone"
        )
        for finding in one_by_one(document["findings"]):
            for name, rows in by_parameter(finding.get("repeatability")).items():
                told = (finding["parameters"].get(name) or {}).get("unit", "1")
                where = f"{finding['effect'].replace('_', ' ')} at {finding['site']}"
                caption = f"{where}: {name.replace('_', ' ')} {how}, 95 %"
                overall = finding["parameters"].get(name)
                svg = repeated(rows, overall, name.replace("_", " "), written(told), f"repeat-{where}-{name}")
                pictures.append((caption, Markup(svg)))
        words = f"Estimate and interval {how}; shaded, what all of them give together."
        return {"words": words, "pictures": pictures} if pictures else None


def _listed(repeatability: Any) -> list[Mapping[str, Any]]:
    return [] if isinstance(repeatability, Mapping) else list(repeatability or ())


def by_parameter(repeatability: Any) -> dict[str, list[Mapping[str, Any]]]:
    """Rows (recording, value, ci95) by parameter, of what a finding says of its repeatability.

    Told by recording (``parameters`` of each), by row (``parameter`` of each), or by parameter (its rows).
    """
    rows: dict[str, list[Mapping[str, Any]]] = {}
    if isinstance(repeatability, Mapping):
        return {name: [row for row in told if row.get("value") is not None] for name, told in repeatability.items()}
    for each in repeatability or ():
        told = each.get("parameters") or {each.get("parameter", ""): each}
        for name, one in told.items():
            if name and one.get("value") is not None:
                rows.setdefault(name, []).append(
                    {"recording": ("without " if each.get("left_out") else "") + each["recording"], **one}
                )
    return rows


@dataclass(frozen=True)
class Correlations:
    anchor: str = "correlations"
    title: str = "How the estimates hang together"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        told = document.get("correlations")
        if not told:
            return None
        caption = "Correlations of the estimates"
        words = (
            "Near ±1 the recordings tell only a combination of the two, and neither by itself. Nominal quantities are listed "
            "where an estimate leans on them."
        )
        return {"words": words, "pictures": [(caption, Markup(correlated(told)))]}
