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

    from rich.text import Text

    from harness.cases.examine import examine, surroundings
    from harness.report.columns import print_table

    found = examine()
    around = surroundings()
    screen = console(json_file)
    lines = []
    for engine in found:
        colour = {"works": "green", "missing": "yellow"}.get(engine.state, "bold red")
        lines.append((engine.name, engine.version or "–", Text(engine.state, style=colour), engine.said))
    print_table(screen, ("engine", "version", "tiny run", "what came out"), lines)
    for name, value in around.items():
        screen.print(f"{name}: {value}", markup=False)
    document = json.dumps(
        {"schema": "denoc.doctor/1", "engines": [vars(e) for e in found], "surroundings": around},
        indent=1,
        ensure_ascii=False,
    )
    if out is not None:
        from harness.whole_files import write_folder

        write_folder(out, {"doctor.json": document + "\n"})
    write_json(document, json_file)
    broken = [engine for engine in found if engine.state == "broken"]
    return 1 if broken else 0
