"""Sine and cosine together, for kernels.

A call into the C library costs about as much as a fifth of a link's articulated inertia; the polynomial below is inlined.
"""

from __future__ import annotations

import math

import numpy as np

from harness.denoc.compiling.compiled import internal

# pi/2 in three parts of 33 bits, so that k · part is exact for |k| < 2^20 (Cody-Waite reduction).
_PART1 = float.fromhex("0x1.921fb54400000p+0")
_PART2 = float.fromhex("0x1.0b4611a600000p-34")
_PART3 = float.fromhex("0x1.3198a2e037073p-69")
_TWO_OVER_PI = 2.0 / math.pi
_REACH = 1.0e6

# Taylor coefficients: on |r| <= pi/4 the first term left out is below 5e-17.
_S3, _S5, _S7, _S9 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880
_S11, _S13, _S15 = -1 / 39916800, 1 / 6227020800, -1 / 1307674368000
_C2, _C4, _C6, _C8 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320
_C10, _C12, _C14, _C16 = -1 / 3628800, 1 / 479001600, -1 / 87178291200, 1 / 20922789888000


@internal
def sincos(x: float) -> tuple[float, float]:
    """Sine and cosine of x [rad], each within one unit in the last place of 1; any finite x."""
    if not (-_REACH < x < _REACH):
        return math.sin(x), math.cos(x)
    k = np.floor(x * _TWO_OVER_PI + 0.5)
    r = ((x - k * _PART1) - k * _PART2) - k * _PART3
    z = r * r
    s = r + r * z * (_S3 + z * (_S5 + z * (_S7 + z * (_S9 + z * (_S11 + z * (_S13 + z * _S15))))))
    c = 1.0 + z * (_C2 + z * (_C4 + z * (_C6 + z * (_C8 + z * (_C10 + z * (_C12 + z * (_C14 + z * _C16)))))))
    quadrant = np.int64(k)
    if quadrant & 1:
        s, c = c, -s
    if quadrant & 2:
        s, c = -s, -c
    return s, c
