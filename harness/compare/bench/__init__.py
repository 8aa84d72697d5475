"""Benchmarks: ours and a peer's cost of the same work, side by side in one run. One file a benchmark.

``run(names, options)`` yields rows; what cannot be measured is a skipped row with the reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module

from harness.compare.bench.measure import machine
from harness.compare.bench.peers import Options
from harness.compare.bench.row import Row, document
from harness.errors import InputError
from harness.system.suggest import did_you_mean

# Name to what it measures, in the order they run.
BENCHMARKS = {
    "single_call": "one call from Python, n = 1 … 1000",
    "batch": "many states on one thread",
    "scaling": "growth of cost with size, and memory at n = 10 000",
    "simulation": "whole runs of 10 s at 1 kHz against mujoco.rollout",
    "flexible": "a flexible pendulum against Exudyn's finite elements at the same accuracy",
    "diagnosis": "a full diagnosis against one mujoco.sysid fit",
    "startup": "denoc --help, first acceleration of a fresh process",
    "suite": "denoc validate in full",
}

__all__ = ["BENCHMARKS", "Options", "Row", "document", "machine", "run"]


def run(names: Sequence[str] | None = None, options: Options | None = None) -> Iterator[Row]:
    """Rows of the named benchmarks (all but the suite if None), as they are measured; InputError for an unknown name."""
    chosen = list(names) if names else [name for name in BENCHMARKS if name != "suite"]
    for name in chosen:
        if name not in BENCHMARKS:
            raise InputError(f"no benchmark is named {name!r}", mend=did_you_mean(name, tuple(BENCHMARKS)))
    for name in chosen:
        yield from import_module(f"harness.compare.bench.{name}").run(options or Options())
