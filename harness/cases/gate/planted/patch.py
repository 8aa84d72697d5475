"""A fault planted in the code itself: one line of it, as it might go wrong, and what the gate must say.

Sources are found by the name of the file and the text, so that a file may move; a test holds that each text stands there
once. ``cases``: what is run; ``words``: must stand in what the gate says of the rows that fail, all of them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Patch:
    """One line of one file made wrong."""

    name: str
    file: str
    old: str
    new: str
    cases: tuple[str, ...]
    words: tuple[str, ...]


def of_file(file: str, cases: str, *faults: tuple[str, str, str, str]) -> tuple[Patch, ...]:
    """Faults of one file: name, old, new, words (separated by a semicolon)."""
    return tuple(
        Patch(f"{file}: {name}", file, old, new, tuple(cases.split()), tuple(words.split("; ")))
        for name, old, new, words in faults
    )
