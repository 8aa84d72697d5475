"""Numbers with as many digits as their uncertainty leaves them."""

from __future__ import annotations

import math
from collections.abc import Sequence

_FEWEST, _MOST = 3, 9  # digits


def resolved(value: float | None, width: float | None) -> str:
    """The value with three digits or as many as show a fifth of ``width``, zeros at the end included; a dash for none.

    What is less than those digits show is 0.
    """
    if value is None:
        return "–"
    digits = _FEWEST
    if width and value:
        decimals = math.ceil(-math.log10(width / 5.0))
        if decimals <= _MOST and abs(value) < 0.5 * 10.0**-decimals:
            return f"{0.0:.{max(decimals, 0)}f}"
        digits = min(max(math.floor(math.log10(abs(value))) + 1 + decimals, _FEWEST), _MOST)
    return f"{value:#.{digits}g}".rstrip(".")


def width_of(interval: Sequence[float | None] | None) -> float | None:
    """How wide an interval is that has two ends."""
    low, high = interval or (None, None)
    return None if low is None or high is None else high - low


def ends(interval: Sequence[float | None] | None) -> str:
    """``low … high``, as many digits each as part the two; nothing for no interval."""
    return " … ".join(resolved(end, width_of(interval)) for end in interval or ())
