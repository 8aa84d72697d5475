"""The gate's answer, for a person and for a program."""

from __future__ import annotations

import json
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.cases.gate import Judged, Judgement, SelfTest
from harness.cases.results import Results, row_as_dict
from harness.report import words
from harness.report.columns import figures, print_table


def as_dict(results: Results, judgement: Judgement | None, trials: SelfTest | None) -> str:
    """``denoc.results/1`` as JSON text with ``accepted``, ``change`` and ``reason`` in each row, and ``self_test``."""
    document: dict[str, Any] = results.to_json()
    del document["series"]
    if judgement is not None:
        document["rows"] = [_row(judged) for judged in judgement.rows]
        document["versions_changed"] = {name: list(pair) for name, pair in judgement.versions_changed.items()}
    document["ok"] = (judgement is None or judgement.ok) and (trials is None or trials.ok)
    document["self_test"] = None if trials is None else trials.as_dict()
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def _row(judged: Judged) -> dict[str, Any]:
    if judged.row is not None:
        values = row_as_dict(judged.row)
    else:
        case, quantity, engines = judged.key.rsplit("/", 2)
        values = {
            "case": case,
            "quantity": quantity,
            "engines": engines.split("+"),
            "difference": None,
            "allowed": None,
            "unit": None,
            "why_allowed": "",
            "verdict": "missing",
            "note": judged.reason,
            "first_divergence": None,
        }
    return {**values, "accepted": judged.accepted, "change": judged.change, "ok": judged.ok, "reason": judged.reason}


def print_judgement(judgement: Judgement | None, trials: SelfTest | None, console: Console) -> None:
    """What closed the gate, row by row, and how the gate did against planted defects."""
    if judgement is not None:
        if judgement.failed:
            heads = ("case", "quantity", "engines", figures("accepted"), figures("now"), "why the gate closes")
            print_table(console, heads, [_cells(judged) for judged in judgement.failed])
        count = len(judgement.failed)
        text = (
            f"{count} of {len(judgement.rows)} rows close the gate."
            if count
            else f"All {len(judgement.rows)} rows hold."
        )
        console.print(Text(text, style="bold red" if count else "bold green"))
        for name, (before, now) in judgement.versions_changed.items():
            console.print(Text(f"{name}: accepted with {before}, run with {now}", style="dim"))
    if trials is not None:
        planted = len(trials.trials)
        caught = sum(trial.caught for trial in trials.trials)
        named = sum(trial.named for trial in trials.trials)
        text = f"Self-test: {planted} defects planted, {caught} caught, {named} named."
        console.print(Text(text, style="bold green" if trials.ok else "bold red"))
        if not trials.clean:
            console.print(Text("  the same case without a defect does not pass", style="red"))
        for trial in trials.trials:
            if not (trial.caught and trial.named):
                fate = "not caught" if not trial.caught else f"caught, but said to be: {trial.said}"
                console.print(Text(f"  {trial.defect}: {fate}", style="red"))


def _cells(judged: Judged) -> tuple[Text, ...]:
    case, quantity, engines = judged.key.rsplit("/", 2)
    row = judged.row
    reason = judged.reason
    if row is not None and row.verdict == "fail":
        reason = "; ".join(filter(None, [reason, words.divergence(row), row.note]))
    now = "missing" if row is None else words.figure(row.difference, verdict=row.verdict)
    cells = (case, words.quantity(quantity), engines.replace("+", " · "), words.figure(judged.accepted), now, reason)
    return tuple(Text(cell) for cell in cells)
