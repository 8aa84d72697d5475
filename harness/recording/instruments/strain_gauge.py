"""Strain gauges at the root of a link, read as deflection of its tip by a line found with the link clamped and loaded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.system.description import Array


@dataclass(frozen=True)
class StrainBridge:
    """A full bridge at the root and its calibration line, metres of tip deflection over strain.

    length [m]; half_depth [m]: of the strip. noise: standard deviation in strain. drift: apparent strain by temperature [1/K] times
    warming [K/s]; a full bridge cancels most of it, so it is what remains.

    The line is that of a cantilever with a load at its tip: deflection P l³ / 3EI, root strain P l c / EI, so l² / 3c. It holds
    for that load alone. A link that is free to turn at its root has no bending moment there but its hub's, and vibrates with hardly
    any strain at the gauges: the line then says far too little.
    Source: E. O. Doebelin, Measurement Systems (2004), §4.4; S. P. Timoshenko, Strength of Materials.
    """

    length: float
    half_depth: float
    noise: float = 2e-7
    drift: float = 1e-6
    warming: float = 0.0

    @property
    def line(self) -> float:
        """Tip deflection over root strain [m]."""
        return self.length**2 / (3.0 * self.half_depth)

    def read(self, strain: Array, time: Array, rng: np.random.Generator | None = None) -> Array:
        """Tip deflection [m] as the calibration has it, (T,), of the strain at the gauges (T,) over time [s] (T,)."""
        seen = strain + self.drift * self.warming * (time - time[0])
        if rng is not None and self.noise:
            seen = seen + self.noise * rng.standard_normal(len(time))
        return np.asarray(self.line * seen)
