"""Models of an answer held against the nominal one on data held out, and what the augmented one is where nothing was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.diagnose.answer.constants import PLAINLY_BETTER_ERROR, TOLD_BEND
from harness.diagnose.problem.hypothesis import Array, Nominal, bent_by
from harness.recording.units import written

Row = Mapping[str, Any]


def worse_than_nominal(rows: Sequence[Row], model: str) -> Row | None:
    """The channel of the data held out where a model is farthest above the nominal one; None unless it is plainly worse there.

    rows: of ``fit``. Whether it is worse is asked of all channels together, each weighed by its noise: a model may trade a little
    of one for much of another.
    """
    own, nominal = (_over_noise(rows, which) for which in (model, "nominal"))
    if not nominal < PLAINLY_BETTER_ERROR * own:
        return None
    return max(rows, key=lambda r: (r[model]["heldout_rmse"] - r["nominal"]["heldout_rmse"]) / r["noise_floor"])


def beyond_nominal(row: Row, model: str) -> str:
    """By how much a model is worse there, as half a sentence."""
    own, nominal = (f"{row[which]['heldout_rmse']:.2g} {written(row['unit'])}" for which in (model, "nominal"))
    return f"leaves {own} of the data held out at {row['channel']}, more than the nominal model does ({nominal})"


def nothing_added(nominal: Sequence[Nominal], x: Array, rows: Sequence[Row], *, beside: bool) -> str:
    """What the augmented model is where nothing was found, in a sentence; nothing where it is the nominal model or as good.

    x: nominal quantities' deviations first [standard deviations of the tolerance]. rows: of ``fit``. beside: whether these
    quantities were fitted beside effects that are not claimed; the errors of ``fit`` are then with them.
    """
    z = np.asarray(x[: len(nominal)])
    most = int(np.argmax(np.abs(z))) if len(z) else -1
    worse = None if beside else worse_than_nominal(rows, "augmented")
    if most < 0 or z[most] == 0.0 or not (beside or worse is not None or abs(z[most]) > TOLD_BEND):
        return ""
    quantity = nominal[most]
    by = 100.0 * (float(bent_by(nominal, z)[most]) - 1.0)
    text = (
        "Nothing is added in augmented.toml: it is the nominal model with its quantities adjusted as their tolerances allow, most "
        f"the {quantity.kind} of {quantity.name}, by {by:+.2g} % ({abs(z[most]):.2g} standard deviations of its tolerance)"
    )
    if beside:
        text += ", beside effects that are not claimed; the errors told as augmented are with these"
    elif worse is not None:
        text += f"; it {beyond_nominal(worse, 'augmented')}"
    return f"{text}."


def _over_noise(rows: Sequence[Row], model: str) -> float:
    """What a model leaves of the data held out, over the noise, of all channels together."""
    return float(np.sqrt(np.sum([(row[model]["heldout_rmse"] / row["noise_floor"]) ** 2 for row in rows])))
