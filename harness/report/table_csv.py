"""The table as CSV, every digit kept."""

from __future__ import annotations

import csv
import io
import json

from harness.cases.results import Results, row_as_dict

COLUMNS = (
    "group",
    "case",
    "quantity",
    "engines",
    "difference",
    "allowed",
    "unit",
    "verdict",
    "note",
    "why_allowed",
    "first_divergence",
    "source",
)


def table_csv(results: Results) -> str:
    """RFC 4180, one line a row; ``engines`` joined by ``+``, ``first_divergence`` as JSON."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\r\n")
    writer.writeheader()
    for row in results.rows:
        values = {key: value for key, value in row_as_dict(row).items() if key in COLUMNS}
        values["engines"] = "+".join(row.engines)
        if row.first_divergence:
            values["first_divergence"] = json.dumps(dict(row.first_divergence), ensure_ascii=False)
        writer.writerow({key: tame(value) for key, value in values.items()})
    return text.getvalue()


def tame(value: object) -> object:
    """The value as a cell that no spreadsheet runs."""
    # A spreadsheet would run text that starts like a formula.
    return "'" + value if isinstance(value, str) and value[:1] in ("=", "+", "-", "@") else value
