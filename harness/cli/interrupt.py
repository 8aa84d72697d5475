"""Ctrl-C that is heard at once, and said in one line."""

from __future__ import annotations

import signal
import sys
from typing import Any


class Interrupted(BaseException):
    """Ctrl-C, with what is to be said; click would put an empty line before it."""


def hear_at_once() -> None:
    """Raise KeyboardInterrupt again where Python has to swallow it.

    Compiling a kernel calls back into Python from C; what is raised in there is printed and ignored, so that a Ctrl-C of
    that moment would be lost.
    """
    if not hasattr(signal, "setitimer"):  # Windows
        return
    usual = sys.unraisablehook

    def swallowed(lost: Any) -> None:
        if lost.exc_type is KeyboardInterrupt:
            signal.setitimer(signal.ITIMER_REAL, 0.05)
        else:
            usual(lost)

    def again(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGALRM, again)
    sys.unraisablehook = swallowed
