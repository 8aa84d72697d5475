"""Data held out that ask for other parameters than the training data.

Under the right model the cost that the data held out add is chi-squared with as many degrees of freedom as they have samples
(Chow, Econometrica 28 (1960) 591), however loosely the training data alone pin the parameters.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.stats import norm

from harness.diagnose.criticism.check import Asked, Check, Remainder, Test, nothing_left
from harness.diagnose.criticism.constants import HELD_OUT_MISFIT_SIGMAS, TEST_CHANCE
from harness.diagnose.criticism.residual_correlation import by_channel, follows_itself
from harness.diagnose.selection.outcome import trained

MISFIT = "a worse fit of the data held out"


def _asked(left: Remainder) -> Iterator[Test]:
    """A test that counts, if no one set of parameters fits both kinds of data as well as each would allow."""
    outcome, fitted = left.outcome, left.fitted
    if outcome is None:
        return
    likelihood = left.likelihood
    judged = likelihood.samples(outcome.held_windows)
    own = trained(outcome, fitted)
    count = likelihood.samples(own.windows)
    if min(count, judged) < 2.0:
        return
    level = max(own.linear.cost / count, likelihood.rounded)
    added = fitted.score - own.score
    rise = float(np.log(max(added, 1e-300) / judged / level))
    z = rise / float(np.sqrt(2.0 / count + 2.0 / judged))
    if z < HELD_OUT_MISFIT_SIGMAS:
        return
    # Noise may be louder there, and is no misfit as long as its samples do not follow one another.
    chance = max(float(norm.sf(z)), follows_itself(by_channel(fitted, outcome.held_windows)))
    if chance >= TEST_CHANCE:
        return
    where = f"mean square {np.exp(rise):.2f} times that of the training data"
    yield Test(MISFIT, added - judged * level, 1, chance, (where,), -1)


CHECK = Check(MISFIT, _asked, asked=Asked.OF_WHAT_IS_TOLD, leaves=nothing_left)
