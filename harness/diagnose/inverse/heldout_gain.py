"""How much data not fitted to gain by a further effect, beside what noise would do to that."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def heldout_gain(before: Array, after: Array) -> float:
    """Gain in cost on data not fitted to, in standard deviations of what the noise would do to it.

    With δ the change of the residual, the gain is Σ(r₀² − r₁²); its spread 2 (Σ_b (Σ_{t∈b} r₁ δ)²)^½ is taken over blocks b,
    so that correlated residuals count as such, and is at least that of white noise, 2|δ| (Vuong, Econometrica 57 (1989) 307).
    """
    delta = after - before
    gain = float(before @ before - after @ after)
    blocks = np.array_split(after * delta, max(8, min(40, len(delta) // 50)))
    spread = 2.0 * max(float(np.sqrt(sum(float(np.sum(b)) ** 2 for b in blocks))), float(np.linalg.norm(delta)))
    return gain / spread if spread > 0.0 else 0.0
