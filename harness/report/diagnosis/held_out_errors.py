"""Errors on the data held out, channel by channel, of a ranking of hypotheses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def channels_of(ranking: Sequence[Mapping[str, Any]]) -> list[str]:
    """The channels whose errors a ranking tells; one without a name where it does not say of which."""
    return next((list(row["heldout"]) for row in ranking if row.get("heldout")), [""])


def held_out(row: Mapping[str, Any], channels: Sequence[str]) -> list[float | None]:
    """The errors of one hypothesis, in the order of ``channels``; None where they have not been worked out."""
    errors = row.get("heldout") or {channels[0]: row.get("heldout_rmse")}
    return [errors.get(name) for name in channels]


def headings(channels: Sequence[str], what: str) -> list[str]:
    """Headings of their columns: ``what``, and of which channel if there are several."""
    return [what] if len(channels) < 2 else [f"{what}, {name}" for name in channels]
