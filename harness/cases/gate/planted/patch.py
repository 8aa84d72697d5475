"""A fault planted in the code itself: one line of it, as it might go wrong, and what the gate must blame.

Sources are found by the name of the file and the text, so that a file may move; a test holds that each text stands there
once. ``cases``: what is run. What must be blamed is written down beforehand, ``rows; term @ place``: which of the rows that fail,
by words of their keys; what is wrong; and the joint, link or channel that it is at, ``-`` for a fault that is at none (an
integrator's weight) or at all alike (gravity). ``|`` stands between words of which any will do.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from harness.cases.gate.planted.blamed import Blamed


@dataclass(frozen=True)
class Expected:
    """The rows, the terms of which one must be blamed, and the places of which one must be named; no places: the term alone."""

    rows: tuple[str, ...]
    terms: tuple[str, ...]
    places: tuple[str, ...]

    @property
    def at(self) -> str:
        return " or ".join(self.places)

    def met(self, answers: Iterable[Blamed]) -> bool:
        """Whether more of the rows name it than name anything else."""
        asked = [one for one in answers if all(word in one.key for word in self.rows)]
        right = sum(self._names(one) for one in asked)
        wrong = sum(bool(one.terms) and not self._names(one) for one in asked)
        return right > wrong

    def _names(self, one: Blamed) -> bool:
        return bool(set(self.terms) & set(one.terms)) and (not self.places or bool(set(self.places) & set(one.places)))


@dataclass(frozen=True)
class Patch:
    """One line of one file made wrong."""

    name: str
    file: str
    old: str
    new: str
    cases: tuple[str, ...]
    expected: Expected


def of_file(file: str, cases: str, *faults: tuple[str, str, str, str]) -> tuple[Patch, ...]:
    """Faults of one file: name, old, new, and what must be blamed."""
    return tuple(
        Patch(f"{file}: {name}", file, old, new, tuple(cases.split()), expected(words))
        for name, old, new, words in faults
    )


def expected(words: str) -> Expected:
    """``rows; term @ place`` read; ValueError for anything else."""
    *rows, blame = words.split("; ")
    term, place = blame.split(" @ ")
    return Expected(tuple(rows), tuple(term.split("|")), () if place == "-" else tuple(place.split("|")))
