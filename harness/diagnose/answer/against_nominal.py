"""Models of an answer held against the nominal one on data held out, and what the augmented one is where nothing was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.diagnose.answer.constants import (
    ASTRAY_RATIO,
    BENT_BESIDE_FINDINGS,
    BETTER_NOMINAL_ERROR,
    MOST_BENT_NAMED,
    OUTSIDE_TOLERANCE,
    TOLD_BEND,
)
from harness.diagnose.problem.hypothesis import Array, Nominal, bent_by
from harness.diagnose.selection.outcome import Outcome, trained
from harness.recording.units import written

Row = Mapping[str, Any]


def worse_than_nominal(rows: Sequence[Row], model: str, better: float) -> Row | None:
    """The channel of the data held out where a model is farthest above the nominal one; None unless it is worse there.

    rows: of ``fit``. better: share of the model's error below which the nominal model's is less. Whether it is worse is asked of
    all channels together, each weighed by its noise: a model may trade a little of one for much of another.
    """
    own, nominal = (_over_noise(rows, which) for which in (model, "nominal"))
    if not nominal < better * own:
        return None
    return max(rows, key=lambda r: (r[model]["heldout_rmse"] - r["nominal"]["heldout_rmse"]) / r["noise_floor"])


def within_tolerances(outcome: Outcome) -> bool:
    """Whether the nominal model's quantities, fitted by themselves, stay where their tolerances let them."""
    z = trained(outcome, outcome.empty).x[: len(outcome.predictor.nominal)]
    return bool(np.all(np.abs(z) <= OUTSIDE_TOLERANCE))


def astray(outcome: Outcome, rows: Sequence[Row]) -> bool:
    """Whether the nominal model, of the recordings that are fitted or held out, leaves more of a channel than these vary.

    rows: of ``fit``, in the order of the channels. A joint may be held still: variation is the most of all channels of a unit.
    """
    for windows, error in ((outcome.nominal.windows, "train_rmse"), (outcome.held_windows, "heldout_rmse")):
        varies: dict[str, float] = {}
        for c, row in enumerate(rows):
            read = np.concatenate([outcome.problem.runs[w.run].values[c, w.first : w.last] for w in windows])
            read = read[np.isfinite(read)]
            if len(read):
                varies[row["unit"]] = max(varies.get(row["unit"], 0.0), float(np.std(read)))
        if any(row["nominal"][error] > ASTRAY_RATIO * varies.get(row["unit"], np.inf) for row in rows):
            return True
    return False


def beyond_nominal(row: Row, model: str) -> str:
    """By how much a model is worse there, as half a sentence."""
    errors = [row[which]["heldout_rmse"] for which in (model, "nominal")]
    # Two that differ are not told by the same digits.
    short = [f"{error:.2g}" for error in errors]
    own, nominal = short if short[0] != short[1] else [f"{error:.3g}" for error in errors]
    unit = written(row["unit"])
    return f"leaves {own} {unit} of the data held out at {row['channel']}, more than the nominal model does ({nominal} {unit})"


def beside_findings(nominal: Sequence[Nominal], x: Array, rows: Sequence[Row]) -> list[str]:
    """Sentences on the augmented model where something was found: that it foretells worse than the nominal one, and how far that
    had to be bent.

    x: nominal quantities' deviations first [standard deviations of the tolerance]. rows: of ``fit``.
    """
    told = []
    worse = worse_than_nominal(rows, "augmented", BETTER_NOMINAL_ERROR)
    if worse is not None:
        told.append(
            f"The model told as augmented {beyond_nominal(worse, 'augmented')}: what the other recordings teach does not carry "
            "over to these data."
        )
    z = np.asarray(x[: len(nominal)])
    far = [int(k) for k in np.argsort(-np.abs(z)) if abs(z[k]) > BENT_BESIDE_FINDINGS]
    if far:
        names = [_bent(nominal, z, k) for k in far[:MOST_BENT_NAMED]]
        more = len(far) - len(names)
        told.append(
            f"Beside what was found, the nominal model is bent far outside its tolerances: {', '.join(names)}"
            f"{f', and {more} more' if more else ''}. That may stand in for something that is missing, and what was found may be "
            "off by it, unless the tolerances are too narrow."
        )
    return told


def nothing_added(nominal: Sequence[Nominal], x: Array, rows: Sequence[Row], *, beside: bool) -> str:
    """What the augmented model is where nothing was found, in a sentence; nothing where it is the nominal model or as good.

    x: nominal quantities' deviations first [standard deviations of the tolerance]. rows: of ``fit``. beside: whether these
    quantities were fitted beside effects that are not claimed; the errors of ``fit`` are then with them.
    """
    z = np.asarray(x[: len(nominal)])
    most = int(np.argmax(np.abs(z))) if len(z) else -1
    worse = worse_than_nominal(rows, "augmented", BETTER_NOMINAL_ERROR)
    if most < 0 or z[most] == 0.0 or not (beside or worse is not None or abs(z[most]) > TOLD_BEND):
        return ""
    allowed = abs(z[most]) <= OUTSIDE_TOLERANCE
    how = "adjusted as their tolerances allow" if allowed else "bent far outside their tolerances"
    text = f"The model in augmented.toml is the nominal one with its quantities {how}, most {_bent(nominal, z, most)}"
    if beside:
        text += ", beside effects that are not claimed; the errors told as augmented are with these"
    if worse is not None:
        text += f"{', and what is told so' if beside else '; it'} {beyond_nominal(worse, 'augmented')}"
    return f"{text}."


def _bent(nominal: Sequence[Nominal], z: Array, k: int) -> str:
    """By how much one of the nominal quantities is another."""
    by = 100.0 * (float(bent_by(nominal, z)[k]) - 1.0)
    share = f"{float(f'{by:.2g}'):+.12g}"
    return f"the {nominal[k].kind} of {nominal[k].name}, by {share} % ({_deviations(abs(z[k]))} of its tolerance)"


def _deviations(count: float) -> str:
    number = f"{float(f'{count:.2g}'):.12g}"
    return f"{number} standard deviation{'' if number == '1' else 's'}"


def _over_noise(rows: Sequence[Row], model: str) -> float:
    """What a model leaves of the data held out, over the noise, of all channels together."""
    return float(np.sqrt(np.sum([(row[model]["heldout_rmse"] / row["noise_floor"]) ** 2 for row in rows])))
