"""``denoc report``: saved results rendered again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import console, output_options, write_json

if TYPE_CHECKING:
    from rich.console import Console

    from harness.cases.results import Results

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
@click.option(
    "--against",
    metavar="BEFORE",
    help="Show what changed since this earlier run, the gravest first; with --out, comparison.html, .md and .json.",
)
@click.option("--rows", "every_row", is_flag=True, help="Print every row, not a line for each group and what failed.")
def report(
    results: str,
    formats: tuple[str, ...],
    against: str | None,
    out: Path | None,
    json_file: str | None,
    every_row: bool,
) -> int:
    """Render RESULTS (a results.json, or the folder that holds one) again.

    \b
    Examples:
      denoc report results --format html
      denoc report results/results.json --format junit --out build/
      denoc report results --against yesterday
    """
    from harness.cases.results import read_results
    from harness.errors import InputError
    from harness.report.terminal import print_results
    from harness.report.write import write_reports

    found = read_results(results)
    screen = console(json_file)
    if against is not None:
        if formats:
            raise InputError("--against and --format do not go together", mend="leave one out")
        return _compare(read_results(against), found, out, json_file, screen)
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


def _compare(before: Results, after: Results, out: Path | None, json_file: str | None, screen: Console) -> int:
    """Exit status 1 where something passes no more, is compared no more, or has another limit."""
    import json

    from harness.cases.between import between
    from harness.report.comparison import comparison_html, comparison_markdown, print_comparison
    from harness.whole_files import write_folder

    found = between(before, after)
    print_comparison(found, screen)
    text = json.dumps(found.to_json(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if out is not None:
        files: dict[str, str | bytes] = {
            "comparison.html": comparison_html(found),
            "comparison.md": comparison_markdown(found),
            "comparison.json": text,
        }
        for path in write_folder(out, files):
            screen.print(f"wrote {path}", markup=False)
    write_json(text, json_file)
    return int(found.worse)
