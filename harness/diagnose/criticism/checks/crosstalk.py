"""A reading into which another channel leaks, put to what a fit leaves: crosstalk of wires, or cross-axis sensitivity of a sensor.

Source: IEEE Std 528, Inertial Sensor Terminology (cross-axis sensitivity).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

import numpy as np
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test

LEAKS = "a reading that another channel leaks into"


def _asked(left: Remainder) -> Iterator[Test]:
    """Largest gain by a part of one channel in the reading of another one of the same kind, all pairs counted in its chance.

    None where there are no such pairs.
    """
    fitted = left.fitted
    channels = left.predictor.problem.channels
    pairs = [
        (into, of)
        for into, of in permutations(range(len(channels)), 2)
        if (channels[into].quantity, channels[into].unit) == (channels[of].quantity, channels[of].unit)
    ]
    if not pairs:
        return
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predictions = left.predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    columns = []
    for window, predicted in zip(fitted.windows, predictions, strict=True):
        signal = np.zeros((len(pairs), *predicted.shape))
        for k, (into, of) in enumerate(pairs):
            signal[k, into] = predicted[of]
        columns.append(np.nan_to_num(left.likelihood.whiten_signal(window, signal)))
    seen = left.space.measure(columns)
    gains = seen.gains()
    best = int(np.argmax(gains))
    into, of = pairs[best]
    share = -float(gains[best] / seen.along[best]) if gains[best] > 0.0 else 0.0
    chance = min(1.0, len(pairs) * float(chi2.sf(gains[best] / left.noise, 1)))
    where = (channels[into].name, f"{share:.2g} times {channels[of].name}")
    # Which of the others it is costs as much as another number.
    yield Test(LEAKS, float(gains[best]), 1, chance, where, 1, choices=len(pairs), exact=True)


CHECK = Check(LEAKS, _asked, exact=True)
