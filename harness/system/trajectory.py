"""Motion sampled in time, as any engine returns it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.system.description import Array


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion sampled in time.

    time: [s], shape (T,).
    names: of the velocities, shape (n,), and of the positions but where ``position_names`` says otherwise.
    position, velocity: positions (T, nq) and velocities (T, n) [rad or m, rad/s or m/s].
    channels: further signals by recording column name (``rod.tip_deflection``, …), each shape (T,).
    energy: total mechanical energy [J], shape (T,), or None if the engine does not tell.
    method: how it was integrated, in words.
    events: times of events by name [s], for an engine that locates them.
    position_names: of the positions, where joints have several degrees of freedom; else those of the velocities.
    """

    time: Array
    names: tuple[str, ...]
    position: Array
    velocity: Array
    channels: Mapping[str, Array] = field(default_factory=dict)
    energy: Array | None = None
    method: str = ""
    events: Mapping[str, Array] = field(default_factory=dict)
    position_names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.position_names:
            object.__setattr__(self, "position_names", self.names)
