"""The answer about a fleet, immutable, for people and programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.fleet.kept import answers
from harness.fleet.units import Unit
from harness.notebook import frame, html_table, text_table

HEADS = ("effect", "at", "established", "likely", "possible", "of units")


@dataclass(frozen=True, eq=False)
class Fleet:
    """What the diagnoses of a fleet say together. document: ``denoc.fleet/1``; folder: where each unit's answer is kept."""

    document: Mapping[str, Any]
    folder: Path
    units: tuple[Unit, ...]

    @property
    def effects(self) -> Sequence[Mapping[str, Any]]:
        """Which units have which effect, by grade."""
        found: Sequence[Mapping[str, Any]] = self.document["effects"]
        return found

    @property
    def parameters(self) -> Sequence[Mapping[str, Any]]:
        """How each number is spread over the units that have it."""
        found: Sequence[Mapping[str, Any]] = self.document["parameters"]
        return found

    @property
    def outliers(self) -> Sequence[Mapping[str, Any]]:
        """Units whose number lies apart from the others'."""
        found: Sequence[Mapping[str, Any]] = self.document["outliers"]
        return found

    @property
    def failed(self) -> Sequence[Mapping[str, Any]]:
        """Units that could not be diagnosed, with the line that says why."""
        found: Sequence[Mapping[str, Any]] = self.document["failed"]
        return found

    def answers(self) -> Iterator[tuple[str, dict[str, Any] | None]]:
        """Name and answer (``denoc.unit/1``) of each unit, read one after another."""
        return answers(self.folder, self.units)

    def to_json(self) -> dict[str, Any]:
        """The document ``denoc.fleet/1`` as plain data."""
        return dict(self.document)

    def to_frame(self) -> Any:
        """How numbers are spread as a ``pandas.DataFrame``, a row a parameter; ImportError where pandas is not installed."""
        rows = [
            {
                **{key: row[key] for key in ("effect", "site", "parameter", "unit", "number", "median", "within")},
                "mean": row["mean"]["value"], "mean_std": row["mean"]["std"], "between": row["between"]["value"],
                "outliers": row["outliers"],
            }
            for row in self.parameters
        ]  # fmt: skip
        names = rows[0] if rows else ("effect", "site", "parameter", "unit", "number", "median")
        return frame({name: [row[name] for row in rows] for name in names})

    def _rows(self) -> list[tuple[str, ...]]:
        grades = ("established", "likely", "possible")
        return [
            (row["effect"], row["site"], *(str(len(row[grade])) for grade in grades), str(self.document["diagnosed"]))
            for row in self.effects
        ]

    def __str__(self) -> str:
        return text_table(HEADS, self._rows()) if self.effects else "nothing"

    def _repr_html_(self) -> str:
        return html_table(HEADS, self._rows())
