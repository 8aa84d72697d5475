"""Sets of effects in a ranking, in words: long ones by what they have more or less than the first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

SHORT = 3  # effects of a set that are listed one by one
SEEN = 0.5  # of ΔBIC; what is less is told as 0


def sets_in_words(ranking: Sequence[Mapping[str, Any]]) -> list[str]:
    """Every row's set: its effects, of none "nothing", and where the first has many, what another has more or less than that."""
    if not ranking:
        return []
    first = list(ranking[0]["effects"])
    return [" + ".join(first) or "nothing", *(_against(first, list(row["effects"])) for row in ranking[1:])]


def first_not_likeliest(ranking: Sequence[Mapping[str, Any]]) -> str:
    """What the first row is where ΔBIC does not say so, for another set is the likeliest; else nothing."""
    known = [row["bic"] for row in ranking if row.get("bic") is not None]
    if not ranking or ranking[0].get("bic") is None or ranking[0]["bic"] - min(known) < SEEN:
        return ""
    return (
        "The first row is the set that this answer is of. It is not the likeliest, from which ΔBIC counts: what is likelier has "
        "not stood what else was asked of it, or was not gone through."
    )


def _against(first: Sequence[str], own: Sequence[str]) -> str:
    whole = " + ".join(own) or "nothing"
    less, more = [e for e in first if e not in own], [e for e in own if e not in first]
    if len(first) <= SHORT or not own:
        return whole
    parts = [f"less {', '.join(less)}"] if less else []
    parts += [f"with {', '.join(more)}"] if more else []
    said = f"the first {' '.join(parts)}"
    return said if len(said) < len(whole) else whole
