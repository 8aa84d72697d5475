"""Compiled kernels are kept on disk where that can be done, and done without where it cannot: a full disk is no fault of a kernel.

numba raises where no folder can be written to, where the disk is full when it writes, and where a file that it kept is damaged.
"""

from __future__ import annotations

import logging
from functools import cache
from typing import Any

from numba import config
from numba.core import ccallback, dispatcher
from numba.core.caching import FunctionCache, NullCache

_log = logging.getLogger(__name__)


class Kept(FunctionCache):
    """numba's cache of one kernel; what cannot be read is compiled anew, what cannot be written is told once."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # a file cut off or overwritten: whatever unpickling raises
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            try:
                super().save_overload(sig, data)
            except OSError:
                raise
            except Exception:  # the list of what is kept was cut off or overwritten: begun anew
                self.flush()
                super().save_overload(sig, data)
        except OSError as error:
            _tell(f"compiled kernels could not be kept in {self.cache_path}: {error.strerror or error}")


def _cache_of(function: Any) -> Any:
    """What keeps a function; nothing, where no folder can be written to."""
    wanted = config.CACHE_DIR
    try:
        kept = Kept(function)
    except (RuntimeError, OSError):
        _tell("there is no place to keep compiled kernels in, so every run compiles them anew")
        return NullCache()
    if wanted and not kept.cache_path.startswith(wanted):
        _tell(f"NUMBA_CACHE_DIR={wanted} cannot be written to, so compiled kernels are kept elsewhere")
    return kept


def place() -> str:
    """Where compiled kernels are kept, or why they are not, in words."""
    wanted = config.CACHE_DIR
    try:
        kept = Kept(forgive)  # a function like any of this package
    except (RuntimeError, OSError):
        return "nowhere: no folder can be written to, so every run compiles them anew"
    if wanted and kept.cache_path.startswith(wanted):
        return str(wanted)
    used = "__pycache__ beside the modules"
    if not kept.cache_path.endswith("__pycache__"):
        used = str(kept.cache_path)
    return f"{used} ({wanted} cannot be written to)" if wanted else f"{used} (NUMBA_CACHE_DIR moves them)"


@cache
def _tell(what: str) -> None:
    """Once for each thing that is said, however many kernels there are."""
    _log.warning("%s (NUMBA_CACHE_DIR=FOLDER names a folder that can be written to)", what)


def forgive() -> None:
    """Let numba keep kernels so from now on in this process; left as it is where this numba is built otherwise."""
    for module in (dispatcher, ccallback):
        if getattr(module, "FunctionCache", None) is FunctionCache:
            setattr(module, "FunctionCache", _cache_of)  # noqa: B010
