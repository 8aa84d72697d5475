"""Findings, one by one, with their numbers and rivals; as text, in a notebook, as a data frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from harness.diagnose.answer.significant_digits import best, ends
from harness.diagnose.answer.taken_away import none_left
from harness.notebook import frame, html_table, text_table
from harness.recording.units import written

MODIFIED_BY = "modified_by"  # of a finding: others that only alter how this one acts, such as creep of dry friction


def one_by_one(findings: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Findings and what modifies them, each by itself."""
    return [each for finding in findings for each in (finding, *finding.get(MODIFIED_BY, ()))]


def numbers_of(finding: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The parameters of a finding, and the zeros of recordings if it lists them, by name: ``value``, ``unit``, and their spread if
    it is known."""
    zeros = {
        f"zero of {zero['recording']}": {"value": zero["zero"], "unit": zero["unit"]}
        for zero in finding.get("zeros", ())
    }
    return {**finding["parameters"], **zeros}


def rivals_of(finding: Mapping[str, Any], spelled: Callable[[str], str] = str) -> list[str]:
    """What a finding cannot be told from, with what would have to stand beside it if it could only so.

    spelled: how an effect's key is written, such as ``in_words``.
    """
    beside = finding.get("only_beside", {})
    return [
        spelled(rival) + (f" (beside {' or '.join(map(spelled, beside[rival]))})" if rival in beside else "")
        for rival in finding.get("indistinguishable_from", ())
    ]


def in_words(key: str) -> str:
    """An effect's key as a sentence has it: ``base_tilt@base`` is base tilt at base; the site keeps its own spelling."""
    name, _, at = key.partition("@")
    return name.replace("_", " ") + (f" at {at}" if at else "")


def none_of_stated(finding: Mapping[str, Any], name: str) -> str:
    """That a parameter of a finding takes away all that the model states, and how much that was; nothing where it does not."""
    number = numbers_of(finding)[name]
    return none_left(finding["effect"], number["value"], number.get("std"), number.get("ci95"), written(number["unit"]))


HEADS = ("effect", "at", "parameter", "value", "95 % interval", "unit", "cannot be told from")


class Findings(list[Mapping[str, Any]]):
    """Findings as the document ``denoc.diagnosis/1`` has them, which show themselves as a table."""

    def rows(self) -> list[dict[str, Any]]:
        """A row a parameter (a finding without any has one too): effect, site, parameter, value, std, low, high, unit, …"""
        rows = []
        for finding in one_by_one(self):
            common = {"effect": finding["effect"], "site": finding["site"]}
            after = {
                "delta_bic": finding["evidence"].get("delta_bic"),
                "grade": finding.get("grade"),
                "indistinguishable_from": ", ".join(rivals_of(finding)),
            }
            for name, p in numbers_of(finding).items() or [("", {})]:
                low, high = p.get("ci95") or (None, None)
                number = {
                    "value": p.get("value"),
                    "std": p.get("std"),
                    "low": low,
                    "high": high,
                    "unit": p.get("unit", ""),
                }
                rows.append({**common, "parameter": name, **number, **after})
        return rows

    def to_frame(self) -> Any:
        """A ``pandas.DataFrame``, a row a parameter; ImportError where pandas is not installed."""
        rows = self.rows()
        names = rows[0] if rows else ("effect", "site", "parameter", "value", "std", "low", "high", "unit")
        return frame({name: [row[name] for row in rows] for name in names})

    def _written(self) -> list[tuple[str, ...]]:
        return [
            (
                row["effect"], row["site"], _with_remark(row),
                "" if row["value"] is None else best(row["value"], (row["low"], row["high"])),
                "" if row["low"] is None or row["high"] is None else ends((row["low"], row["high"])),
                written(row["unit"]), row["indistinguishable_from"],
            )
            for row in self.rows()
        ]  # fmt: skip

    def __str__(self) -> str:
        return text_table(HEADS, self._written()) if self else "nothing"

    def _repr_html_(self) -> str:
        return html_table(HEADS, self._written())


def _with_remark(row: Mapping[str, Any]) -> str:
    """A parameter's name, with what its number means where it takes away all that the model states."""
    rest = none_left(row["effect"], row["value"], row["std"], (row["low"], row["high"]), written(row["unit"]))
    return f"{row['parameter']} ({rest})" if rest else str(row["parameter"])
