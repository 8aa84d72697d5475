"""The gate's answer on a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from pathlib import Path

from rich.console import Console
from rich.text import Text

from harness.cases.gate import Change, Judgement, SelfTest
from harness.errors import one_line
from harness.report.columns import Heading, figures, print_table
from harness.report.gate import closing


def print_judgement(
    judgement: Judgement | None,
    trials: SelfTest | None,
    console: Console,
    files: Mapping[str, Path] | None = None,
) -> None:
    """What closed the gate, case by case, and how the gate did against planted defects; files: the model of each case."""
    if judgement is not None:
        if judgement.reference:
            advice = "compare it with version control; `denoc gate --accept --why …` takes the figures of a whole run"
            console.print(Text(f"The reference {judgement.reference} ({advice}).", style="bold red"))
        count = len(judgement.failed)
        text = f"All {len(judgement.rows)} rows hold."
        if count or not judgement.rows:
            text = f"{count} of {len(judgement.rows)} rows close the gate." if count else "There is no row to judge."
        console.print(Text(text, style="bold green" if judgement.rows and not count else "bold red"))
        if judgement.not_asked:
            console.print(Text(judgement.not_held(), style="yellow"))
        if judgement.failed:
            _print_lines(closing.lines(judgement, files), console)
        for name, (before, now) in judgement.versions_changed.items():
            console.print(Text(f"{name}: accepted with {before}, run with {now}", style="dim"))
    if trials is not None:
        text = f"Self-test: {trials.sentence()}."
        console.print(Text(text, style="bold green" if trials.ok else "bold red"))
        if not trials.clean:
            console.print(Text("  the same case without a defect does not pass", style="red"))
        for trial in trials.trials:
            if not (trial.caught and trial.named):
                console.print(Text(f"  {trial.defect}: {trial.fate()}", style="red"))


def _print_lines(lines: list[closing.Line], console: Console) -> None:
    """Figures in columns under the name of their case; what changed, where, when and why beneath."""
    heads = [figures(head) if head in closing.FIGURES else head for head in closing.HEADS[2:7]]
    rows: list[Heading | tuple[Text, ...]] = []
    for case, members in groupby(lines, key=lambda line: line.case):
        rows.append(Heading(one_line(case)))
        rows += [tuple(Text(cell) for cell in (*line.cells[2:7], line.said)) for line in members]
    print_table(console, [*heads, closing.HEADS[0]], rows)


def print_change(change: Change, path: Path, console: Console) -> None:
    """What an acceptance has done to the file."""
    counts = ((change.added, "added"), (change.changed, "changed"), (change.removed, "removed"))
    said = ", ".join(f"{len(keys)} {word}" for keys, word in counts)
    console.print(Text(f"Accepted {len(change.accepted.rows)} rows into {path}: {said}."))
    for keys, one, several in (
        (change.loosened, "limit was loosened", "limits were loosened"),
        (change.removed, "row was let go", "rows were let go"),
        (
            change.kept,
            "row is not in this run and stays as it was (--remove CASE lets it go)",
            "rows are not in this run and stay as they were (--remove CASE lets them go)",
        ),
    ):
        if keys:
            names = ", ".join(keys[:4]) + (" …" if len(keys) > 4 else "")
            console.print(Text(f"  {len(keys)} {several if len(keys) > 1 else one}: {names}", style="yellow"))
