"""The files of a proof's folder read again: what is damaged is told in one line, whatever the damage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from harness.cases.json_file import read_json, shaped
from harness.errors import InputError

T = TypeVar("T")
#: Of cases, as their names begin.
KINDS = ("single", "pair", "triple", "clean", "outside", "flexible single", "flexible clean")
_MEND = "restore it from a copy of the folder, or run the proof afresh"
_AGAIN = "remove it, and `denoc prove --resume` answers this case again"


@dataclass(frozen=True)
class Plan:
    """What a proof was begun with; counts: cases by kind."""

    seed: int
    counts: dict[str, int]
    short: bool = False
    disguised: bool = False


def read_plan(out: Path) -> Plan:
    """The plan of a proof; InputError where it is damaged or gone."""
    file = out / "plan.json"
    plan = shaped(read_json(file, mend=_MEND), Plan, source=file, mend=_MEND)
    if plan.seed < 0 or not set(plan.counts) <= set(KINDS) or min(plan.counts.values(), default=0) < 0:
        raise InputError("is damaged: no such seed, or no such kinds of cases", source=file, mend=_MEND)
    return plan


def read_digests(out: Path) -> dict[str, str]:
    """The published digest of each case's answer; InputError where the file is damaged or gone."""
    file = out / "digests.json"
    digests = texts_by_name(file)
    for name in digests:
        kind, _, number = name.rpartition("-")
        if kind.replace("-", " ") not in KINDS or not number.isdecimal():
            raise InputError(f"is damaged: no case is named {name[:40]!r}", source=file, mend=_MEND)
    return digests


def texts_by_name(file: Path) -> dict[str, str]:
    """A file of one text by name, such as the names under which cases were exported; InputError where it is none."""
    return shaped(read_json(file, mend=_MEND), dict[str, str], source=file, mend=_MEND)


def read_found(out: Path, name: str) -> dict[str, Any]:
    """What was found of a case; InputError where it is no object of JSON."""
    file = found_file(out, name)
    # Errors held out and estimates that there are none of stand there as NaN.
    return shaped(read_json(file, mend=_AGAIN, finite=False), dict[str, Any], source=file, mend=_AGAIN)


def found_file(out: Path, name: str) -> Path:
    """Where it stands what was found of a case."""
    return out / "found" / f"{name}.json"


def read_claimed(file: Path) -> dict[str, Any]:
    """What a peer said so far, by case; InputError where the file is damaged."""
    mend = "remove it, and `denoc prove --resume` asks again"
    document = shaped(read_json(file, mend=mend, finite=False), dict[str, Any], source=file, mend=mend)
    return shaped(document.get("cases"), dict[str, Any], source=file, mend=mend)


def of_found(file: Path, made: Callable[[], T]) -> T:
    """What is made of what was found; InputError where that has not the form of a diagnosis."""
    try:
        return made()
    except (KeyError, TypeError, AttributeError, IndexError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"is damaged: {type(error).__name__} at {error}, which no diagnosis has", source=file, mend=_AGAIN
        ) from error
