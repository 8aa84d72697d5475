"""The table of what each engine's reader passes over, on the terminal and in JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.text import Text

from harness.cases.import_audit import SCHEMA, Ignored, as_dict
from harness.json_text import json_text

_COLOURS = {"acts": "green", "ignored": "bold red"}


def print_import_audit(found: Mapping[str, Sequence[Ignored]], console: Console) -> None:
    """A paragraph for each field, so that nothing is cut at any width: where, what, who reads it, what it costs."""
    for model, rows in found.items():
        console.print(Text(model, style="bold"))
        if not rows:
            console.print("  every field that acts is read by all")
        for row in rows:
            console.print(Text(f"  {row.field} at {row.site}: {row.value}".rstrip(": ")))
            line = Text("    ")
            for name, does in row.readers.items():
                line.append(f"{name}: ").append(does, style=_COLOURS.get(does, "yellow")).append("; ")
            line.append(costs(row))
            console.print(line)


def costs(row: Ignored) -> str:
    """What passing the field over costs, in words."""
    parts = []
    if row.force is not None:
        parts.append(f"up to {row.force:.3g} {row.units[0]}")
    if row.motion is not None:
        parts.append(f"{row.motion:.3g} {row.units[1]} within 2 s")
    if parts and not row.force and not row.motion:
        return f"costs nothing in the motions tried ({row.how})"
    return f"costs {' and '.join(parts)} ({row.how})" if parts else f"cost not known ({row.how})"


def import_audit_json(found: Mapping[str, Sequence[Ignored]]) -> str:
    """The document ``denoc.import/1``."""
    models = [{"model": model, "rows": [as_dict(row) for row in rows]} for model, rows in found.items()]
    return json_text({"schema": SCHEMA, "models": models})
