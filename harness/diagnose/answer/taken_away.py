"""What is left of dissipation that a model states, where an effect takes all of it away.

Such an effect's number is what is added to the model's own: at the least that it may be, none of that is left (``with_room``).
"""

from __future__ import annotations

from harness.diagnose.answer.constants import TOLD_REST
from harness.diagnose.answer.significant_digits import Interval, resolved
from harness.effects.catalogue import catalogue
from harness.effects.room import STATED


def none_left(effect: str, value: float | None, std: float | None, interval: Interval, unit: str) -> str:
    """That none is left of what a model states, how much that was, and how much of it may be left; nothing where it is not so.

    effect: its name or its title. std: None where the value lies at a bound, as of an ``Estimate``. interval: 95 %; its low end is
    then the bound.
    """
    low, high = interval or (None, None)
    if value is None or std is not None or low is None or not value < 0.0 or effect not in _named():
        return ""
    rest = (
        "" if high is None or high - low < TOLD_REST * -low else f", {100.0 * (high - low) / -low:.2g} % at most (95 %)"
    )
    return f"none of the stated {resolved(-low, None)}{f' {unit}' if unit else ''} is left{rest}"


def _named() -> set[str]:
    """Names and titles of effects that may take away what a model states."""
    return {*STATED, *(catalogue()[name].title for name in STATED)}
