"""The table on the terminal."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

from rich.console import Console
from rich.table import Table
from rich.text import Text

from harness.cases.case import Row
from harness.cases.results import Results
from harness.report import words

COLOURS = {"pass": "green", "fail": "bold red", "skipped": "dim"}


def print_results(results: Results, console: Console, *, every_row: bool = False) -> None:
    """Print a table: a line for every case, quantity and engine, or (as a rule) the worst of each case and engine.

    Rows that failed are always printed in full.
    """
    table = Table(box=None, pad_edge=False, header_style="bold", expand=False)
    for head, justify in (
        ("case", "left"),
        ("quantity", "left"),
        ("engines", "left"),
        ("difference", "right"),
        ("allowed", "right"),
        ("unit", "left"),
        ("", "left"),
        ("note", "left"),
    ):
        # The note may wrap; figures may not.
        table.add_column(
            head, justify="right" if justify == "right" else "left", overflow="fold", no_wrap=head != "note"
        )
    rows = results.rows if every_row else _condensed(results)
    for group, members in groupby(rows, key=lambda item: item.group):
        table.add_section()
        table.add_row(Text(words.GROUP_TITLES.get(group, group), style="bold cyan"))
        for row in members:
            colour = COLOURS[row.verdict]
            note = row.note
            if row.first_divergence:
                note = "; ".join(filter(None, [note, words.divergence(row)]))
            table.add_row(
                Text(row.case),
                Text(words.quantity(row.quantity)),
                Text(words.engines(row)),
                Text(words.figure(row.difference, verdict=row.verdict), style=colour),
                Text(words.figure(row.allowed)),
                Text("" if row.verdict == "skipped" else words.unit(row)),
                Text(f"{words.MARKS[row.verdict]} {row.verdict}", style=colour),
                Text(note, style="dim"),
            )
    console.print(table)
    counts = (results.count("pass"), results.count("fail"), results.count("skipped"))
    text = words.headline(*counts)
    text = text[0].upper() + text[1:]
    if results.seconds == results.seconds:
        text += f", in {results.seconds:.0f} s"
    console.print(Text(text + ".", style="bold red" if counts[1] or not counts[0] else "bold green"))


def _condensed(results: Results) -> list[Row]:
    """The row closest to its limit for each case and pair of engines, and every failure."""
    shown: list[Row] = []
    for _, same_case in groupby(results.rows, key=lambda row: row.case):
        rows = list(same_case)
        for engines in dict.fromkeys(row.engines for row in rows):
            mine = [row for row in rows if row.engines == engines]
            failed = [row for row in mine if row.verdict == "fail"]
            passed = [row for row in mine if row.verdict == "pass"]
            shown += failed
            if passed and not failed:
                worst = max(passed, key=lambda row: row.ratio)
                more = len(passed) - 1
                text = f"{worst.note + '; ' if worst.note else ''}closest of {more + 1}" if more else worst.note
                shown.append(replace(worst, note=text))
            # That an engine lacks one quantity is in the files; that it is missing altogether belongs here.
            shown += [row for row in mine if row.verdict == "skipped" and row.quantity == "all"]
    return shown
