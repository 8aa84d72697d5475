"""What the methods of time stepping ask of lanes: copies of one mechanism; ``harness.denoc.lanes.model.LaneModel`` is one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from harness.system import System

Array = NDArray[np.float64]


class Copies(Protocol):
    """Rows of parameters of one topology, and their motion; shapes and units as in ``LaneModel``."""

    @property
    def system(self) -> System: ...
    @property
    def n(self) -> int: ...
    @property
    def user(self) -> int: ...
    def slot(self, site: str, name: str) -> int: ...
    def parts(self, rows: Array) -> Iterator[tuple[tuple[Any, ...], int, NDArray[np.int64]]]: ...
    def simulate(
        self,
        rows: Array,
        q0: Array,
        qd0: Array,
        time: Array,
        *,
        tau: Array | None = None,
        tolerance: float = ...,
        threads: int = 1,
    ) -> tuple[Array, Array, Array]: ...
