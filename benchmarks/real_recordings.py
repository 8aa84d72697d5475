"""Real recordings: what their authors published, what ``mujoco.sysid`` fits, and what ``denoc diagnose`` finds, side by side.

``python benchmarks/real_recordings.py [RIG …] [--recordings DIR] [--work DIR] [--json FILE] [--without-peer]``

The folder of recordings is --recordings, the environment variable DENOC_RECORDINGS, or ../shared/recordings beside the
checkout. Every model sees the same training recordings, and runs freely over the same held-out ones: from the first sample,
and with the initial state fitted. A diagnosis already in the work folder is used again.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.diagnose.free_motion import free_part
from harness.diagnose.problem import pose
from harness.recording import Recording, read_recordings
from harness.report.diagnosis.write import write_diagnosis
from harness.system import System

from real_recordings_free_run import Simulate, first_state, free_run, measured, native  # isort: skip
from sysid_peer import fit_sysid  # isort: skip


@dataclass(frozen=True)
class Split:
    """What is learned from and what is judged on.

    window: length [s] of the free runs judged; None: whole recordings. single: one recording, its end held out.
    """

    train: tuple[str, ...]
    heldout: tuple[str, ...]
    window: float | None = None
    single: bool = False


SPLITS = {
    "multiarm-single": Split(("run1", "run2", "run3", "run4"), ("heldout1", "heldout2")),
    "multiarm-double": Split(("run4", "run5", "run6"), ("heldout1",), 3.0),
    "dfki-simple": Split(("ddp", "direct_collocation", "energy_shaping"), ("ilqr",), 1.0),
    "furuta-jensen-benard": Split(("run1", "run2"), ("run3",)),
    "sydney-compass-leg": Split(("all",), ("all",), 3.0, True),
    "bam-xl330": Split(("drop1", "drop2", "drop3"), ("drop4",)),
    "bam-sts3250": Split(("drop1",), ("drop1",), None, True),
}


def folder_of_recordings(given: str | None = None) -> Path | None:
    """Where real recordings are, or None."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "recordings"
    for place in (given, os.environ.get("DENOC_RECORDINGS"), str(beside)):
        if place and Path(place).is_dir():
            return Path(place)
    return None


def piece(recording: Recording, first: float, last: float) -> Recording:
    """The stretch of a recording between two shares of its samples."""
    a, b = round(first * recording.samples), round(last * recording.samples)
    return replace(
        recording,
        time=recording.time[a:b] - recording.time[a],
        channels=tuple(replace(c, values=c.values[a:b]) for c in recording.channels),
        efforts=tuple(replace(c, values=c.values[a:b]) for c in recording.efforts),
    )


