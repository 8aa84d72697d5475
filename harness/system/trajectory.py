"""Motion sampled in time, as any engine returns it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.system.description import Array


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion sampled in time.

    time: [s], shape (T,).
    position, velocity: coordinates by ``names`` [rad or m], shape (T, n).
    channels: further signals by recording column name (``rod.tip_deflection``, …), each shape (T,).
    energy: total mechanical energy [J], shape (T,), or None if the engine does not tell.
    method: how it was integrated, in words.
    events: times of events by name [s], for an engine that locates them.
    """

    time: Array
    names: tuple[str, ...]
    position: Array
    velocity: Array
    channels: Mapping[str, Array] = field(default_factory=dict)
    energy: Array | None = None
    method: str = ""
    events: Mapping[str, Array] = field(default_factory=dict)
