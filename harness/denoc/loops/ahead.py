"""The kernel of closed loops, for compiling ahead of use."""

from __future__ import annotations

from harness.denoc.loops.address import address


def loops() -> None:
    """The dynamics of closed mechanisms."""
    address()
