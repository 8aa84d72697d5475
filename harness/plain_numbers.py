"""Numbers as every program writes them: Python alone reads ``1_0`` and digits of other scripts."""

from __future__ import annotations

MOST_POINTS = 1e6  # that are told in full


def is_plain(text: str) -> bool:
    """Whether numbers in a text are read alike by C, XML and Python."""
    return "_" not in text and text.isascii()


def plain_number(text: str) -> float:
    """A number as C and XML write it, infinite and nan included; ValueError for anything else, what Python alone reads included."""
    if not is_plain(text):
        raise ValueError(text)
    return float(text)


def points(value: float) -> str:
    """A criterion's difference, or a sum of squares over noise, in whole points; beyond a million by three digits, as 1.64e12."""
    if not abs(value) >= MOST_POINTS:
        whole = f"{value:.0f}"
        return "0" if whole == "-0" else whole
    leading, _, power = f"{value:.2e}".partition("e")
    return f"{leading}e{int(power)}" if power else leading
