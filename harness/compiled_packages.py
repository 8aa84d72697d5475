"""Compiled packages loaded whole: a Ctrl-C that falls into it is heard when they are there."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any


def loaded(name: str, *modules: str) -> Any:
    """The package of that name, imported with these modules of it; ImportError where one cannot be."""
    if any(sys.modules.get(wanted) is None for wanted in (name, *modules)):
        with interrupts_held():
            for wanted in (name, *modules):
                import_module(wanted)
    return sys.modules[name]


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Within it a Ctrl-C waits; it is raised at the end, whatever else happened.

    A compiled package that is interrupted while it loads says that it cannot be loaded, some after they have hidden why, and is
    then taken for one that is broken or not there.
    """
    # SIGALRM is how an interrupt that Python had to swallow comes again.
    numbers = [signal.SIGINT, *([signal.SIGALRM] if hasattr(signal, "SIGALRM") else [])]
    before = {number: signal.getsignal(number) for number in numbers}
    held = [number for number in numbers if callable(before[number])]
    if threading.current_thread() is not threading.main_thread() or not held:
        yield
        return
    heard: list[int] = []
    for number in held:
        signal.signal(number, lambda number, frame: heard.append(number))
    try:
        yield
    finally:
        for number in held:
            signal.signal(number, before[number])
        if heard:
            signal.raise_signal(heard[0])
