"""Stamps of the calendar or of a clock, as tables write them, as nanoseconds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date
from itertools import pairwise

EPOCH = date(1970, 1, 1).toordinal()
DAY = 86_400 * 10**9  # ns
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
FOUR = r"(?=\d{4}[-/.]|\d{1,2}[-/.]\w{1,3}[-/.]\d{4}\b)"  # digits that a year has: 1.2.3 is of a version
DATE = FOUR + r"(?P<a>\d{1,4})(?P<mark>[-/.])(?P<b>\d{1,2}|[A-Za-z]{3})(?P=mark)(?P<c>\d{1,4})"
CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2})(?:[.,](?P<part>\d+))?)?"
ZONE = r"(?P<zone>Z|UTC|GMT|[+-]\d\d(?::?\d\d)?)"
HALF = r"(?P<half>[AaPp])\.?[Mm]\.?"
STAMP = re.compile(rf"^(?:{DATE}(?:[T ]+(?=\d)|$))?(?:{CLOCK}\s*(?:{HALF})?\s*{ZONE}?)?$")
# What a and c, with b, are: year, month and day by their place in the text.
ORDERS = {"year first": (0, 1, 2), "day first": (2, 1, 0), "month first": (2, 0, 1)}


def is_stamp(text: str) -> bool:
    match = STAMP.match(text.strip())
    return match is not None and (match["a"] is not None or match["hour"] is not None)


def of_two_numbers(text: str) -> bool:
    """Whether a stamp is 12:34 alone, which may be hours and minutes or minutes and seconds."""
    match = STAMP.match(text.strip())
    plain = match is not None and match["a"] is None and match["second"] is None
    return plain and match is not None and match["half"] is None and match["zone"] is None


def nanoseconds(texts: Sequence[str]) -> list[int] | None:
    """Time since 1970 [ns] of stamps with a date, since midnight of those without; None if one is no stamp.

    Of two numbers that may be month or day, they are what lets the dates span the least. A clock that falls by more than half a
    day has gone past midnight.
    """
    found = [STAMP.match(text.strip()) for text in texts]
    if any(match is None or (match["a"] is None and match["hour"] is None) for match in found):
        return None
    matches = [match for match in found if match is not None]
    dated = matches[0]["a"] is not None
    if any((match["a"] is not None) != dated for match in matches):
        return None
    days = _days([(match["a"], match["b"], match["c"]) for match in matches]) if dated else [0] * len(matches)
    clocks = [_clock(match) for match in matches]
    if days is None or None in clocks:
        return None
    whole = [day * DAY + clock for day, clock in zip(days, clocks, strict=True) if clock is not None]
    return whole if dated else _past_midnight(whole)


def _days(dates: Sequence[tuple[str, str, str]]) -> list[int] | None:
    """Days since 1970 of dates of three parts; None if they are no dates under any one order of the parts."""
    distinct = set(dates)
    readings = []
    for order in ORDERS.values():
        try:
            days = {parts: _day(parts, order) for parts in distinct}
        except ValueError:
            continue
        readings.append(days)
    if not readings:
        return None
    least = min(readings, key=lambda days: max(days.values()) - min(days.values()))
    return [least[parts] for parts in dates]


def _day(parts: tuple[str, str, str], order: tuple[int, int, int]) -> int:
    """Days since 1970; raises ValueError if the parts are no date in that order."""
    year, month, day = (parts[k] for k in order)
    if len(year) != 4:
        raise ValueError("a year has four digits")
    number = MONTHS.index(month.lower()) + 1 if month.isalpha() else int(month)
    return date(int(year), number, int(day)).toordinal() - EPOCH


def _clock(match: re.Match[str]) -> int | None:
    """Time since midnight [ns], in UTC where a zone is told; None if there is no such time."""
    if match["hour"] is None:
        return 0
    hour, minute, second = int(match["hour"]), int(match["minute"]), int(match["second"] or 0)
    if match["half"] is not None:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if match["half"].lower() == "p" else 0)
    if hour > 24 or minute > 59 or second > 60:
        return None
    zone, shift = match["zone"] or "Z", 0
    if zone[0] in "+-":
        hours, minutes = int(zone[1:3]), int(zone[-2:]) if len(zone) > 3 else 0
        shift = (hours * 60 + minutes) * (60 if zone[0] == "+" else -60)
    part = int((match["part"] or "0").ljust(9, "0")[:9])
    return (hour * 3600 + minute * 60 + second - shift) * 10**9 + part


def _past_midnight(clocks: Sequence[int]) -> list[int]:
    """Readings of a clock without a date, a day later each time they fall by more than half of one."""
    whole, days = [clocks[0]], 0
    for before, after in pairwise(clocks):
        if after - before < -DAY // 2:
            days += 1
        whole.append(after + days * DAY)
    return whole
