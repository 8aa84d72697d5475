"""Two identified models of one rig: which predicts better where, on which numbers they agree, which are left open."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.arbitration.agreement import by_combination, by_number, counted_alike
from harness.diagnose.arbitration.constants import TELLING_NOISE_RATIO
from harness.diagnose.arbitration.estimate import Estimate
from harness.diagnose.arbitration.numbers import Number, numbers, values
from harness.diagnose.arbitration.pairing import paired, prepared
from harness.diagnose.arbitration.question import Question, labels, question
from harness.diagnose.arbitration.runs import FreeRuns, short_windows
from harness.diagnose.arbitration.where import compared, mean_squares, rms, where
from harness.diagnose.problem.deadline import Deadline, TimeUp, deadline_of
from harness.errors import InputError
from harness.parallel import one_blas_thread
from harness.recording import Recording
from harness.system import System

Array = NDArray[np.float64]
SCHEMA = "denoc.arbitration/1"
REFITTED = "refitted"


@one_blas_thread()
def arbitrate(
    recordings: Sequence[str | Path | Recording],
    models: Sequence[str | Path | System],
    *,
    names: Sequence[str] | None = None,
    holdout: str | Path | Recording | None = None,
    mapping: Sequence[str] = (),
    progress: Callable[[int, int, str], None] | None = None,
    time_limit: float | Deadline | None = None,
) -> dict[str, Any]:
    """Hold two models of one rig against recordings that neither of them, as far as can be, was fitted to:
    ``denoc.arbitration/1``.

    recordings, holdout, mapping, time_limit: as of ``diagnose``. models: two files or systems with the same moving
    joints. names: by which they are told; by default their files'. Raises InputError for models that cannot be
    compared, and where the time is up before anything is known.
    """
    if len(models) != 2:
        raise InputError(f"{len(models)} models to compare", mend="give two")
    files = [m.source if isinstance(m, System) else m for m in models]
    if models[0] is models[1] or (all(files) and len({Path(str(f)).resolve() for f in files}) == 1):
        raise InputError("is given twice", source=files[0] or labels(models)[0], mend="compare it with another model")
    deadline = deadline_of(time_limit)
    names = labels(names or models)
    first = prepared(models[0])
    second = paired(first, prepared(models[1]))
    systems = dict(zip(names, (first, second), strict=True))
    tell = teller(progress, 5)
    tell("reading")
    asked = question(recordings, first, holdout=holdout, mapping=mapping, deadline=deadline)
    every = comparable(list(systems.values()), asked.problem.driven)
    try:
        tell("what the recordings say themselves")
        estimate = asked.estimate(list(systems.values()), every)
        tell("free runs of both models")
        runs = free(asked, systems, estimate)
        tell("where they differ")
        short = short_windows(asked.problem, range(len(asked.problem.runs)))
        near = {name: asked.run(asked.freed(s, held=estimate.freed.problem.held), short) for name, s in systems.items()}
        near[REFITTED] = asked.run(estimate.freed, short, estimate.x)
        places = where(asked.problem, short, near)
    except TimeUp:
        raise InputError(
            "the time was up before the models had run", mend="give a longer --time-limit, or none"
        ) from None
    tell("telling")
    own = {name: values(s, every) for name, s in systems.items()}
    alike = counted_alike(own, every, estimate.reference, reference_size(estimate))
    rows, combinations = by_number(estimate, alike), by_combination(estimate, alike)
    left = louder(asked, estimate)
    counted = None if estimate.reference is None else every[estimate.reference].label
    prediction = predictions(asked, runs, {name: near[name] for name in names})
    return {
        "schema": SCHEMA,
        "models": names,
        "summary": _summary(names, prediction, places, rows) + reservations(counted, left),
        "prediction": prediction,
        "where": places,
        "numbers": rows,
        "counted_by": counted,
        "combinations": combinations,
        "louder": left,
        "notes": [*notes(systems, first, second), *asked.quality],
        "provenance": asked.made_from,
        "curves": curves(asked, runs),
    }


def comparable(systems: Sequence[System], driven: bool = False) -> tuple[Number, ...]:
    """The numbers of models; InputError where something bends, whose numbers are not of this kind."""
    for system in systems:
        if system.flexible:
            raise InputError(
                "has links that bend, and models are compared by base parameters, which bodies that do not bend have",
                source=system.source or system.name,
                mend="compare rigid models",
            )
    coordinates = {system.coordinate_names for system in systems}
    if len({len(c) for c in coordinates}) > 1:
        more = max(systems, key=lambda s: len(s.coordinate_names))
        raise InputError(
            "has coordinates beside its joints, which the other model has not",
            source=more.source or more.name,
            mend="compare models of the same coordinates",
        )
    return numbers(systems, driven)


def free(asked: Question, systems: Mapping[str, System], estimate: Estimate) -> dict[str, dict[str, FreeRuns]]:
    """Free runs by model, of the training recordings and of those held out: as long as the motion can be foretold."""
    train, held = asked.spans(estimate)
    out: dict[str, dict[str, FreeRuns]] = {}
    for name, system in systems.items():
        freed = asked.freed(system, held=estimate.freed.problem.held)
        out[name] = {"train": asked.run(freed, train), "heldout": asked.run(freed, held)}
    out[REFITTED] = {
        "train": asked.run(estimate.freed, train, estimate.x),
        "heldout": asked.run(estimate.freed, held, estimate.x),
    }
    return out


def predictions(
    asked: Question, runs: Mapping[str, Mapping[str, FreeRuns]], near: Mapping[str, FreeRuns] | None = None
) -> list[dict[str, Any]]:
    """One row a channel: root-mean-square errors of free runs [channel unit] by model, training and held out.

    near: free runs of two models over short windows of all recordings, by which is judged whether one of them is better.
    """
    noise = [c.std for c in asked.likelihood.colours]
    out = []
    for c, channel in enumerate(asked.problem.channels):
        each = {
            name: {f"{part}_rmse": rms(found.left, c) for part, found in parts.items()} for name, parts in runs.items()
        }
        better, chance = "", None
        if near is not None:
            better, chance = compared({name: mean_squares(found.left, c) for name, found in near.items()})
        out.append(
            {
                "channel": channel.name,
                "unit": channel.unit,
                "models": each,
                "noise_floor": noise[c],
                "better": better,
                "chance": chance,
            }
        )
    return out


def curves(asked: Question, runs: Mapping[str, Mapping[str, FreeRuns]]) -> list[dict[str, Any]]:
    """What pages draw: of every channel held out, the reading and each model's free run over it."""
    out = []
    for c, channel in enumerate(asked.problem.channels):
        some = next(iter(runs.values()))["heldout"]
        windows = some.fitted.windows
        time = np.concatenate([asked.problem.runs[w.run].time[w.first : w.last] for w in windows])
        seen = np.concatenate([asked.problem.runs[w.run].values[c, w.first : w.last] for w in windows])
        lines = {name: np.concatenate([p[c] for p in parts["heldout"].predicted]) for name, parts in runs.items()}
        out.append({"channel": channel.name, "unit": channel.unit, "time": time, "measured": seen, "models": lines})
    return out


