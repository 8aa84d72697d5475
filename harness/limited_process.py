"""Processes of their own for what compiled libraries may crash on: how one is started, and limits that it sets itself."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path


def command(start: str) -> list[str]:
    """A Python process that finds packages where this one does, and runs ``start``."""
    return [sys.executable, "-c", f"import sys; sys.path[:] = {sys.path!r}; {start}"]


def environment() -> dict[str, str]:
    """This process's, with one thread: work there is small, and every other would reserve memory that counts against a limit."""
    return {**os.environ, **{f"{pool}_NUM_THREADS": "1" for pool in ("OMP", "OPENBLAS", "MKL")}}


def within_installed(memory: int) -> int:
    """So much memory [bytes], but no more than three quarters of what there is."""
    try:
        installed = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on Windows
        return memory
    return min(memory, installed * 3 // 4)


def limit(memory: int, seconds: float) -> None:
    """Limit this process to memory [bytes] beyond what it has, and to processor time [s] from now on."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (ImportError, OSError):  # not on Windows and macOS, where only time is limited, from outside
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    for what, most in (
        (resource.RLIMIT_AS, pages * resource.getpagesize() + memory),
        (resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime + seconds) + 1),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(what)
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
