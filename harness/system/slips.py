"""How a number gets into a table wrong, and what it may have been: the slips an audit tries to undo.

A slip costs minus the logarithm of its prior probability [nats], so that the costs of several slips add up and can be
held against a misfit ½χ². The priors are round figures: one entry in a hundred suffers each kind of slip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

_ONCE_IN_A_HUNDRED = math.log(100.0)
_SAME = 1e-9


@dataclass(frozen=True)
class Slip:
    """One way to undo a slip: what the number becomes, what happened to it, and its cost [nats]."""

    value: float
    what: str
    cost: float


def slips(value: float, *, length: bool = False) -> tuple[Slip, ...]:
    """What a printed positive number may have been meant to be, cheapest slip first, each value once.

    length: whether it is a length, which may be a diameter for a radius, or in mm.
    """
    found = [
        Slip(value * 10.0**power, f"decimal point by {abs(power)}", _ONCE_IN_A_HUNDRED + math.log(4.0))
        for power in (-2, -1, 1, 2)
    ]
    found += [
        Slip(value * factor, f"unit prefix (factor {factor:g})", _ONCE_IN_A_HUNDRED + math.log(6.0))
        for factor in (1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9)
    ]
    if length:
        found += [Slip(value * factor, "half for whole", _ONCE_IN_A_HUNDRED + math.log(2.0)) for factor in (0.5, 2.0)]
    exponent = math.floor(math.log10(value))
    if abs(exponent) >= 2:
        found.append(Slip(value * 10.0 ** (-2 * exponent), "sign of the exponent", _ONCE_IN_A_HUNDRED))
    found += _digits(value)
    best: list[Slip] = []
    for slip in sorted(found, key=lambda s: s.cost):
        if all(abs(slip.value - other.value) > _SAME * slip.value for other in best):
            best.append(slip)
    return tuple(best)


def _digits(value: float) -> list[Slip]:
    """One significant digit misprinted; the spread over nine others and all places makes each of them unlikely."""
    mantissa, _, exponent = f"{value:.6e}".partition("e")
    digits = mantissa.replace(".", "").rstrip("0") or "0"
    cost = _ONCE_IN_A_HUNDRED + math.log(9.0 * len(digits))
    found = []
    for place, digit in enumerate(digits):
        for other in "0123456789":
            if other == digit or (other == "0" and place == 0):
                continue
            changed = digits[:place] + other + digits[place + 1 :]
            number = float(f"{changed[0]}.{changed[1:] or '0'}e{exponent}")
            found.append(Slip(number, f"digit {digit} for {other}", cost))
    return found
