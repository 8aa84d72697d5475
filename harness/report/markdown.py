"""The table in Markdown."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from harness.cases.results import Results
from harness.report import words


def markdown(results: Results) -> str:
    """GitHub-flavoured Markdown: a summary, a table for each group, versions."""
    counts = (results.count("pass"), results.count("fail"), results.count("skipped"))
    text = words.headline(*counts)
    lines = ["# Validation", "", text[0].upper() + text[1:] + ".", ""]
    head = ("case", "quantity", "engines", "difference", "allowed", "unit", "why allowed", "verdict", "note")
    for group, members in groupby(results.rows, key=lambda row: row.group):
        lines += [f"## {words.GROUP_TITLES.get(group, group)}", "", line(head), line(["---"] * len(head))]
        for row in members:
            note = "; ".join(filter(None, [row.note, words.divergence(row)]))
            lines.append(
                line(
                    (
                        row.case,
                        words.quantity(row.quantity),
                        words.engines(row),
                        words.figure(row.difference, verdict=row.verdict),
                        words.figure(row.allowed),
                        words.unit(row),
                        row.why_allowed,
                        f"{words.MARKS[row.verdict]} {row.verdict}",
                        note,
                    )
                )
            )
        lines.append("")
    if results.doubts:
        lines += ["## Warnings", "", line(("model", "link", "severity", "what")), line(["---"] * 4)]
        lines += [line((doubt.case, doubt.site, doubt.severity, doubt.what)) for doubt in results.doubts]
        lines.append("")
    if results.notes:
        lines += ["## What the models say beside this", "", *(f"- {plain(note)}" for note in results.told), ""]
    lines += ["## Versions", "", line(("what", "version")), line(("---", "---"))]
    lines += [line(item) for item in results.versions.items()]
    return "\n".join(lines) + "\n"


def plain(text: str) -> str:
    """Text with what Markdown would take for marks put so that it stands as it is."""
    return " ".join(text.split()).replace("\\", "\\\\").replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def line(cells: Iterable[object]) -> str:
    """A line of a table."""

    # A pipe inside a cell would start another one, a line break another row; `<` would start HTML.
    def clean(cell: object) -> str:
        return " ".join(str(cell).split()).replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;")

    return "| " + " | ".join(clean(cell) for cell in cells) + " |"
