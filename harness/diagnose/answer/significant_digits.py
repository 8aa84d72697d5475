"""Numbers with as many digits as their uncertainty leaves them, and how an estimate is told with it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.diagnose.answer.constants import (
    COUNTED_SPREAD,
    ENDS_RATIO,
    FEWEST_DIGITS,
    LOPSIDED_RATIO,
    MOST_DIGITS,
    PLAIN_NUMBER,
    TWO_SIDED_95,
    UNDETERMINED_RATIO,
)

Interval = Sequence[float | None] | None


def digits(value: float, count: int) -> str:
    """The value with so many significant digits, without an exponent below a thousand million."""
    text = f"{value:#.{count}g}".rstrip(".")
    return f"{float(text):.0f}" if "e+" in text and abs(value) < PLAIN_NUMBER else text


def resolved(value: float | None, width: float | None) -> str:
    """The value with three digits or as many as show a fifth of ``width``, zeros at the end included; a dash for none.

    What is less than those digits show is 0.
    """
    if value is None:
        return "–"
    count = FEWEST_DIGITS
    if width and value and width > COUNTED_SPREAD * abs(value):
        decimals = math.ceil(-math.log10(width / 5.0))
        if decimals <= MOST_DIGITS and abs(value) < 0.5 * 10.0**-decimals:
            return f"{0.0:.{max(decimals, 0)}f}"
        count = min(max(math.floor(math.log10(abs(value))) + 1 + decimals, FEWEST_DIGITS), MOST_DIGITS)
    return digits(value, count)


def rounded(value: float | None) -> str:
    """Three digits, zeros at the end included; a dash for none, 0 for exactly nothing."""
    return "0" if value == 0.0 else resolved(value, None)


def ends(interval: Interval) -> str:
    """``low … high``, as many digits each as part the two, or as it needs itself if they lie decades apart; nothing for none.

    An end is no estimate that its own spread would blur: all of a stated damping away is -0.001, however far the other end lies.
    """
    low, high = interval or (None, None)
    if low is not None and high is not None and low * high > 0.0:
        near, far = sorted((abs(low), abs(high)))
        if far > ENDS_RATIO * near:
            return f"{_short(low)} … {_short(high)}"
    return " … ".join(_end(end, _width(interval)) for end in interval or ())


def best(value: float | None, interval: Interval) -> str:
    """The value beside its interval: as many digits as the nearer end leaves it, or its own where those show nothing of it."""
    low, high = interval or (None, None)
    if value is None or low is None or high is None or not low < value < high:
        return _end(value, _width(interval))
    return _end(value, 2.0 * min(value - low, high - value))


def estimate(value: float, std: float | None, interval: Interval, unit: str = "") -> str:
    """An estimate as a person reads it: ``0.0118 ± 0.0002 N·m``, one standard deviation.

    Where the 95 % interval is lopsided, wider than the value or wider than the deviation says, that is told:
    ``0.005 … 39 N·m (95 %), best 0.400``. So it is for what lies at an end of where it was searched (no deviation). An interval of
    more decades than any design leaves open tells nothing: ``not determined``. A value without either is told alone, as what is
    counted is.
    unit: as people write it, or nothing.
    """
    after = f" {unit}" if unit else ""
    low, high = interval or (None, None)
    known = low is not None and high is not None
    if low is not None and high is not None and value and high - low > UNDETERMINED_RATIO * abs(value):
        return f"not determined (best {resolved(value, None)}{after})"
    if std is None and known and low != high:
        return f"{ends(interval)}{after} (95 %), best {best(value, interval)} (at its bound)"
    if std is None or std <= COUNTED_SPREAD * abs(value):
        return resolved(value, None) + after
    if low is not None and high is not None and _own(value, std, low, high):
        return f"{ends(interval)}{after} (95 %), best {best(value, interval)}"
    return f"{resolved(value, std)} ± {_short(std)}{after}"


def _own(value: float, std: float, low: float, high: float) -> bool:
    """Whether a value and its deviation would tell half of an interval."""
    nearer, farther = sorted((value - low, high - value))
    return farther > min(LOPSIDED_RATIO * TWO_SIDED_95 * std, LOPSIDED_RATIO * nearer, abs(value))


def _end(value: float | None, width: float | None) -> str:
    """A number beside an interval's width: by its own digits where those that the width leaves would show nothing of it."""
    text = resolved(value, width)
    nothing = value is not None and float(text) == 0.0
    return _short(value) if value is not None and nothing and abs(value) > 10.0**-MOST_DIGITS * (width or 0.0) else text


def _short(value: float) -> str:
    text = f"{value:.2g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < PLAIN_NUMBER else text


def _width(interval: Interval) -> float | None:
    """How wide an interval is that has two ends."""
    low, high = interval or (None, None)
    return None if low is None or high is None else high - low
