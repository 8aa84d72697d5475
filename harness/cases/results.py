"""What a run of the suite gives: rows, data for plots, versions; schema ``denoc.results/1``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from harness.cases.case import Row, Series
from harness.errors import InputError
from harness.notebook import frame, html_table

SCHEMA = "denoc.results/1"


@dataclass(frozen=True)
class Results:
    """Rows of the table, lines of the plots, and what they were made with.

    versions: package or engine name to version. titles: case name to its one-line title. created: ISO 8601, UTC.
    seconds: wall time of the whole run [s]; case_seconds: by case.
    """

    rows: tuple[Row, ...]
    series: tuple[Series, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    titles: Mapping[str, str] = field(default_factory=dict)
    created: str = ""
    seconds: float = math.nan
    case_seconds: Mapping[str, float] = field(default_factory=dict)

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
            "rows": [row_as_dict(row) for row in self.rows],
            "cases": {
                name: {"title": title, "seconds": _number(self.case_seconds.get(name, math.nan))}
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
        from harness.cases.table import text

        return text(self)

    def _counts(self) -> str:
        return ", ".join(f"{self.count(v)} {v}" for v in ("pass", "fail", "skipped"))

    def __repr__(self) -> str:
        return f"<Results: {self._counts()}>"

    def _repr_html_(self) -> str:
        """Every case on a line, worst comparison first, for notebooks."""
        from harness.cases.table import number

        worst: dict[str, Row] = {}
        for row in self.rows:
            if row.case not in worst or _share(row) > _share(worst[row.case]):
                worst[row.case] = row
        lines = [
            (
                case,
                row.quantity,
                " / ".join(row.engines),
                number(row.difference),
                number(row.allowed),
                row.unit,
                row.verdict,
            )
            for case, row in worst.items()
        ]
        heads = ("case", "worst in", "engines", "difference", "allowed", "unit", "verdict")
        return html_table(heads, lines, title=self._counts())


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
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(
            error.strerror or "cannot be read", source=path, mend="give the results.json of `denoc validate --out DIR`"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError("not a text file", source=path, mend="give a results.json") from error
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON: {error.msg}", source=path, line=error.lineno, column=error.colno) from error
    return from_dict(document, path)


def from_dict(document: object, source: str | Path | None = None) -> Results:
    """Results from the document ``denoc.results/1``; InputError if it is none."""
    schema = document.get("schema") if isinstance(document, dict) else None
    if not isinstance(document, dict) or schema != SCHEMA:
        raise InputError(
            f"schema is {schema!r}, not {SCHEMA!r}", source=source, mend="give the output of denoc validate"
        )
    known_row = {f.name for f in fields(Row)}
    known_series = {f.name for f in fields(Series)}
    try:
        rows = tuple(
            Row(**{k: v for k, v in {**row, "engines": tuple(row["engines"])}.items() if k in known_row})
            for row in document["rows"]
        )
        series = tuple(_series(line, known_series) for line in document.get("series", ()))
    except (KeyError, TypeError) as error:
        raise InputError(f"a row or series is incomplete: {error}", source=source, mend="write it again") from error
    cases = document.get("cases", {})
    seconds = document.get("seconds")
    return Results(
        rows,
        series,
        document.get("versions", {}),
        {name: facts.get("title", name) for name, facts in cases.items()},
        document.get("created", ""),
        math.nan if seconds is None else seconds,
        {name: facts["seconds"] for name, facts in cases.items() if facts.get("seconds") is not None},
    )


def _series(line: Mapping[str, Any], known: set[str]) -> Series:
    values: dict[str, Any] = {key: value for key, value in line.items() if key in known}
    for axis in ("x", "y"):
        values[axis] = tuple(_back(values[axis]))
    return Series(**values)


def _back(values: list[float | None]) -> list[float]:
    return [math.nan if value is None else value for value in values]
