"""How sections write numbers and units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness import plain_numbers

Document = Mapping[str, Any]


def points(value: float | None) -> str:
    """A difference of BIC in whole points, as the terminal has it; a dash for none."""
    return "–" if value is None else plain_numbers.points(value)
