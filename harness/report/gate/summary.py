"""A pull request's summary: what changed first, then where, when and why."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from harness.cases.gate import Accepted, Judged, Judgement, SelfTest
from harness.cases.results import Results
from harness.errors import unwritable
from harness.report import words
from harness.report.gate import closing
from harness.report.markdown import line, plain


def markdown(
    results: Results,
    judgement: Judgement | None,
    trials: SelfTest | None,
    accepted: Accepted | None = None,
    files: Mapping[str, Path] | None = None,
) -> str:
    """GitHub-flavoured Markdown of a gate: the verdict, what closes it, what else moved, and the last acceptance.

    files: the model of each case, for the line that changed.
    """
    lines = ["## Dynamics gate", ""]
    if judgement is not None:
        lines += _verdict(judgement, files)
    if trials is not None:
        lines += [f"Self-test: {trials.sentence()}.", ""]
        missed = [trial for trial in trials.trials if not (trial.caught and trial.named)]
        lines += [f"- {trial.defect}: {trial.fate()}" for trial in missed]
        lines += [""] * bool(missed)
    if judgement is not None and results.told:
        lines += [f"<details><summary>{len(results.told)} notes on the models</summary>", ""]
        lines += [*(f"- {plain(note)}" for note in results.told), "", "</details>", ""]
    if accepted is not None and accepted.history:
        last = accepted.history[0]
        lines += [f"Last accepted {plain(last['date'])}: {plain(last['why'])}", ""]
    return "\n".join(lines)


def _verdict(judgement: Judgement, files: Mapping[str, Path] | None) -> list[str]:
    failed = judgement.failed
    lines = []
    if judgement.reference:
        lines += [f"**Closed**: the reference {judgement.reference}.", ""]
    if failed:
        lines += [f"**Closed**: {len(failed)} of {len(judgement.rows)} rows.", ""]
        lines += [
            line(("what changed, where, when and why", *closing.HEADS[1:7])),
            line(["---"] * 7),
        ]
        closes = closing.lines(judgement, files)
        lines += [line((c.said, *c.cells[1:7])) for c in closes[:50]]
        if len(closes) > 50:
            lines.append(f"\n… and {len(closes) - 50} more.")
        lines.append("")
    elif not judgement.reference:
        lines += [f"**Open**: all {len(judgement.rows)} rows hold.", ""]
    if judgement.not_asked:
        lines += [judgement.not_held(), ""]
    moved = [(judged, share) for judged in judgement.rows if judged.ok and (share := _moved(judged)) is not None]
    if moved:
        lines += [f"<details><summary>{len(moved)} rows moved within what is allowed</summary>", ""]
        lines += [line(("case", "quantity", "engines", "accepted", "now", "allowed")), line(["---"] * 6)]
        for judged, _ in sorted(moved, key=lambda pair: -pair[1])[:30]:
            cells = closing.line(judged).cells[1:6]
            lines.append(line((*cells, words.figure(judged.row.allowed if judged.row else None))))
        lines += ["", "</details>", ""]
    changed = [f"{name} {a} → {b}" for name, (a, b) in judgement.versions_changed.items()]
    if changed:
        lines += ["Versions: " + ", ".join(changed) + ".", ""]
    return lines


def _moved(judged: Judged) -> float | None:
    """By which share of what is allowed, if by more than a tenth: less is rounding of another processor."""
    if judged.row is None or not judged.row.allowed:
        return None
    share = abs(judged.change or 0.0) / judged.row.allowed
    return share if share > 0.1 else None


def append_summary(path: str | Path, text: str) -> None:
    """Add to a file as ``$GITHUB_STEP_SUMMARY`` wants it, all or nothing; InputError if the place cannot be written to."""
    path = Path(path)
    try:
        before = path.stat().st_size if path.exists() else None
        try:
            with path.open("a", encoding="utf-8", newline="\n") as file:
                file.write(text)
        except OSError:
            # What others have appended stays, a part of this does not.
            if before is None:
                path.unlink(missing_ok=True)
            elif path.is_file():
                os.truncate(path, before)
            raise
    except OSError as error:
        raise unwritable(path, error) from error
