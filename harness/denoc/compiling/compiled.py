"""How kernels are compiled, said once."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

from harness.denoc.compiling.known_types import remember
from harness.denoc.compiling.pipeline import Kernel, Part, ShortLoops
from harness.kept_kernels import Kept, forgive

F = TypeVar("F", bound=Callable[..., Any])

# Fused multiply-add and free signs of zero, nothing that changes what NaN and infinity mean: bad input must stay visible.
FAST_MATH = {"contract", "nsz"}

# Of what is called from Python, and through no address.
_ENTRY: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": FAST_MATH, "no_cfunc_wrapper": True}


def compiled(function: F) -> F:
    """The function as a kernel: compiled at first use, cached on disk, no bounds checks, division by zero gives inf."""
    return cast(F, njit(pipeline_class=Kernel, **_ENTRY)(function))


def stepper(function: F) -> F:
    """As ``compiled``, for what integrates in time: loops over coordinates are not worth being unrolled or vectorised."""
    return cast(F, njit(pipeline_class=ShortLoops, **_ENTRY)(function))


# Of what only kernels call: no way in from Python, and, unless arrays are made, no counting of references to them, whose calls
# lie across vectors in registers.
_PART: dict[str, Any] = {
    "error_model": "numpy",
    "fastmath": FAST_MATH,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": Part,
}


def internal(function: F) -> F:
    """As ``compiled``, for what only kernels call and makes no arrays: a part of each kernel that calls it."""
    return cast(F, njit(_nrt=False, **_PART)(function))


def allocating(function: F) -> F:
    """As ``internal``, for what makes arrays or returns them."""
    return cast(F, njit(**_PART)(function))


def inlined(function: F) -> F:
    """As ``internal``, and always put in place of its call: for pieces of a recursion that run once a body."""
    return cast(F, njit(_nrt=False, forceinline=True, **_PART)(function))


#: Beside the kernels of this folder: the versions of all files that they were made with.
STAMP = "kernels.stamp"


def cache_folder(room: Path) -> Path:
    """Where numba keeps what is compiled of the files in a folder; raises OSError where it keeps nothing."""
    kept = getattr(compiled(cache_folder), "_cache", None)
    if not isinstance(kept, Kept):
        raise FileNotFoundError("no place to keep compiled kernels in")
    locator = kept._impl.locator
    return Path(type(locator)(cache_folder, str(room / "kernel.py")).get_cache_path())


def versions_of(home: Path) -> str:
    """Which versions of the files below ``home`` are there, as the stamp beside the kernels has it."""
    files = [(path.relative_to(home), path.stat()) for path in sorted(home.glob("*/*.py"))]
    return " ".join(f"{path.as_posix()}:{file.st_size}:{file.st_mtime_ns}" for path, file in files)


def _drop_stale_cache() -> None:
    """Remove cached kernels that were made with other versions of these files than are here now.

    Kernels are linked into kernels of other files, whose cached code numba goes on using when they change: it looks at the one
    file alone.
    """
    home = Path(__file__).parents[1]
    # A place that cannot be read or written to holds no cache of numba's either.
    with contextlib.suppress(OSError):
        now = versions_of(home)
        own = cache_folder(Path(__file__).parent)
        stamp = own / STAMP
        if stamp.is_file() and stamp.read_text() == now:
            return
        for room in {path.parent for path in home.glob("*/*.py")}:
            for index in cache_folder(room).glob("*.nbi"):
                index.unlink(missing_ok=True)
        own.mkdir(parents=True, exist_ok=True)
        stamp.write_text(now)


forgive()
_drop_stale_cache()
remember()
