"""Whether what a fit leaves is a misfit or only noise that is louder in some places: a misfit goes on from sample to sample.

Noise of real sensors is seldom as loud everywhere: outliers, tails heavier than Gaussian, time stamps that are late while the joint
is fast, a motor switched on. None of that is left-out physics as long as samples do not follow one another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.constants import CORRELATION_LAGS
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


def by_channel(fitted: Fit, windows: Sequence[Window]) -> list[Array]:
    """Whitened residuals of some of a fit's windows, one (T,) a channel and window, channels of a window in a row."""
    return [
        own
        for window, r in zip(fitted.windows, fitted.linear.residuals, strict=True)
        if window in windows
        for own in r.reshape(-1, window.size)
    ]


def follows_itself(stretches: Sequence[Array]) -> float:
    """Chance that samples of stretches (T,) would follow one another so if they were independent, however loud each of them is.

    Autocorrelations over their own standard errors, which hold for any variance from sample to sample (Lo and MacKinlay, Rev.
    Financ. Stud. 1 (1988) 41, theorem 3; Escanciano and Lobato, J. Econometrics 151 (2009) 140).
    """
    total, count = 0.0, 0
    for lag in range(1, CORRELATION_LAGS + 1):
        along, variance = 0.0, 0.0
        for r in stretches:
            if len(r) >= 4 * lag:
                products = r[lag:] * r[:-lag]
                along += float(products.sum())
                variance += float(products @ products)
        if variance > 0.0:
            total += along**2 / variance
            count += 1
    return float(chi2.sf(total, count)) if count else 1.0
