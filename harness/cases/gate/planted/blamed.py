"""What a row that closes the gate blames, by the fields that a program reads: what is wrong, and where."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

from harness.cases.gate.judge import Judged

#: Fields of ``first_divergence`` that say what is wrong, and at which joint, link or channel. Where it merely shows is none of them.
TERMS = ("term", "part", "value", "or", "method")
PLACES = ("at", "joint", "link", "channel", "loop", "actuator")


@dataclass(frozen=True)
class Blamed:
    """A row's key, the terms and the places that it names, and all that it says."""

    key: str
    terms: tuple[str, ...]
    places: tuple[str, ...]
    said: str


def of_judged(judged: Judged) -> Blamed:
    """Of a row that closes the gate."""
    row = judged.row
    where = {} if row is None or row.first_divergence is None else dict(row.first_divergence)
    said = [judged.key, judged.reason, json.dumps(where) if where else "", "" if row is None else row.note]
    return Blamed(judged.key, terms(where), places(where), "; ".join(filter(None, said)))


def terms(where: Mapping[str, object]) -> tuple[str, ...]:
    """Several that cannot be told apart stand in one field, commas between."""
    return tuple(word for key in TERMS if where.get(key) for word in str(where[key]).split(", "))


def places(where: Mapping[str, object]) -> tuple[str, ...]:
    """Coordinates count for what they are of: ``rod.mode1`` of the link, ``hip.wx`` of the joint."""
    named = [str(where[key]) for key in PLACES if where.get(key)]
    return tuple(dict.fromkeys([*named, *(name.split(".")[0] for name in named)]))
