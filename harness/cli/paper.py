"""``denoc paper``: the paper's figures and the questions it leaves, computed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import console, output_options, progress, write_json

if TYPE_CHECKING:
    from harness.cases.paper.study import Table


@click.command()
@click.argument("what", type=click.Choice(["figures", "equations", "departure", "damping", "links"]))
@click.option("--quick", is_flag=True, help="Fewer angles, lengths, modes and elements: a look in a minute.")
@click.option(
    "--seed",
    type=int,
    metavar="N",
    help="Of what is concealed (damping, departure); default: a fresh one, which is told.",
)
@output_options("Write the tables (.md), pictures (.svg) and the document (.json) there.")
def paper(what: str, quick: bool, seed: int | None, out: Path | None, json_file: str | None) -> int:
    """Compute what the paper shows, or leaves open.

    \b
    figures   figures 6(a), 6(b), 7(a), 7(b) as the paper's sensors would have shown them; its numbers beside ours
    equations what equation (10) as printed leaves out, asked of a recording made by finite elements
    departure when a linear model leaves recordings of five kinds of non-linear damping, by release
    damping   its open question: which non-linear damping is it, how many seconds and which release it takes to know
    links     arms of two and three links, rigid and flexible, native against finite elements

    \b
    Example:
      denoc paper figures --out figures
    """
    import secrets

    from harness.report.columns import print_table
    from harness.report.files import write_folder
    from harness.report.json_text import json_text
    from harness.report.paper import drawn, markdown_table, series_document

    screen = console(json_file)
    heads: tuple[str, ...]
    tables: dict[str, Table]
    if what == "figures":
        from harness.cases.paper.figures import figures

        made = figures()
        heads = ("what", "where", "published", "ours", "why")
        tables = {"facts": (heads, [(f.what, f.where, f.published, f.ours, f.note) for f in made.facts])}
        series, numbers = made.series, dict(made.numbers)
    elif what == "equations":
        from harness.cases.paper.equations import equations

        asked = equations()
        tables, series, numbers = dict(asked.tables), asked.series, dict(asked.numbers)
    elif what in ("damping", "departure"):
        from harness.proof.paper_damping import damping, departures

        chosen = secrets.randbelow(2**31) if seed is None else seed
        if what == "departure":
            told = departures(chosen)
        else:
            with progress("damping") as step:
                told = damping(chosen, quick=quick, progress=step)
        tables, series, numbers = dict(told.tables), told.series, {"seed": chosen, **told.numbers}
        screen.print(f"seed {chosen}")
    else:
        from harness.cases.paper.links import links

        with progress("links") as step:
            study = links(quick=quick, progress=step)
        tables, series, numbers = dict(study.tables), study.series, dict(study.numbers)
    for name, (heads, rows) in tables.items():
        print_table(screen, heads, rows, title=name.replace("_", " "))
    document = json_text(
        {
            "schema": "denoc.paper/1",
            "what": what,
            "numbers": numbers,
            "tables": {
                name: {"heads": list(heads), "rows": [list(r) for r in rows]} for name, (heads, rows) in tables.items()
            },
            "series": series_document(series),
        }
    )
    if out is not None:
        files = {f"{name}.md": markdown_table(heads, rows) for name, (heads, rows) in tables.items()}
        for path in write_folder(out, {**files, **drawn(series), f"{what}.json": document}):
            screen.print(f"wrote {path}", markup=False)
    write_json(document, json_file)
    return 0
