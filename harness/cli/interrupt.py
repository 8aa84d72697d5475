"""Ctrl-C that is heard at once, and said in one line."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


class Interrupted(BaseException):
    """Ctrl-C, with what is to be said; click would put an empty line before it."""


_lost = threading.Event()


def swallowed() -> bool:
    """Whether Python had to swallow an interrupt, so that an error since then may be what that has left half done.

    From then on it does not come again.
    """
    if _lost.is_set() and hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    return _lost.is_set()


def of_interrupt(error: BaseException) -> bool:
    """Whether a Ctrl-C is at the beginning of an error: a compiled module that it hits while it loads says that it cannot."""
    seen: set[int] = set()
    cause: BaseException | None = error
    while cause is not None and id(cause) not in seen:
        if isinstance(cause, KeyboardInterrupt):
            return True
        seen.add(id(cause))
        cause = cause.__cause__ or cause.__context__
    return False


def hear_at_once() -> None:
    """Raise KeyboardInterrupt again where Python has to swallow it.

    Compiling a kernel calls back into Python from C; what is raised in there is printed and ignored, so that a Ctrl-C of
    that moment would be lost.
    """
    _lost.clear()
    if not hasattr(signal, "setitimer"):  # Windows
        return
    usual = sys.unraisablehook

    def hook(lost: Any) -> None:
        if lost.exc_type is KeyboardInterrupt:
            _lost.set()
            signal.setitimer(signal.ITIMER_REAL, 0.05)
        else:
            usual(lost)

    def again(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGALRM, again)
    sys.unraisablehook = hook


@contextmanager
def answers_to_interrupt(first: Callable[[], None]) -> Iterator[None]:
    """Inside, the first Ctrl-C calls ``first`` and nothing else; the next one stops as usual."""
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is signal.SIG_IGN:
        yield
        return

    def hear(number: int, frame: object) -> None:
        signal.signal(signal.SIGINT, before)
        first()

    signal.signal(signal.SIGINT, hear)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
