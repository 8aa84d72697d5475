"""The table on the terminal."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from itertools import groupby

from rich.console import Console
from rich.text import Text

from harness.cases.case import Row
from harness.cases.results import Results
from harness.report import words
from harness.report.columns import Heading, figures, print_table

COLOURS = {"pass": "green", "fail": "bold red", "skipped": "dim"}
# Cases of one reason that are named on the terminal; the rest are counted.
NAMED = 4
# A file read otherwise: the same reason for each quantity that was compared.
_HOW_FAR = re.compile(r", up to \S+ \S+ apart(?=:)")


def print_results(results: Results, console: Console, *, every_row: bool = False) -> None:
    """Print a line for each group (for each model of the user's own), then what failed, what was not possible and why.

    What is doubtful about the models themselves is told in any case.

    every_row: a line for each row instead.
    """
    if every_row:
        _print_rows(results.rows, console)
    else:
        _print_groups(results.rows, console)
        if results.failed:
            console.print(Text("\nFailed", style="bold red"))
            _print_rows(results.failed, console, headed=False)
        skipped = [row for row in results.rows if row.verdict == "skipped"]
        if skipped:
            console.print(Text("\nNot possible", style="bold"))
            _print_reasons(skipped, console)
    if results.doubts:
        console.print(Text("\nWarnings", style="bold yellow"))
        lines = [(Text(d.case), Text(d.site), Text(d.severity, style="yellow"), Text(d.what)) for d in results.doubts]
        print_table(console, ("model", "link", "", "what"), lines)
    if results.rows:
        console.print()
    counts = (results.count("pass"), results.count("fail"), results.count("skipped"))
    text = words.headline(*counts)
    text = text[0].upper() + text[1:]
    if results.doubts:
        text += f"; {len(results.doubts)} warning{'s' * (len(results.doubts) > 1)} about the models themselves"
    if results.seconds == results.seconds:
        text += f", in {results.seconds:.0f} s"
    console.print(Text(text + ".", style="bold red" if counts[1] or not counts[0] else "bold green"))


def _print_groups(rows: Sequence[Row], console: Console) -> None:
    lines = []
    for name, members in _groups(rows):
        compared = [row for row in members if row.verdict != "skipped"]
        failed = sum(row.verdict == "fail" for row in members)
        worst = max(compared, key=_share, default=None)
        lines.append(
            (
                Text(name, style="cyan"),
                str(len({row.case for row in members})),
                str(len(compared)),
                Text(str(failed), style=COLOURS["fail"] if failed else ""),
                str(len(members) - len(compared)),
                "–" if worst is None else Text(words.share(worst), style=COLOURS[worst.verdict]),
                "" if worst is None else _where(worst, name),
            )
        )
    heads = (
        "group", figures("cases"), figures("rows"), figures("failed"), figures("not possible"), figures("worst share of allowed"),
        "where",
    )  # fmt: skip
    print_table(console, heads, lines)


def _where(row: Row, line: str) -> str:
    case = "" if row.case == line else f"{row.case}: "
    return f"{case}{words.quantity(row.quantity)}, {words.engines(row)}"


def _groups(rows: Sequence[Row]) -> Iterable[tuple[str, list[Row]]]:
    for group, members in groupby(rows, key=lambda row: row.group):
        if group != "models":
            yield words.GROUP_TITLES.get(group, group), list(members)
            continue
        for case, own in groupby(members, key=lambda row: row.case):
            yield case, list(own)


def _share(row: Row) -> float:
    return row.ratio if math.isfinite(row.ratio) else math.inf


def _print_rows(rows: Sequence[Row], console: Console, *, headed: bool = True) -> None:
    lines: list[Heading | tuple[Text, ...]] = []
    for group, members in groupby(rows, key=lambda row: row.group):
        if headed:
            lines.append(Heading(words.GROUP_TITLES.get(group, group)))
        lines += [_cells(row) for row in members]
    heads = ("case", "quantity", "engines", figures("difference"), figures("allowed"), "unit", "", "note")
    print_table(console, heads, lines)


def _cells(row: Row) -> tuple[Text, ...]:
    colour = COLOURS[row.verdict]
    note = "; ".join(filter(None, [row.note, words.divergence(row)]))
    return (
        Text(row.case),
        Text(words.quantity(row.quantity)),
        Text(words.engines(row)),
        Text(words.figure(row.difference, verdict=row.verdict), style=colour),
        Text(words.figure(row.allowed)),
        Text("" if row.verdict == "skipped" else words.unit(row)),
        Text(words.MARKS[row.verdict], style=colour),
        Text(note, style="dim"),
    )


def _print_reasons(rows: Sequence[Row], console: Console) -> None:
    """Skipped rows, those of one engine and one reason together: how far apart quantities are is no reason of its own."""
    together: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        together.setdefault((row.engines[-1], _HOW_FAR.sub("", row.note)), []).append(row)
    lines = []
    for (engine, reason), members in together.items():
        cases = list(dict.fromkeys(row.case for row in members))
        more = len(cases) - NAMED
        named = ", ".join(cases[:NAMED]) + (f" and {more} more" if more > 0 else "")
        lines.append((Text(engine), str(len(members)), Text(named), Text(reason, style="dim")))
    print_table(console, ("engine", figures("rows"), "cases", "why"), lines)
