"""Parameters published for one unit on recordings of another: which carry over, which do not, and what mending these
few gains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.diagnose.arbitration.agreement import by_combination, by_number, counted_alike
from harness.diagnose.arbitration.arbitrate import (
    REFITTED,
    comparable,
    curves,
    free,
    louder,
    notes,
    predictions,
    reference_size,
    reservations,
    teller,
)
from harness.diagnose.arbitration.estimate import estimated
from harness.diagnose.arbitration.numbers import values
from harness.diagnose.arbitration.pairing import prepared
from harness.diagnose.arbitration.question import labels, question
from harness.diagnose.estimation.constants import NORMAL_95
from harness.diagnose.problem.deadline import Deadline, TimeUp, deadline_of
from harness.errors import InputError
from harness.parallel import one_blas_thread
from harness.recording import Recording
from harness.recording.units import written
from harness.system import System

SCHEMA = "denoc.transfer/1"
MENDED = "mended"
CARRIES = {
    "agree": "carries over",
    "neither": "does not",
    "open": "left open",
    "reference": "reference",
    "not freed": "not freed",
}


@one_blas_thread()
def transfer(
    recordings: Sequence[str | Path | Recording],
    model: str | Path | System,
    *,
    name: str | None = None,
    holdout: str | Path | Recording | None = None,
    mapping: Sequence[str] = (),
    progress: Callable[[int, int, str], None] | None = None,
    time_limit: float | Deadline | None = None,
) -> dict[str, Any]:
    """Hold a model that was identified on one unit against recordings of another: ``denoc.transfer/1``.

    recordings, holdout, mapping, time_limit: as of ``diagnose``; of the other unit. name: by which the model is told;
    by default its file's. A number carries over where the recordings' 95 % interval holds it and is narrow. "mended":
    those that do not carry over fitted, all others as published. Raises InputError for what cannot be used, and where
    the time is up before anything is known.
    """
    deadline = deadline_of(time_limit)
    (name,) = labels([name or model])
    system = prepared(model)
    tell = teller(progress, 4)
    tell("reading")
    asked = question(recordings, system, holdout=holdout, mapping=mapping, deadline=deadline)
    every = comparable([system], asked.problem.driven)
    try:
        tell("what the recordings say themselves")
        estimate = asked.estimate([system], every)
        tell("free runs as published")
        runs = free(asked, {name: system}, estimate)
        published = values(system, every)
        alike = counted_alike({name: published}, every, estimate.reference, reference_size(estimate))
        rows = by_number(estimate, alike)
        for row in rows:
            # With one model, what the interval holds is what carries over.
            row["says"] = CARRIES["agree" if row["says"] == name else row["says"]]
            row["published"] = row.pop("models")[name]
        tell("what mending gains")
        kept = np.array([row["says"] != CARRIES["neither"] for row in rows])
        if not kept.all():
            begin = np.where(kept, estimate.freed.of(published), estimate.x)
            again = estimated(estimate.freed, estimate.fitted.windows, begin=begin, held=kept)
            train, held = asked.spans(estimate)
            runs[MENDED] = {
                "train": asked.run(again.freed, train, again.x),
                "heldout": asked.run(again.freed, held, again.x),
            }
    except TimeUp:
        raise InputError(
            "the time was up before the model had run", mend="give a longer --time-limit, or none"
        ) from None
    prediction = predictions(asked, runs)
    left = louder(asked, estimate)
    counted = None if estimate.reference is None else every[estimate.reference].label
    combinations = by_combination(estimate, alike)
    for row in combinations:
        row["says"] = CARRIES["agree" if row["says"] == name else row["says"]]
    return {
        "schema": SCHEMA,
        "model": name,
        "summary": _summary(name, prediction, rows, MENDED in runs) + reservations(counted, left),
        "prediction": prediction,
        "numbers": rows,
        "counted_by": counted,
        "combinations": combinations,
        "louder": left,
        "notes": [*notes({name: system}, system, system), *asked.quality],
        "provenance": asked.made_from,
        "curves": curves(asked, runs),
    }


def _summary(name: str, prediction: Sequence[dict[str, Any]], rows: Sequence[dict[str, Any]], mended: bool) -> str:
    told = []
    for row in prediction:
        errors = {k: v["heldout_rmse"] for k, v in row["models"].items()}
        degrees = " rad" if row["unit"] == "rad" else f" {row['unit']}"
        shown = {
            k: f"{v:.3g}{degrees}" + (f" ({np.degrees(v):.2g}°)" if row["unit"] == "rad" else "")
            for k, v in errors.items()
        }
        line = f"On data held out, {row['channel']} is missed by {shown[name]} with the numbers of {name}"
        if mended:
            line += f", by {shown[MENDED]} with those that do not carry over fitted to this unit"
        told.append(line + f", and by {shown[REFITTED]} with all fitted; its noise is {row['noise_floor']:.2g}.")
    for says, words in (
        ("carries over", "Carries over"),
        ("does not", "Does not"),
        ("left open", "Left open by these recordings"),
    ):
        listed = [_told(row) if says == "does not" else row["number"] for row in rows if row["says"] == says]
        if listed:
            told.append(f"{words}: {'; '.join(listed)}.")
    return " ".join(told)


def _told(row: dict[str, Any]) -> str:
    half = NORMAL_95 * float(row["std"] or 0.0)
    unit = written(row["unit"])
    return f"{row['number']} (published {row['published']:.4g}, here {row['value']:.4g} ± {half:.2g} {unit})"
