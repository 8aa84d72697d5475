"""``denoc report``: saved results rendered again."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import console, output_options, write_json

FORMATS = ("html", "md", "csv", "junit", "json", "svg", "table")


@click.command()
@click.argument("results", metavar="RESULTS")
@click.option(
    "--format",
    "formats",
    multiple=True,
    type=click.Choice(FORMATS, case_sensitive=False),
    help="What to render, repeatable; svg: every picture as a file. Default: all but svg with --out, the table without.",
)
@output_options("Where to write; default: the folder of RESULTS.")
@click.option("--rows", "every_row", is_flag=True, help="Print every row, not a line for each group and what failed.")
def report(results: str, formats: tuple[str, ...], out: Path | None, json_file: str | None, every_row: bool) -> int:
    """Render RESULTS (a results.json, or the folder that holds one) again.

    \b
    Examples:
      denoc report results --format html
      denoc report results/results.json --format junit --out build/
    """
    from harness.cases.results import read_results
    from harness.report.terminal import print_results
    from harness.report.write import write_reports

    found = read_results(results)
    screen = console(json_file)
    files = tuple(name for name in formats if name != "table")
    if out is not None and not formats:
        files = tuple(name for name in FORMATS if name not in ("table", "svg"))
    if files:
        source = Path(results)
        folder = out if out is not None else (source if source.is_dir() else source.parent)
        for path in write_reports(found, folder, files):
            screen.print(f"wrote {path}", markup=False)
    write_json(found.to_text(), json_file)
    if not files or "table" in formats:
        print_results(found, screen, every_row=every_row)
    return 0
