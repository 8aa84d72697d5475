"""The process that tries MJCF for ``harness.system.mjcf_trial``: one document on standard input, limits on memory and time."""

from __future__ import annotations

import contextlib
import pickle
import sys

from harness.errors import InputError
from harness.limited_process import limit, within_installed
from harness.system.mjcf_trial import LONGEST
from harness.system.read_mjcf import load

MEMORY = 4 * 2**30  # [bytes]


def work() -> None:
    """Load what stands on standard input within limits; what is refused there is refused again by the reader."""
    data, source, allow = pickle.load(sys.stdin.buffer)
    limit(within_installed(MEMORY), LONGEST)
    with contextlib.suppress(InputError, MemoryError):
        load(data, source, allow)