def read_split(folder: Path, rig: str, system: System) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of a rig, beginnings that a hand still carries left out."""
    split = SPLITS[rig]

    def read(names: Iterable[str]) -> list[Recording]:
        paths = [folder / rig / f"{name}.csv.gz" for name in names]
        return [free_part(system, r) for r in read_recordings(paths, system=system)]

    train, heldout = read(split.train), read(split.heldout)
    if split.single:
        # Divided where a diagnosis of it alone divides it.
        at = pose(system, train).heldout[0].time[0]
        share = float(np.searchsorted(train[0].time, at)) / train[0].samples
        return [piece(train[0], 0.0, share)], [piece(train[0], share, 1.0)]
    return train, heldout


def judge(
    simulate: Simulate, system: System, train: list[Recording], heldout: list[Recording], window: float | None
) -> dict[str, Any]:
    """Root-mean-square errors over all recordings of each kind together [rad]."""

    def pooled(recordings: list[Recording]) -> list[float]:
        each = [(free_run(simulate, system, r, window), r.samples) for r in recordings]
        total = sum(n for _, n in each)
        return [(sum(e[k] ** 2 * n for e, n in each) / total) ** 0.5 for k in (0, 1)]

    a, b = pooled(train), pooled(heldout)
    return {
        "train": {"first_sample": a[0], "state_fitted": a[1]},
        "heldout": {"first_sample": b[0], "state_fitted": b[1]},
    }


def command(rig: str) -> str:
    """What a user types for the same diagnosis."""
    split = SPLITS[rig]
    names = split.train if split.single else (*split.train, split.heldout[0])
    files = " ".join(f"{rig}/{name}.csv.gz" for name in names)
    return f"denoc diagnose {files} --model {rig}/model.urdf"


def diagnosis(rig: str, folder: Path, work: Path) -> tuple[dict[str, Any], System]:
    """The answer for programs and the augmented model, made anew unless the work folder has them."""
    out = work / rig
    if not (out / "diagnosis.json").exists():
        split = SPLITS[rig]
        names = split.train if split.single else (*split.train, split.heldout[0])
        found = harness.diagnose([folder / rig / f"{n}.csv.gz" for n in names], folder / rig / "model.urdf")
        write_diagnosis(found, out)
    return json.loads((out / "diagnosis.json").read_text(encoding="utf-8")), harness.load(
        out / "augmented.toml", physical=False
    )


def examine(rig: str, folder: Path, work: Path, *, peer: bool = True) -> dict[str, Any]:
    """One line of the table."""
    system = harness.load(folder / rig / "model.urdf", physical=False)
    train, heldout = read_split(folder, rig, system)
    window = SPLITS[rig].window
    row: dict[str, Any] = {"rig": rig, "command": command(rig), "window_s": window}
    row["published"] = judge(native(system), system, train, heldout, window)
    began = time.perf_counter()
    answer, augmented = diagnosis(rig, folder, work)
    row["diagnose_s"] = round(time.perf_counter() - began, 1)
    row["denoc"] = judge(native(augmented), augmented, train, heldout, window)
    for key in ("verdict", "summary", "findings", "noise", "fit", "quality"):
        row[key] = answer.get(key)
    row["unexplained"] = answer.get("remainder", {})
    row["unexplained"].pop("map", None)
    if peer:
        try:
            found = fit_sysid(system, train, measured, first_state)
            row["mujoco_sysid"] = {"values": found.values, "std": found.std} | judge(
                found.free_run, system, train, heldout, window
            )
        except Exception as error:  # a peer may fail in any way; the table says so
            row["mujoco_sysid"] = {"error": f"{type(error).__name__}: {error}"}
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", nargs="*", metavar="RIG", help=f"of {', '.join(SPLITS)}; default: all")
    parser.add_argument("--recordings", help="folder of the recordings")
    parser.add_argument("--work", default="real_recordings", help="folder of diagnoses")
    parser.add_argument("--json", help="table to write or to add lines to")
    parser.add_argument("--without-peer", action="store_true")
    arguments = parser.parse_args()
    folder = folder_of_recordings(arguments.recordings)
    if folder is None:
        raise SystemExit("no recordings: give --recordings or set DENOC_RECORDINGS")
    rows = {}
    if arguments.json and Path(arguments.json).exists():
        rows = {r["rig"]: r for r in json.loads(Path(arguments.json).read_text(encoding="utf-8"))["rows"]}
    for rig in arguments.rigs or SPLITS:
        rows[rig] = row = examine(rig, folder, Path(arguments.work), peer=not arguments.without_peer)
        line = [f"{rig:22s}"]
        for who in ("published", "mujoco_sysid", "denoc"):
            held = row.get(who, {}).get("heldout")
            line.append(f"{who} {held['first_sample']:.4f} / {held['state_fitted']:.4f}" if held else f"{who} -")
        print("  ".join(line), row["verdict"], flush=True)
        if arguments.json:
            table = {"schema": "denoc.real_recordings/1", "unit": "rad", "rows": [rows[k] for k in SPLITS if k in rows]}
            Path(arguments.json).write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
