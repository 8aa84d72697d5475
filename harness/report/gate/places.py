"""Where in the files of models that lies which closed the gate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.cases.gate import Judged, Judgement
from harness.report import words
from harness.system.source_lines import line_of


@dataclass(frozen=True)
class Place:
    """A row that closes the gate, the file it is of (None for the suite's own cases), its line from 1, and what is wrong."""

    judged: Judged
    path: Path | None
    line: int | None
    said: str


def places(judgement: Judgement | None, files: Mapping[str, Path]) -> list[Place]:
    """Every row that closes the gate, with file and line of the model by case."""
    if judgement is None:
        return []
    found = []
    for judged in judgement.failed:
        case = judged.key.rsplit("/", 2)[0]
        path = files.get(case)
        found.append(Place(judged, path, None if path is None else line_in(judged, path), why(judged)))
    return found


def line_in(judged: Judged, path: Path) -> int | None:
    """The line of a model's file that a row is about, from 1; None where the file has none."""
    where = dict(judged.row.first_divergence or {}) if judged.row is not None else {}
    value = str(where.get("value", ""))
    names = [where.get(key) for key in ("link", "joint", "body", "coordinate", "signal")]
    entry = where.get("entry")
    if isinstance(entry, list | tuple):
        names += list(entry)
    for name in names:
        if isinstance(name, str):
            # A coordinate of a beam is named for its link.
            line = line_of(path, name, value) or line_of(path, name.rpartition(".")[0], value)
            if line is not None:
                return line
    return None


def why(judged: Judged) -> str:
    """Why a row closes the gate, where and when."""
    row = judged.row
    if row is None or row.verdict != "fail":
        return judged.reason
    return "; ".join(filter(None, [judged.reason, words.divergence(row), row.note]))
