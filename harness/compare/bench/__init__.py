"""Benchmarks: ours and a peer's cost of the same work, side by side in one run. One file a benchmark.

``run(wanted, options)`` yields rows; what cannot be measured is a skipped row with the reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from importlib import import_module

import msgspec

from harness.compare.bench.measure import machine
from harness.compare.bench.peers import Options
from harness.compare.bench.row import Row, document
from harness.errors import InputError
from harness.journal import Journal
from harness.system.suggest import did_you_mean


@dataclass(frozen=True)
class Benchmark:
    """One file of this package: what it is, and the rows (``Row.what``) that it gives."""

    title: str
    rows: tuple[str, ...]


# By the name of the file, in the order they run.
BENCHMARKS = {
    "single_call": Benchmark(
        "one call from Python, n = 1 … 1000", ("forward_dynamics", "inverse_dynamics", "mass_matrix")
    ),
    "batch": Benchmark(
        "many states on one thread",
        (
            "forward_dynamics_batch",
            "inverse_dynamics_batch",
            "mass_matrix_batch",
            "mass_matrix_batch_large",
            "forward_dynamics_batch_two_threads",
            "inverse_dynamics_batch_two_threads",
            "mass_matrix_batch_two_threads",
        ),
    ),
    "scaling": Benchmark(
        "growth of cost with size, and memory at n = 10 000",
        ("forward_dynamics_exponent", "forward_dynamics_scaling", "forward_dynamics_memory"),
    ),
    "simulation": Benchmark(
        "whole runs of 10 s at 1 kHz against mujoco.rollout",
        ("simulation_many", "simulation_many_rk4", "simulation_one", "simulation_one_rk4", "simulation_two_threads"),
    ),
    "flexible": Benchmark(
        "a flexible pendulum against Exudyn's finite elements at the same accuracy",
        ("flexible_pendulum", "flexible_pendulum_many"),
    ),
    "floating": Benchmark("many states of floating robots on one thread", ("floating_forward_dynamics_batch",)),
    "loops": Benchmark("a planar four-bar mechanism at equal error", ("four_bar",)),
    "loop_scaling": Benchmark(
        "growth of cost with the tree around a loop, and with the number of loops",
        ("loop_tree_exponent", "loop_count_exponent", "loop_scaling"),
    ),
    "diagnosis": Benchmark(
        "a full diagnosis against one mujoco.sysid fit of the same recordings",
        ("diagnosis", "diagnosis_memory", "diagnosis_one_recording", "diagnosis_one_recording_memory"),
    ),
    "startup": Benchmark(
        "denoc --help, and the first acceleration of a fresh process",
        (
            "startup_help",
            "first_acceleration_cached",
            "first_acceleration_memory",
            "first_acceleration_compiling",
            "all_kernels_compiling",
        ),
    ),
    "suite": Benchmark("denoc validate in full", ("validate_in_full",)),
}
# Minutes long, and a test of everything else: only when asked for.
LEFT_OUT = ("suite",)

__all__ = ["BENCHMARKS", "Benchmark", "Options", "Row", "document", "machine", "run", "select"]


def select(wanted: Sequence[str] | None = None) -> dict[str, tuple[str, ...]]:
    """Which rows of which benchmark are wanted: benchmarks or rows by name, ``forward*`` takes all that start so.

    None takes all but the suite. Raises InputError for a name that nothing has.
    """
    if not wanted:
        return {name: benchmark.rows for name, benchmark in BENCHMARKS.items() if name not in LEFT_OUT}
    chosen: dict[str, tuple[str, ...]] = {}
    for name in wanted:
        found = False
        for key, benchmark in BENCHMARKS.items():
            rows = (
                benchmark.rows if fnmatchcase(key, name) else tuple(r for r in benchmark.rows if fnmatchcase(r, name))
            )
            if rows:
                found = True
                chosen[key] = tuple(r for r in benchmark.rows if r in (*chosen.get(key, ()), *rows))
        if not found:
            known = dict.fromkeys((*BENCHMARKS, *(row for benchmark in BENCHMARKS.values() for row in benchmark.rows)))
            raise InputError(f"no benchmark is named {name!r}", mend=did_you_mean(name, known))
    return {key: chosen[key] for key in BENCHMARKS if key in chosen}


def run(
    wanted: Sequence[str] | None = None, options: Options | None = None, journal: Journal | None = None
) -> Iterator[Row]:
    """Rows as they are measured; ``wanted`` as in ``select``, which raises before anything runs.

    journal: keeps the rows of each benchmark once all of them are measured; those that it has are not measured again.
    """
    chosen = options or Options()
    for name, rows in select(wanted).items():
        if journal is not None and name in journal.found:
            yield from (msgspec.convert(row, Row) for row in journal.found[name])
            continue
        chosen.tell(f"{name}: {BENCHMARKS[name].title}")
        measured = []
        for row in import_module(f"harness.compare.bench.{name}").run(chosen):
            if row.what in rows:
                measured.append(row)
                yield row
        if journal is not None:
            journal.add(name, [asdict(row) for row in measured])
