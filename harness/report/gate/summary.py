"""A pull request's summary: what changed first, then where, when and why."""

from __future__ import annotations

from pathlib import Path

from harness.cases.gate import Accepted, Judged, Judgement, SelfTest
from harness.cases.results import Results
from harness.errors import unwritable
from harness.report import words
from harness.report.gate.screen import why
from harness.report.markdown import line, plain


def markdown(
    results: Results, judgement: Judgement | None, trials: SelfTest | None, accepted: Accepted | None = None
) -> str:
    """GitHub-flavoured Markdown of a gate: the verdict, what closes it, what else moved, and the last acceptance."""
    lines = ["## Dynamics gate", ""]
    if judgement is not None:
        lines += _verdict(results, judgement)
    if trials is not None:
        planted = len(trials.trials)
        caught = sum(trial.caught for trial in trials.trials)
        named = sum(trial.named for trial in trials.trials)
        lines += [f"Self-test: {planted} defects planted, {caught} caught, {named} named.", ""]
        missed = [trial for trial in trials.trials if not (trial.caught and trial.named)]
        lines += [
            f"- {trial.defect}: {'said to be ' + trial.said if trial.caught else 'not caught'}" for trial in missed
        ]
        lines += [""] * bool(missed)
    if judgement is not None and results.told:
        lines += [f"<details><summary>{len(results.told)} notes on the models</summary>", ""]
        lines += [*(f"- {plain(note)}" for note in results.told), "", "</details>", ""]
    if accepted is not None and accepted.history:
        last = accepted.history[0]
        lines += [f"Last accepted {last['date']}: {last['why']}", ""]
    return "\n".join(lines)


def _verdict(results: Results, judgement: Judgement) -> list[str]:
    failed = judgement.failed
    lines = []
    if judgement.reference:
        lines += [f"**Closed**: the reference {judgement.reference}.", ""]
    if failed:
        lines += [f"**Closed**: {len(failed)} of {len(judgement.rows)} rows.", ""]
        lines += [
            line(("case", "quantity", "engines", "accepted", "now", "what changed, where and why")),
            line(["---"] * 6),
        ]
        lines += [line(_cells(judged)) for judged in failed[:50]]
        if len(failed) > 50:
            lines.append(f"\n… and {len(failed) - 50} more.")
        lines.append("")
    elif not judgement.reference:
        lines += [f"**Open**: all {len(judgement.rows)} rows hold.", ""]
    moved = [row for row in judgement.rows if row.ok and row.row is not None and _moved(row)]
    if moved:
        lines += [f"<details><summary>{len(moved)} rows moved within what is allowed</summary>", ""]
        lines += [line(("case", "quantity", "engines", "accepted", "now", "allowed")), line(["---"] * 6)]
        for judged in sorted(moved, key=lambda row: -abs(row.change or 0.0) / (row.row.allowed or 1.0))[:30]:  # type: ignore[union-attr]
            lines.append(line((*_cells(judged)[:5], words.figure(judged.row.allowed))))  # type: ignore[union-attr]
        lines += ["", "</details>", ""]
    changed = [f"{name} {a} → {b}" for name, (a, b) in judgement.versions_changed.items()]
    if changed:
        lines += ["Versions: " + ", ".join(changed) + ".", ""]
    return lines


def _moved(judged: Judged) -> bool:
    """By more than a tenth of what is allowed: less is rounding of another processor."""
    row = judged.row
    return row is not None and row.allowed is not None and abs(judged.change or 0.0) > 0.1 * row.allowed > 0.0


def _cells(judged: Judged) -> tuple[str, ...]:
    case, quantity, engines = judged.key.rsplit("/", 2)
    row = judged.row
    now = "missing" if row is None else words.figure(row.difference, verdict=row.verdict)
    return (
        case,
        words.quantity(quantity),
        engines.replace("+", " · "),
        words.figure(judged.accepted),
        now,
        why(judged),
    )


def append_summary(path: str | Path, text: str) -> None:
    """Add to a file as ``$GITHUB_STEP_SUMMARY`` wants it; InputError if the place cannot be written to."""
    try:
        with Path(path).open("a", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except OSError as error:
        raise unwritable(path, error) from error