def notes(systems: Mapping[str, System], first: System, second: System) -> list[str]:
    """What reading the models left out, and where they differ in what is compared by no number."""
    told = [f"{name}: {note}" for name, system in systems.items() for note in system.notes]
    for joint in first.movable_joints:
        other = second.joint(joint.name)
        if not np.allclose(joint.xyz, other.xyz, atol=1e-9) and joint.parent == other.parent:
            told.append(
                f"joint {joint.name} lies at {_point(joint.xyz)} m in one model and at {_point(other.xyz)} m in the other; "
                "numbers are told by each model's own geometry"
            )
        if abs(float(joint.axis @ other.axis)) < 1.0 - 1e-9 and joint.parent == other.parent:
            told.append(f"joint {joint.name} has another axis in one model than in the other")
    kinds = [{(a.effect, a.site) for a in s.attachments} for s in (first, second)]
    for effect, site in sorted(kinds[0] ^ kinds[1]):
        told.append(f"{effect.replace('_', ' ')} at {site} is in one of the models only; it acts in its predictions")
    return told


def teller(progress: Callable[[int, int, str], None] | None, total: int) -> Callable[[str], None]:
    """What tells one step after another, of so many."""
    count = 0

    def tell(what: str) -> None:
        nonlocal count
        count += 1
        if progress is not None:
            progress(count, total, what)

    return tell


