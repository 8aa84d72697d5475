"""How sections write numbers and units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Document = Mapping[str, Any]


def figure(value: float | None) -> str:
    """Three digits, or a dash."""
    return "–" if value is None else f"{value:.3g}"


def unit(text: str) -> str:
    """A unit as it is printed: ``kg*m**2`` is kg·m², and nothing for a plain number."""
    return "" if text == "1" else text.replace("**2", "²").replace("**3", "³").replace("*", "·")
