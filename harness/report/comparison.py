"""Two runs side by side: on a terminal, as Markdown, and as a page of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.cases.between import KINDS, Changed, Comparison
from harness.errors import one_line
from harness.report import words
from harness.report.columns import figures, print_table
from harness.report.gate.closing import together
from harness.report.markdown import line

HEADS = ("what changed", "case", "quantity", "engines", "before", "now", "where and when", "why")


def of(kind: str, count: int) -> str:
    """What several rows did, or one."""
    said = KINDS[kind]
    first, _, rest = said.partition(" ")
    many = {"is": "are", "has": "have", "passes": "pass", "fails": "fail"}.get(first, first)
    return said if count == 1 else f"{many} {rest}".strip()


def headline(comparison: Comparison) -> str:
    """What changed, counted, in a sentence."""
    counts = {kind: sum(one.kind == kind for one in comparison.changed) for kind in KINDS}
    said = ", ".join(f"{count} {of(kind, count)}" for kind, count in counts.items() if count)
    same = "one row is as it was" if comparison.same == 1 else f"{comparison.same} rows are as they were"
    return f"Of the rows, {said}; {same}." if said else f"Nothing changed: {same}."


def cells(one: Changed) -> tuple[str, ...]:
    """A row of ``HEADS``."""
    case, quantity, engines = one.key.rsplit("/", 2)
    before, after = (
        "–" if row is None else words.figure(row.difference, verdict=row.verdict) for row in (one.before, one.after)
    )
    row = one.after
    where = "" if row is None else words.divergence(row)
    note = row.note if row else ""
    if one.kind == "loosened" and one.before is not None and row is not None:
        limits = (f"{words.figure(side.allowed)} {words.unit(side)}" for side in (one.before, row))
        note = "; ".join(filter(None, ["allowed " + " → ".join(limits), note]))
    shown = words.quantity(quantity), engines.replace("+", " · ")
    # Names out of somebody's results file: a line break would begin a line of its own.
    return tuple(one_line(cell) for cell in (KINDS[one.kind], case, *shown, before, after, where, note))


def _before(one: Changed) -> float:
    return 0.0 if one.before is None or one.before.difference is None else one.before.difference


def lines(changed: Sequence[Changed]) -> list[tuple[str, ...]]:
    """Rows of ``HEADS``; engines that changed alike, to the same figure at one place and for one reason, are one row."""
    alike: dict[tuple[str, ...], list[Changed]] = {}
    for one in changed:
        kind, case, quantity, _, _, now, where, why = cells(one)
        alike.setdefault((kind, case, quantity, now, where, why), []).append(one)
    found: list[tuple[str, ...]] = []
    for (kind, case, quantity, now, where, why), rows in alike.items():
        engines = together([one.key.rsplit("/", 1)[1].split("+") for one in rows])
        most = max(rows, key=_before)
        before = cells(most)[4]
        if len({cells(one)[4] for one in rows}) > 1:
            before = f"≤ {before}"
        found.append((kind, case, quantity, engines, before, now, where, why))
    return found


def print_comparison(comparison: Comparison, console: Console) -> None:
    """The sentence, then the rows that changed, the gravest first, then versions."""
    console.print(Text(headline(comparison), style="bold red" if comparison.worse else "bold"))
    if comparison.changed:
        heads = [figures(head) if head in ("before", "now") else head for head in HEADS]
        print_table(console, heads, [tuple(Text(cell) for cell in row) for row in lines(comparison.changed)])
    for name, (before, after) in comparison.versions.items():
        console.print(Text(f"{name}: before {before}, now {after}", style="dim"))


def comparison_markdown(comparison: Comparison) -> str:
    """GitHub-flavoured Markdown of the same."""
    text = ["## What changed between two runs", "", headline(comparison), ""]
    if comparison.changed:
        text += [line(HEADS), line(["---"] * len(HEADS)), *map(line, lines(comparison.changed)), ""]
    text += [f"- {name}: {before} → {after}" for name, (before, after) in comparison.versions.items()]
    return "\n".join(text).rstrip() + "\n"


@dataclass(frozen=True)
class _Rows:
    anchor: str = "changed"
    title: str = "What changed"
    template: str = "comparison.html"

    def content(self, comparison: Comparison) -> Mapping[str, Any]:
        kinds = {kind: [one for one in comparison.changed if one.kind == kind] for kind in KINDS}
        return {
            "headline": headline(comparison),
            "ok": not comparison.worse,
            "groups": [(len(rows), of(kind, len(rows)), lines(rows)) for kind, rows in kinds.items() if rows],
            "heads": HEADS[1:],
            "versions": comparison.versions,
        }


def comparison_html(comparison: Comparison) -> str:
    """The page: no script needed, every text escaped."""
    from harness.report.html import page

    return page("DeNOC: two runs compared", comparison, [_Rows()])
