"""The main job in full, from the shell: how long `denoc validate` takes on this machine."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from time import perf_counter

from harness.compare.bench.measure import command
from harness.compare.bench.peers import Options, or_skipped
from harness.compare.bench.row import Row

LIMIT = 180.0
# Given up after this [s].
LONGEST = 600.0


def run(options: Options) -> Iterator[Row]:
    """One row: the whole built-in suite over all engines, on all cores, with nothing compiled yet."""
    yield from or_skipped("validate_in_full", None, "limit", partial(_suite, options))


def _suite(options: Options) -> Iterable[Row]:
    options.tell("suite: denoc validate in full, with nothing compiled yet, minutes")
    with tempfile.TemporaryDirectory() as folder:
        start = perf_counter()
        done = command(
            [sys.executable, "-P", "-m", "harness", "validate", "--out", folder],
            folder=Path(folder),
            environment={"NUMBA_CACHE_DIR": str(Path(folder) / "compiled")},
            patience=LONGEST,
        )
        seconds = perf_counter() - start
    if done.returncode > 1:
        raise RuntimeError(f"denoc validate ended with status {done.returncode}: {done.stderr.strip()[-200:]}")
    note = "denoc validate, whole process, nothing compiled yet, against the limit we set ourselves"
    if done.returncode:
        note += "; some rows were out of tolerance"
    yield Row("validate_in_full", None, "limit", seconds, LIMIT, note=note, wanted=1.0)
