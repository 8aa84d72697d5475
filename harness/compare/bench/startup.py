"""From the shell: how soon `denoc --help` answers, and how long the first acceleration takes, compiled code cached or not."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterable, Iterator
from functools import partial

from harness.compare.bench.measure import Timing, command, in_child
from harness.compare.bench.peers import Options, or_skipped
from harness.compare.bench.row import Row

HELP_LIMIT = 0.3
FIRST_USE_LIMIT = 20.0

_NATIVE = """
import numpy as np
from harness.denoc import Denoc
from harness.system.random_systems import random_chain
model = Denoc(random_chain(7, 1, prismatic=0.0))
answer = float(model.forward_dynamics(np.zeros(7), np.zeros(7), np.zeros(7))[0])
"""
_EVERYTHING = """
from harness.denoc.compiling import ahead
ahead.everything()
"""
_PINOCCHIO = """
import numpy as np
from harness.engines.pinocchio import Pinocchio
from harness.system.random_systems import random_chain
model = Pinocchio().build(random_chain(7, 1, prismatic=0.0))
answer = float(model.forward_dynamics(np.zeros(7), np.zeros(7), np.zeros(7))[0])
"""


def run(options: Options) -> Iterator[Row]:
    """Start-up rows; times are of whole processes."""
    yield from or_skipped("startup_help", None, "limit", partial(_help, options))
    yield from or_skipped("first_acceleration_cached", 7, "pinocchio", partial(_first, options))
    yield from or_skipped("first_acceleration_compiling", 7, "limit", _compiling)


def _help(options: Options) -> Iterable[Row]:
    from time import perf_counter

    seconds = []
    for _ in range(max(5, options.rounds // 2)):
        start = perf_counter()
        done = command([sys.executable, "-P", "-m", "harness", "--help"])
        seconds.append(perf_counter() - start)
        if done.returncode:
            raise RuntimeError(f"denoc --help ended with status {done.returncode}")
    timing = Timing.of(seconds)
    yield Row(
        "startup_help",
        None,
        "limit",
        timing.median,
        HELP_LIMIT,
        ours_spread=timing.spread,
        note="denoc --help, whole process, against the limit we set ourselves",
        wanted=1.0,
    )


def _first(options: Options) -> Iterable[Row]:
    ours: list[float] = []
    theirs: list[float] = []
    memory = {}
    for _ in range(max(3, options.rounds // 5)):
        for name, code, into in (("ours", _NATIVE, ours), ("theirs", _PINOCCHIO, theirs)):
            child = in_child(code)
            into.append(child.seconds)
            memory[name] = child.memory
    mine, other = Timing.of(ours), Timing.of(theirs)
    yield Row.timed(
        "first_acceleration_cached",
        7,
        "pinocchio",
        mine,
        other,
        note="a fresh process to its first acceleration, imports included, compiled code on disk",
    )
    yield Row(
        "first_acceleration_memory",
        7,
        "pinocchio",
        memory["ours"],
        memory["theirs"],
        unit="MB",
        note="peak memory of the same processes",
    )


def _compiling() -> Iterable[Row]:
    with tempfile.TemporaryDirectory() as folder:
        child = in_child(_NATIVE, environment={"NUMBA_CACHE_DIR": folder})
    yield Row(
        "first_acceleration_compiling",
        7,
        "limit",
        child.seconds,
        FIRST_USE_LIMIT,
        note="the same with nothing compiled yet, against the limit we set ourselves",
        wanted=1.0,
    )
    with tempfile.TemporaryDirectory() as folder:
        child = in_child(_EVERYTHING, environment={"NUMBA_CACHE_DIR": folder})
    yield Row(
        "all_kernels_compiling",
        None,
        "limit",
        child.seconds,
        FIRST_USE_LIMIT,
        note="every kernel, with nothing compiled yet, on the cores at hand, against the limit we set ourselves",
        wanted=1.0,
    )
