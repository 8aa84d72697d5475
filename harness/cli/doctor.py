"""``denoc doctor``: what is installed and whether it works."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import console, output_options, write_json


@click.command()
@output_options("Write doctor.json there.")
def doctor(out: Path | None, json_file: str | None) -> int:
    """List the engines, their versions, and a tiny run of each.

    \b
    Example:
      denoc doctor
    """
    import json

    from rich.table import Table
    from rich.text import Text

    from harness.cases.examine import examine, surroundings

    found = examine()
    around = surroundings()
    screen = console(json_file)
    table = Table(box=None, header_style="bold", pad_edge=False)
    for head in ("engine", "version", "tiny run", "what came out"):
        table.add_column(head, overflow="fold")
    for engine in found:
        colour = {"works": "green", "missing": "yellow"}.get(engine.state, "bold red")
        table.add_row(engine.name, engine.version or "–", Text(engine.state, style=colour), Text(engine.said))
    screen.print(table)
    for name, value in around.items():
        screen.print(f"{name}: {value}", markup=False)
    document = json.dumps(
        {"schema": "denoc.doctor/1", "engines": [vars(e) for e in found], "surroundings": around},
        indent=1,
        ensure_ascii=False,
    )
    if out is not None:
        from harness.report.files import write_folder

        write_folder(out, {"doctor.json": document + "\n"})
    write_json(document, json_file)
    broken = [engine for engine in found if engine.state == "broken"]
    return 1 if broken else 0
