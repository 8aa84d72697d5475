"""The process that tries MJCF for ``harness.system.mjcf_trial``: one document on standard input, limits on memory and time."""

from __future__ import annotations

import contextlib
import os
import pickle
import sys

from harness.errors import InputError
from harness.system.mjcf_trial import LONGEST
from harness.system.read_mjcf import load

MEMORY = 4 * 2**30  # [bytes]


def work() -> None:
    """Load what stands on standard input within limits; what is refused there is refused again by the reader."""
    data, source, allow = pickle.load(sys.stdin.buffer)
    with contextlib.suppress(ImportError, ValueError, OSError):  # not on Windows and macOS, where only time is limited
        import resource

        installed = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        for what, limit in (
            (resource.RLIMIT_AS, min(MEMORY, installed * 3 // 4)),
            (resource.RLIMIT_CPU, LONGEST),
            (resource.RLIMIT_CORE, 0),
        ):
            resource.setrlimit(what, (limit, resource.getrlimit(what)[1]))
    with contextlib.suppress(InputError, MemoryError):
        load(data, source, allow)
