"""The mechanisms and states that benchmarks run on, and the peers' own objects for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compare.bench.row import Row, skipped
from harness.engines import registry
from harness.errors import EngineUnavailableError, UnsupportedError, missing_package
from harness.system import System
from harness.system.load import load
from harness.system.lowering import freed
from harness.system.random_systems import random_chain

Array = NDArray[np.float64]

# Real robots of example-robot-data for which throughput is measured as well, if it is installed.
ROBOTS = ("panda_arm.urdf", "panda.urdf", "talos_reduced.urdf", "so101.urdf")


@dataclass(frozen=True)
class Options:
    """What to measure: quick takes the small mechanisms only and fewer rounds. tell: called with what is begun."""

    quick: bool = False
    rounds: int = 15
    tell: Callable[[str], None] = field(default=lambda what: None, repr=False)

    def sizes(self, all_sizes: Iterable[int]) -> tuple[int, ...]:
        """The sizes to measure."""
        return tuple(n for n in all_sizes if n <= 50 or not self.quick)


@dataclass(frozen=True, eq=False)
class States:
    """Random states of a mechanism, each (B, n): positions over the full turn, velocities and forces of order one."""

    q: Array
    qd: Array
    tau: Array = field(repr=False)


def chain(n: int) -> System:
    """A serial chain of ``n`` revolute joints with general axes, offsets and bodies."""
    return random_chain(n, 1, prismatic=0.0, armature=True)


def states(n: int, count: int) -> States:
    """``count`` states of ``n`` coordinates, the same at every call."""
    rng = np.random.default_rng(n)
    return States(rng.uniform(-np.pi, np.pi, (count, n)), rng.normal(size=(count, n)), rng.normal(size=(count, n)))


def robots() -> Iterator[tuple[str, System]]:
    """Real robots by file name, joints that mimic others independent; none if example-robot-data is not installed."""
    try:
        files = metadata.files("example-robot-data") or []
    except metadata.PackageNotFoundError:
        return
    for file in sorted(files, key=str):
        if file.name in ROBOTS:
            yield file.name, freed(load(Path(str(file.locate()))))


def native(system: System) -> Any:
    """The system in the native dynamics, without the adapter around it."""
    from harness.denoc import Denoc

    return Denoc(system)


def peer_model(name: str, system: System) -> Any:
    """The adapter of a peer for the system; UnsupportedError or EngineUnavailableError with the reason."""
    engine = registry.engine(name)
    engine.version()
    return engine.build(system)


def or_skipped(
    what: str, n: int | None, peer: str, measure: Callable[[], Iterable[Row]], *, case: str = ""
) -> Iterator[Row]:
    """The rows of a measurement, or one skipped row with the reason why it could not be made."""
    try:
        rows = list(measure())
    except (EngineUnavailableError, UnsupportedError, ImportError, AttributeError, RuntimeError) as error:
        absent = missing_package(error) if isinstance(error, ImportError) else None
        text = " ".join(str(absent or error).split()) or type(error).__name__
        rows = [skipped(what, n, peer, text, case=case)]
    yield from rows
