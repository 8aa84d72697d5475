"""Numbers with as many digits as their uncertainty leaves them."""

from __future__ import annotations

import math
from collections.abc import Sequence

_FEWEST, _MOST = 3, 9  # digits
EXACTLY = 1e-9  # relative standard deviation of what is counted, not measured
FARTHER = 2.0  # times as far as its standard deviation says, beyond which an interval itself is told
TWO_SIDED = 1.96  # standard deviations to either end of a normal distribution's 95 %


def resolved(value: float | None, width: float | None) -> str:
    """The value with three digits or as many as show a fifth of ``width``, zeros at the end included; a dash for none.

    What is less than those digits show is 0.
    """
    if value is None:
        return "–"
    digits = _FEWEST
    if width and value and width > EXACTLY * abs(value):
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


def spread(value: float, std: float | None, interval: Sequence[float | None] | None) -> str:
    """What follows a value: its standard deviation, or its 95 % interval where that says more, or nothing for what is counted."""
    if std is None or std <= EXACTLY * abs(value):
        return ""
    low, high = interval or (None, None)
    # Where it may lie in another valley, or much farther to one side, a deviation would tell half of it.
    if low is not None and high is not None and max(value - low, high - value) > FARTHER * TWO_SIDED * std:
        return f" (95 %: {low:.2g} … {high:.2g})"
    return f" ± {std:.2g}"
