"""The folder that keeps a fleet's answers: one file a unit, each written whole, and what they were asked."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from harness.cases.json_file import read_json
from harness.errors import InputError
from harness.fleet.question import Question
from harness.fleet.units import Unit
from harness.journal import code_digest
from harness.whole_files import nothing_in, write_whole

SCHEMA = "denoc.unit/1"
PLAN = "plan.json"
UNITS = "units"
_MEMBERS = {"unit", "files", "failed", "again", "diagnosis"}


def begin(folder: Path, question: Question) -> None:
    """Make the folder, or take up one that holds answers to the same question.

    Raises InputError where it holds something else, or answers of another question or version of the code.
    """
    asked = json.loads(json.dumps({"question": question.plain(), "code": code_digest()}))
    plan = folder / PLAN
    if plan.exists():
        was = read_json(plan, mend="give another --out")
        if was != asked:
            parts = was.get("question", {}) if isinstance(was, dict) else {}
            differing = [name for name, value in asked["question"].items() if parts.get(name) != value]
            what = f"another {' and '.join(differing)}" if differing else "another version of the code"
            raise InputError(
                f"holds answers with {what.replace('_', ' ')}", source=folder, mend="give the same, or another --out"
            )
        return
    if folder.exists() and (not folder.is_dir() or not nothing_in(folder)):
        raise InputError("is not empty, and holds no fleet's answers", source=folder, mend="give another --out")
    try:
        (folder / UNITS).mkdir(parents=True, exist_ok=True)
        write(plan, asked)
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", source=folder, mend="give another --out") from error


def answer_file(folder: Path, name: str) -> Path:
    return folder / UNITS / f"{name}.json"


def write(path: Path, document: Any) -> None:
    """Write JSON so that a reader finds it whole or not at all, also where two write it at once."""
    write_whole(path, json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n")


def keep(
    folder: Path, name: str, files: Any, *, diagnosis: Any = None, failed: str | None = None, again: bool = False
) -> None:
    """Keep a unit's answer (``denoc.unit/1``). files: what it is made from; again: whether the next run is to try once more."""
    document = {
        "schema": SCHEMA,
        "unit": name,
        "files": files,
        "failed": failed,
        "again": again,
        "diagnosis": diagnosis,
    }
    write(answer_file(folder, name), document)


def read(folder: Path, name: str) -> dict[str, Any] | None:
    """A unit's answer; None where there is none, or what is there is damaged."""
    try:
        found = json.loads(answer_file(folder, name).read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA or not found.keys() >= _MEMBERS:
        return None
    return found if isinstance(found["diagnosis"], dict | None) else None


def done(folder: Path, unit: Unit) -> bool:
    """Whether a unit's answer is there, and of the recordings as they are now."""
    found = read(folder, unit.name)
    if found is None or found["again"]:
        return False
    try:
        return bool(found["files"] == unit.files())
    except OSError:
        return False


def answers(folder: Path, units: Sequence[Unit]) -> Iterator[tuple[str, dict[str, Any] | None]]:
    """Names and answers, one after another."""
    for unit in units:
        yield unit.name, read(folder, unit.name)
