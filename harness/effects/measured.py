"""What the catalogue needs to know of a recording, so that it need not import how recordings are read."""

from __future__ import annotations

from typing import Protocol

from harness.system.description import Array


class MeasuredChannel(Protocol):
    """One column: ``name`` is ``site.quantity``; ``values`` in SI, shape (T,)."""

    @property
    def name(self) -> str: ...
    @property
    def site(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def values(self) -> Array: ...


class Measured(Protocol):
    """A recording: measured channels and known efforts over time [s], shape (T,)."""

    @property
    def time(self) -> Array: ...
    @property
    def channels(self) -> tuple[MeasuredChannel, ...]: ...
    @property
    def efforts(self) -> tuple[MeasuredChannel, ...]: ...
