"""Nominal quantities that had to leave their stated tolerance to fit, which is a remainder too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.stats import chi2

from harness.diagnose.criticism.check import Asked, Check, Remainder, Test

OUTSIDE = "nominal quantities outside their tolerance"


def _asked(left: Remainder) -> Iterator[Test]:
    """A test that counts, if they had to."""
    fitted = left.fitted
    z = fitted.x[: len(left.predictor.nominal)]
    if not left.study.stretched(fitted):
        return
    chance = float(chi2.sf(fitted.prior, max(len(z), 1)))
    worst = int(np.argmax(np.abs(z)))
    quantity = left.predictor.nominal[worst]
    where = f"{quantity.kind} of {quantity.name} by {z[worst]:+.1f} of its σ"
    # What bends the model so far could as well make what is weaker than that, so that all of it is told to be left.
    yield Test(OUTSIDE, fitted.prior, len(z), chance, where=(where,), places=-1)


CHECK = Check(OUTSIDE, _asked, asked=Asked.OF_WHAT_IS_TOLD)
