"""Numbers as every program writes them: Python alone reads ``1_0`` and digits of other scripts."""

from __future__ import annotations


def is_plain(text: str) -> bool:
    """Whether numbers in a text are read alike by C, XML and Python."""
    return "_" not in text and text.isascii()


def plain_number(text: str) -> float:
    """A number as C and XML write it, infinite and nan included; ValueError for anything else, what Python alone reads included."""
    if not is_plain(text):
        raise ValueError(text)
    return float(text)
