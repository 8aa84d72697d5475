"""What a run of the suite gives: rows, data for plots, versions; schema ``denoc.results/1``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from harness.cases.case import Doubt, Row, Series
from harness.cases.json_file import read_json, shaped
from harness.cases.table import aligned
from harness.errors import InputError
from harness.notebook import frame, html_table

SCHEMA = "denoc.results/1"
VERDICTS = ("pass", "fail", "skipped")
LARGEST = 1e200  # of a plot: axes around larger numbers overflow
_MEND = "give the results.json of `denoc validate --out DIR`"


@dataclass(frozen=True)
class Results:
    """Rows of the table, lines of the plots, and what they were made with.

    versions: package or engine name to version. titles: case name to its one-line title. created: ISO 8601, UTC.
    notes: case name to what reading its model left out or found otherwise read by another tool, one line each.
    seconds: wall time of the whole run [s]; case_seconds: by case. doubts: what an audit finds in models of the user's own.
    """

    rows: tuple[Row, ...]
    series: tuple[Series, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    titles: Mapping[str, str] = field(default_factory=dict)
    created: str = ""
    seconds: float = math.nan
    case_seconds: Mapping[str, float] = field(default_factory=dict)
    doubts: tuple[Doubt, ...] = ()
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def told(self) -> tuple[str, ...]:
        """All notes, each with the case that it is of."""
        return tuple(f"{case}: {note}" for case, notes in self.notes.items() for note in notes)

    @property
    def ok(self) -> bool:
        """Whether something was compared and no row failed."""
        return not self.failed and any(row.verdict == "pass" for row in self.rows)

    @property
    def failed(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.verdict == "fail")

    def count(self, verdict: str) -> int:
        """Number of rows with that verdict."""
        return sum(row.verdict == verdict for row in self.rows)

    def to_json(self) -> dict[str, Any]:
        """The document ``denoc.results/1`` as plain Python values, free of NaN."""
        return {
            "schema": SCHEMA,
            "created": self.created,
            "seconds": _number(self.seconds),
            "versions": dict(self.versions),
            "summary": {verdict: self.count(verdict) for verdict in ("pass", "fail", "skipped")},
            "warnings": [asdict(doubt) for doubt in self.doubts],
            "notes": list(self.told),
            "rows": [row_as_dict(row) for row in self.rows],
            "cases": {
                name: {
                    "title": title,
                    "seconds": _number(self.case_seconds.get(name, math.nan)),
                    "notes": list(self.notes.get(name, ())),
                }
                for name, title in self.titles.items()
            },
            "series": [_series_as_dict(series) for series in self.series],
        }

    def to_text(self) -> str:
        """The same as JSON text."""
        return json.dumps(self.to_json(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"

    def to_frame(self) -> Any:
        """A ``pandas.DataFrame``, a row a comparison; ImportError where pandas is not installed."""
        rows = [row_as_dict(row) for row in self.rows]
        names = [f.name for f in fields(Row) if f.name != "first_divergence"]
        columns: dict[str, list[Any]] = {name: [row[name] for row in rows] for name in names}
        columns["engines"] = [" / ".join(row.engines) for row in self.rows]
        return frame(columns)

    def __str__(self) -> str:
        return aligned(self.rows)

    def __repr__(self) -> str:
        from harness.cases.table import counts

        return f"<Results: {counts(self.rows)}>"

    def _repr_html_(self) -> str:
        """Every case on a line, worst comparison first, for notebooks."""
        from harness.cases.table import cells, counts

        worst: dict[str, Row] = {}
        for row in self.rows:
            if row.case not in worst or _share(row) > _share(worst[row.case]):
                worst[row.case] = row
        lines = [(case, *cells(row)) for case, row in worst.items()]
        heads = ("case", "worst in", "engines", "difference", "allowed", "unit", "verdict")
        return html_table(heads, lines, title=counts(self.rows))


def _share(row: Row) -> float:
    """How far a comparison is towards its limit; what failed comes before all, what was skipped after."""
    if row.verdict == "skipped":
        return -1.0
    if row.verdict == "fail":
        return math.inf
    return row.ratio


def row_as_dict(row: Row) -> dict[str, Any]:
    """A row as plain Python values; a difference that is not a finite number becomes null."""
    values = {f.name: getattr(row, f.name) for f in fields(row)}
    values["engines"] = list(row.engines)
    values["difference"] = _number(row.difference)
    values["allowed"] = _number(row.allowed)
    values["first_divergence"] = None if row.first_divergence is None else dict(row.first_divergence)
    return values


def _series_as_dict(series: Series) -> dict[str, Any]:
    values = asdict(series)
    for axis in ("x", "y"):
        values[axis] = [_number(value) for value in values[axis]]
    return values


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def read_results(path: str | Path) -> Results:
    """Results as ``denoc validate`` wrote them: the JSON file, or the folder that holds ``results.json``.

    Raises InputError for a missing file, broken JSON or another schema.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "results.json"
    document = read_json(path, mend=_MEND)
    return from_dict(document, path)


def from_dict(document: object, source: str | Path | None = None) -> Results:
    """Results from the document ``denoc.results/1``; InputError if it is none."""
    schema = document.get("schema") if isinstance(document, dict) else None
    if not isinstance(document, dict) or schema != SCHEMA:
        raise InputError(
            f"schema is {repr(schema)[:80]}, not {SCHEMA!r}", source=source, mend="give the output of denoc validate"
        )
    found = shaped(document, _Document, source=source, mend=_MEND)
    for row in found.rows:
        if not row.engines:
            raise InputError(f"row {row.key[:120]} names no engine", source=source, mend=_MEND)
        if row.verdict not in VERDICTS:
            raise InputError(f"row {row.key[:120]} has the verdict {row.verdict[:40]!r}", source=source, mend=_MEND)
    for line in found.series:
        where = f"a line of {line.case[:60]}, {line.figure[:40]}, {line.label[:60]!r},"
        if len(line.x) != len(line.y):
            raise InputError(f"{where} has {len(line.x)} x and {len(line.y)} y", source=source, mend=_MEND)
        if any(value is not None and abs(value) > LARGEST for value in (*line.x, *line.y, *line.marks.values())):
            raise InputError(f"{where} has a number beyond {LARGEST:g}", source=source, mend=_MEND)
    return Results(
        found.rows,
        tuple(line.series() for line in found.series),
        found.versions,
        {name: facts.title or name for name, facts in found.cases.items()},
        found.created,
        math.nan if found.seconds is None else found.seconds,
        {name: facts.seconds for name, facts in found.cases.items() if facts.seconds is not None},
        found.warnings,
        {name: facts.notes for name, facts in found.cases.items() if facts.notes},
    )


@dataclass(frozen=True)
class _Case:
    title: str = ""
    seconds: float | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Line(Series):
    """A line of a plot as it stands in the file: what is not a finite number is null there."""

    x: tuple[float | None, ...]  # type: ignore[assignment]
    y: tuple[float | None, ...]  # type: ignore[assignment]

    def series(self) -> Series:
        values = {f.name: getattr(self, f.name) for f in fields(Series)}
        for axis in ("x", "y"):
            values[axis] = tuple(math.nan if value is None else value for value in values[axis])
        return Series(**values)


@dataclass(frozen=True)
class _Document:
    """``denoc.results/1``; members that it does not know are passed over."""

    schema: str
    rows: tuple[Row, ...]
    series: tuple[_Line, ...] = ()
    versions: dict[str, str] = field(default_factory=dict)
    cases: dict[str, _Case] = field(default_factory=dict)
    created: str = ""
    seconds: float | None = None
    warnings: tuple[Doubt, ...] = ()
