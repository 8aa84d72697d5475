"""How far what a diagnosis told is from a concealed truth, in noise: whether anybody could have seen the difference.

Something outside the catalogue may act, on a given rig and as far as it moved, just like a law within it: rubber that relaxes
like damping. A told model that predicts the noise-free recording itself leaves nothing to tell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.proof.scene import Sensor
from harness.proof.visibility import whiten

PREDICTED = ("explained", "consistent")  # verdicts that say that a model predicts the recordings


def predictions(diagnosis: Any) -> list[dict[str, Any]]:
    """What the told model predicts of every channel of every recording; nothing where it is not said to predict them."""
    if diagnosis.verdict not in PREDICTED or diagnosis.curves is None:
        return []
    return [
        {
            "recording": one.recording,
            "channel": one.channel,
            "time": [float(f"{t:.7g}") for t in one.time],
            "value": [float(f"{v:.7g}") for v in one.measured - one.augmented],
        }
        for one in diagnosis.curves.residuals
    ]


def apart(answer: Mapping[str, Any], predicted: Sequence[Mapping[str, Any]]) -> float:
    """Norm of predictions minus noise-free recordings in units of independent noise; nan where either is not known.

    What predictions follow of the noise that they were fitted to is in it: two or three for a fit of eight numbers.
    """
    truth = answer.get("noise_free")
    if not truth or not predicted:
        return float("nan")
    sensor = Sensor(answer["rate"], answer["noise_std"], answer["colour"], answer["quantisation"])
    squares = 0.0
    for one in predicted:
        run = truth[one["recording"]]
        time = np.array(run["time"])
        at = np.array(one["time"])
        # A diagnosis counts time from a recording's first sample, be that one of a block of which it takes the mean.
        at += time[0]
        # The two differ by what varies slowly, and so may be compared at the times of either.
        difference = np.array(one["value"]) - np.interp(at, time, np.array(run[one["channel"]]))
        squares += float(np.sum(whiten(np.interp(time, at, difference), sensor) ** 2))
    return float(np.sqrt(squares))
