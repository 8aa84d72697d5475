"""Wall time and memory, measured so that two engines meet the same machine at the same moment."""

from __future__ import annotations

import gc
import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

ROUNDS = 15
ROUND_SECONDS = 0.02
# What a child process may take before it is given up [s].
PATIENCE = 300.0


@dataclass(frozen=True)
class Timing:
    """Seconds for one call: median and quartiles over rounds, each round many calls."""

    median: float
    low: float
    high: float
    rounds: int

    @classmethod
    def of(cls, seconds: Sequence[float]) -> Timing:
        """Of one value [s] a round."""
        low, median, high = np.percentile(seconds, [25.0, 50.0, 75.0])
        return cls(float(median), float(low), float(high), len(seconds))

    def per(self, count: int) -> Timing:
        """The same for one of ``count`` items that a call deals with."""
        return Timing(self.median / count, self.low / count, self.high / count, self.rounds)

    @property
    def spread(self) -> tuple[float, float]:
        return self.low, self.high


def side_by_side(
    calls: Mapping[str, Callable[[], object]],
    *,
    rounds: int = ROUNDS,
    round_seconds: float = ROUND_SECONDS,
    clock: Callable[[], float] = perf_counter,
) -> dict[str, Timing]:
    """Time each call, in turn within every round, so that what disturbs the machine disturbs all alike.

    Each call is run once before anything is measured. A round repeats a call for about ``round_seconds``. clock: seconds; of
    calls of very different length that run on one thread, the processor's, which other work beside them does not reach.
    """
    counts = {name: _count(call, round_seconds, clock) for name, call in calls.items()}
    taken: dict[str, list[float]] = {name: [] for name in calls}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(rounds):
            for name, call in calls.items():
                repeat = range(counts[name])
                start = clock()
                for _ in repeat:
                    call()
                taken[name].append((clock() - start) / counts[name])
    finally:
        if collecting:
            gc.enable()
    return {name: Timing.of(values) for name, values in taken.items()}


def processor_time(call: Callable[[], object], rounds: int = ROUNDS) -> tuple[float, float]:
    """Seconds of processor time that so many calls take on all threads together, and how many threads ran meanwhile on average."""
    began, start = perf_counter(), process_time()
    for _ in range(rounds):
        call()
    took = process_time() - start
    return took, took / (perf_counter() - began)


def _count(call: Callable[[], object], seconds: float, clock: Callable[[], float]) -> int:
    call()
    count = 1
    while True:
        start = clock()
        for _ in range(count):
            call()
        took = clock() - start
        if took >= 0.2 * seconds or count >= 1_000_000:
            return max(1, round(count * seconds / max(took, 1e-9)))
        count *= 4


@dataclass(frozen=True)
class Child:
    """A fresh process: wall time from start to end [s], peak memory [MB] (nan if unknown), and what it answered."""

    seconds: float
    memory: float
    answer: Any


_WRAP = """
import json, sys
def _peak():
    # The high-water mark of this process alone; getrusage would count the parent's from before exec.
    try:
        for line in open("/proc/self/status"):
            if line.startswith("VmHWM"):
                return int(line.split()[1]) / 1024.0
    except OSError:
        pass
    return float("nan")
answer = None
{code}
print("\\n" + json.dumps({{"memory": _peak(), "answer": answer}}))
"""


def in_child(code: str, *, environment: Mapping[str, str] | None = None, patience: float = PATIENCE) -> Child:
    """Run Python code in a fresh interpreter; what it assigns to ``answer`` comes back.

    Raises RuntimeError with the last line of the error if the code fails or takes longer than ``patience`` [s].
    """
    start = perf_counter()
    done = command([sys.executable, "-c", _WRAP.format(code=code)], environment=environment, patience=patience)
    seconds = perf_counter() - start
    if done.returncode:
        lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        # Messages of several lines end anywhere; the kind of error stands at the beginning of one.
        named = [line for line in lines if line.split(":")[0].endswith("Error")]
        raise RuntimeError((named or lines or [f"ended with status {done.returncode}"])[-1])
    told = json.loads(done.stdout.strip().splitlines()[-1])
    return Child(seconds, float(told["memory"]), told["answer"])


def command(
    arguments: list[str],
    *,
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
    patience: float = PATIENCE,
) -> subprocess.CompletedProcess[str]:
    """A process run to its end, output captured; RuntimeError if it takes longer than ``patience`` [s]."""
    try:
        return subprocess.run(
            arguments,
            capture_output=True,
            text=True,
            timeout=patience,
            check=False,
            cwd=folder,
            env={**os.environ, **(environment or {})},
        )
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"took longer than {patience:g} s") from None


def machine() -> dict[str, Any]:
    """What a reader needs to know about where the figures come from."""
    name = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    return {
        "processor": name,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
