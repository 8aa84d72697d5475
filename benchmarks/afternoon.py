"""What an afternoon of SciPy reaches on real rigs: a plain least-squares fit, judged as free runs over recordings held out.

``python benchmarks/afternoon.py [RIG …] [--recordings DIR] [--json FILE] [--window SECONDS]``

Every folder of --recordings (default: as ``real_recordings.py``) that has a model.urdf and recordings is a rig. Rigs that
``real_recordings.py`` knows are divided as it divides them; of any other, files called heldout* are held out, or else the last one.
Inertia, viscous damping, smoothed dry friction, speed squared and zero of every joint are fitted to the others
(``harness.proof.peers.practitioner``), once all of them and once with the fewest that
predict training recordings left out in turn as well.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.diagnose.conditioning.free_motion import free_parts
from harness.proof.peers.practitioner import SETS, Fitted, LeftOut, Practitioner, fewest
from harness.proof.peers.runs import as_run
from harness.recording import Recording, read_recordings
from harness.system import System

from real_recordings import SPLITS, Pushed, asked_rigs, judge, piece, pushed, read_split  # isort: skip
from real_recordings_free_run import native  # isort: skip

WINDOW: dict[str, Any] = {
    "type": float,
    "help": "length of free runs [s] of rigs not known; default: whole recordings",
}


def divided(folder: Path, work: Path, rig: str, system: System) -> tuple[list[Recording], list[Recording]]:
    """Recordings to fit and to judge on."""
    if rig in SPLITS:
        return read_split(folder, work, rig, system)
    paths = sorted(p for p in (folder / rig).iterdir() if ".csv" in p.suffixes)
    heldout = [p for p in paths if p.name.startswith("heldout")] or paths[-1:]
    train = [p for p in paths if p not in heldout]
    if train:
        return (
            free_parts(system, read_recordings(train, system=system)),
            free_parts(system, read_recordings(heldout, system=system)),
        )
    (only,) = free_parts(system, read_recordings(heldout, system=system))
    return [piece(only, 0.0, 0.7)], [piece(only, 0.7, 1.0)]


class Case:
    """One rig: its model, recordings to fit and to judge on, how long free runs are, and what is left out of them."""

    def __init__(self, rig: str, folder: Path, work: Path, window: float | None) -> None:
        self.system = harness.load(folder / rig / "model.urdf", physical=False)
        self.train, self.heldout = divided(folder, work, rig, self.system)
        split = SPLITS.get(rig)
        self.window = split.window if split else window
        pushes = split is not None and split.fit_effort
        self.left_out: Pushed = pushed(self.system, self.train, self.heldout) if pushes else {}


def fit(system: System, train: Sequence[Recording], window: float | None, left_out: Pushed) -> tuple[Fitted, Fitted]:
    """With every law; and with the fewest that predict training recordings left out in turn (or the end of the only one)."""

    def gaps(recordings: Sequence[Recording]) -> LeftOut:
        return [left_out.get(r.name, ()) for r in recordings]

    def of(recordings: Sequence[Recording], held: bool | None) -> Practitioner:
        runs = [as_run(system, r) for r in recordings]
        return Practitioner(system, runs, left_out=gaps(recordings), window=window, held=held)

    whole = of(train, None)
    full = whole.fit()
    folds = [([*train[:k], *train[k + 1 :]], [train[k]]) for k in range(len(train))]
    if len(train) == 1:
        folds = [([piece(train[0], 0.0, 0.7)], [piece(train[0], 0.7, 1.0)])]
    squares = dict.fromkeys(SETS, 0.0)
    for known, tried in folds:
        fits = of(known, full.held).every([as_run(system, r) for r in tried], window, gaps(tried))
        for laws, found in fits.items():
            squares[laws] += found.heldout**2
    laws = fewest({laws: float(np.sqrt(total)) for laws, total in squares.items()})
    return full, full if laws == full.laws else whole.fit(laws, full)


def examine(rig: str, folder: Path, work: Path, window: float | None) -> dict[str, Any]:
    """One line of the table."""
    case = Case(rig, folder, work, window)
    system, train, heldout, window, left_out = case.system, case.train, case.heldout, case.window, case.left_out
    row: dict[str, Any] = {"rig": rig, "unit": system.movable_joints[0].position_unit, "window_s": window}
    row["published"] = judge(native(system), system, train, heldout, window, left_out)
    began = time.perf_counter()
    full, chosen = fit(system, train, window, left_out)
    row["seconds"] = round(time.perf_counter() - began, 1)
    for name, found in (("every_law", full), ("chosen_laws", chosen)):
        row[name] = {
            "laws": found.laws, "values": found.values, "std": found.std, "efforts_held": found.held,
            **judge(found.free_run, system, train, heldout, window, left_out),
        }  # fmt: skip
    return row


def main() -> None:
    arguments, folder = asked_rigs(__doc__ or "", window=WINDOW)
    rigs = arguments.rigs or sorted(p.name for p in folder.iterdir() if (p / "model.urdf").exists())
    rows = {}
    if arguments.json and Path(arguments.json).exists():
        rows = {r["rig"]: r for r in json.loads(Path(arguments.json).read_text(encoding="utf-8"))["rows"]}
    for rig in rigs:
        rows[rig] = row = examine(rig, folder, Path(arguments.work), arguments.window)
        line = [f"{rig:22s}"]
        for who in ("published", "every_law", "chosen_laws"):
            held = row[who]["heldout"]
            line.append(f"{who} {held['first_sample']:.5f} / {held['state_fitted']:.5f} {row['unit']}")
        print("  ".join(line), "+".join(row["chosen_laws"]["laws"]) or "none", f"{row['seconds']} s", flush=True)
        if arguments.json:
            table = {"schema": "denoc.afternoon/1", "rows": [rows[k] for k in sorted(rows)]}
            Path(arguments.json).write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
