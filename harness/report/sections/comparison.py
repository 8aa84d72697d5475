"""A table of text with a few words above it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

Shown = tuple[Sequence[str], Sequence[Sequence[str]]]
TEMPLATE = "comparison_table.html"


def comparison(shown: Shown, words: str, plain: Collection[str]) -> Mapping[str, Any] | None:
    """What the template needs of heads and lines; None without a line. plain: heads of columns that hold no figures."""
    heads, lines = shown
    if not lines:
        return None
    return {"words": words, "heads": [(head, "" if head in plain else "number") for head in heads], "lines": lines}