def louder(asked: Question, estimate: Estimate) -> list[dict[str, Any]]:
    """By how much what the estimate leaves is larger than the channels' noise."""
    return [
        {"channel": c.name, "times_noise": float(np.sqrt(v))}
        for c, v in zip(asked.problem.channels, estimate.louder, strict=True)
    ]


def reservations(counted_by: str | None, left: Sequence[Mapping[str, Any]]) -> str:
    """What a summary says of all its numbers: that free swings tell ratios, and that the equations leave more than noise."""
    told = ""
    if counted_by is not None:
        told += (
            f" Free swings show ratios alone: all numbers are counted by the {counted_by}. Where that one is off itself, what is "
            "told of the others is off by the same factor."
        )
    over = [
        f"{row['channel']} {row['times_noise']:.2g} times" for row in left if row["times_noise"] > TELLING_NOISE_RATIO
    ]
    if over:
        told += (
            f" Fitted too, the equations leave more than noise ({', '.join(over)}): a law that the rig has is missing in them, and "
            "what it does is in these numbers. A diagnosis of either model may say which."
        )
    return told


def reference_size(estimate: Estimate) -> float:
    """The number that free swings are counted by, as the recordings have it; 1 where they need none."""
    return float(estimate.numbers[estimate.reference]) if estimate.reference is not None else 1.0


def _point(place: Array) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in place) + ")"


def _summary(
    names: Sequence[str],
    prediction: Sequence[Mapping[str, Any]],
    places: Sequence[Mapping[str, Any]],
    rows: Sequence[Mapping[str, Any]],
) -> str:
    """A paragraph in plain words."""
    told = []
    for row in prediction:
        errors = {name: row["models"][name]["heldout_rmse"] for name in names}
        said = " and ".join(f"{name} by {errors[name]:.3g}" for name in names)
        fitted = row["models"][REFITTED]["heldout_rmse"]
        told.append(
            f"On data held out, {row['channel']} is missed by {said} {row['unit']}; the same equations fitted to the "
            f"other recordings miss it by {fitted:.3g}, its noise is {row['noise_floor']:.2g}."
        )
        told.append(_better(names, row["channel"], [p for p in places if p["channel"] == row["channel"]]))
    for says, words in (
        ("agree", "Both agree with the recordings on"),
        *((name, f"The recordings side with {name} on") for name in names),
        ("neither", "They contradict both on"),
        ("open", "They leave open"),
    ):
        listed = [row["number"] for row in rows if row["says"] == says]
        if listed:
            told.append(f"{words} {', '.join(listed)}.")
    return " ".join(told)


def _better(names: Sequence[str], channel: str, places: Sequence[Mapping[str, Any]]) -> str:
    """Where which of the models predicts a channel better."""
    won = {name: [p for p in places if p["better"] == name] for name in names}
    if not any(won.values()):
        return "Nowhere does one of them predict it better by more than chance."
    for name in names:
        if len(won[name]) == len(places):
            return f"{name} predicts it better in every recording, at every speed and every swing."
    listed = [f"{name} in {'; '.join(map(_place, own))}" for name, own in won.items() if own]
    return f"Better by more than chance: {', and '.join(listed)}."


def _place(place: Mapping[str, Any]) -> str:
    if place["by"] == "recording":
        return str(place["group"])
    return f"{place['by']} {place['group']} {place['by_unit']}"
