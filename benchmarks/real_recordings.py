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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.compare.peers.sysid import REAL, fit_sysid
from harness.diagnose.conditioning.free_motion import free_parts
from harness.diagnose.inverse.band import cutoff_for
from harness.diagnose.inverse.effort_motion import effort_run
from harness.diagnose.inverse.pushes import find_pushes
from harness.diagnose.problem.problem import pose
from harness.effects import apply, load_user_effects
from harness.effects.scale import references
from harness.proof.peers.runs import as_run
from harness.recording import Recording, read_recordings
from harness.report.diagnosis.write import write_diagnosis
from harness.system import Attachment, System

from real_recordings_free_run import Simulate, free_run, native  # isort: skip
from real_recordings_friction import residual_torque  # isort: skip
from real_recordings_laws import at_both_joints, with_levels  # isort: skip


Pushed = Mapping[str, Sequence[tuple[float, float]]]


@dataclass(frozen=True)
class Split:
    """What is learned from and what is judged on.

    train, heldout: names of recordings; ``name[first:last]`` is the stretch between two times [s] of one that its authors joined.
    window: length [s] of the free runs judged; None: whole recordings. single: one recording, its end held out.
    fit_effort: whether the recorded effort is what is fitted. friction: whether it is also told which of two joints rubs, and how.
    levels: whether dry friction is also given a level of its own in every recording.
    """

    train: tuple[str, ...]
    heldout: tuple[str, ...]
    window: float | None = None
    single: bool = False
    fit_effort: bool = False
    friction: bool = False
    levels: bool = False


SPLITS = {
    "multiarm-single": Split(("run1", "run2", "run3", "run4"), ("heldout1", "heldout2"), levels=True),
    "multiarm-double": Split(("run6", "run7"), ("heldout1",), 3.0, friction=True),
    "dfki-simple": Split(("ddp", "direct_collocation", "energy_shaping"), ("ilqr",), 1.0, fit_effort=True),
    "furuta-jensen-benard": Split(("run1", "run2"), ("run3",)),
    "sydney-compass-leg": Split(("all[0:8.5]", "all[8.5:23.7]"), ("all[38:56]",), 3.0),
    "bam-xl330": Split(("drop1", "drop2", "drop3"), ("drop4",)),
    "bam-sts3250": Split(("drop1",), ("drop1",), None, True),
    "emps": Split(("run1",), ("heldout1",)),
}


def asked_rigs(what: str, **more: dict[str, Any]) -> tuple[argparse.Namespace, Path]:
    """The command line of a benchmark on rigs, and the folder of their recordings. more: further options by name."""
    parser = argparse.ArgumentParser(description=what, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", nargs="*", metavar="RIG", help="folder names; default: all")
    parser.add_argument("--recordings", help="folder of the recordings")
    parser.add_argument("--work", default="real_recordings", help="folder for pieces of recordings and diagnoses")
    parser.add_argument("--json", help="table to write or to add lines to")
    for name, how in more.items():
        parser.add_argument(f"--{name.replace('_', '-')}", **how)
    arguments = parser.parse_args()
    folder = folder_of_recordings(arguments.recordings)
    if folder is None:
        raise SystemExit("no recordings: give --recordings or set DENOC_RECORDINGS")
    return arguments, folder


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


def path_of(name: str, rig: str, folder: Path, work: Path) -> Path:
    """The file of a recording; a stretch of one is written into the work folder first."""
    whole, _, stretch = name.partition("[")
    source = folder / rig / f"{whole}.csv.gz"
    if not stretch:
        return source
    first, last = (float(t) for t in stretch.rstrip("]").split(":"))
    target = work / "pieces" / f"{rig}-{whole}-{first:g}-{last:g}.csv"
    if not target.exists():
        system = harness.load(folder / rig / "model.urdf", physical=False)
        (recording,) = read_recordings([source], system=system)
        keep = (recording.time >= first) & (recording.time < last)
        columns = [recording.time[keep] - recording.time[keep][0]]
        columns += [c.values[keep] for c in (*recording.channels, *recording.efforts)]
        names = ["time", *(c.name for c in (*recording.channels, *recording.efforts))]
        target.parent.mkdir(parents=True, exist_ok=True)
        np.savetxt(target, np.stack(columns, axis=1), fmt="%.10g", delimiter=",", header=",".join(names), comments="")
    return target


def read_split(folder: Path, work: Path, rig: str, system: System) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of a rig, beginnings that a hand still carries left out."""
    split = SPLITS[rig]

    def read(names: Iterable[str]) -> list[Recording]:
        paths = [path_of(name, rig, folder, work) for name in names]
        return free_parts(system, read_recordings(paths, system=system))

    train, heldout = read(split.train), read(split.heldout)
    if split.single:
        # Divided where a diagnosis of it alone divides it.
        at = pose(system, train).heldout[0].time[0]
        share = float(np.searchsorted(train[0].time, at)) / train[0].samples
        return [piece(train[0], 0.0, share)], [piece(train[0], share, 1.0)]
    return train, heldout


def pushed(system: System, train: list[Recording], heldout: list[Recording]) -> Pushed:
    """Stretches of driven recordings in which something outside pushes [s], by name: no model can run freely through them."""
    every = [*train, *heldout]
    if not all(r.efforts and any(np.any(e.values) for e in r.efforts) for r in every):
        return {}
    swing = min(references(system, j).frequency for j in system.joint_names) / (2.0 * np.pi)
    cutoff = min(cutoff_for(system, r, swing) for r in every)
    found = find_pushes(system, [effort_run(system, r, cutoff) for r in every])
    return {r.name: [(p.first, p.last) for p in found if p.run == k] for k, r in enumerate(every)}


def judge(
    simulate: Simulate,
    system: System,
    train: list[Recording],
    heldout: list[Recording],
    window: float | None,
    left_out: Pushed,
) -> dict[str, Any]:
    """Root-mean-square errors over all recordings of each kind together [rad], windows with a push left out."""

    def pooled(recordings: list[Recording]) -> list[float]:
        each = [(free_run(simulate, system, r, window, left_out.get(r.name, ())), r.samples) for r in recordings]
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
    files = " ".join(f"{rig}/{name}.csv.gz" if "[" not in name else f"{rig}/{name}" for name in names)
    return f"denoc diagnose {files} --model {rig}/model.urdf" + (" --fit-effort" if split.fit_effort else "")


def diagnosis(rig: str, folder: Path, work: Path) -> tuple[dict[str, Any], System, System | None]:
    """The answer for programs, the model with what is claimed, and the best predicting one, if there is one.

    Made anew unless the work folder has them.
    """
    out = work / rig
    if not (out / "diagnosis.json").exists():
        split = SPLITS[rig]
        names = split.train if split.single else (*split.train, split.heldout[0])
        paths = [path_of(name, rig, folder, work) for name in names]
        found = harness.diagnose(paths, folder / rig / "model.urdf", fit_effort=split.fit_effort)
        write_diagnosis(found, out)
    answer = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    best, force = out / "predictive.toml", out / "predictive_force.py"
    if force.exists():
        load_user_effects(force)
    claimed = harness.load(out / "augmented.toml", physical=False)
    return answer, claimed, harness.load(best, physical=False) if best.exists() else None


def examine(rig: str, folder: Path, work: Path, *, peer: bool = True) -> dict[str, Any]:
    """One line of the table."""
    system = harness.load(folder / rig / "model.urdf", physical=False)
    train, heldout = read_split(folder, work, rig, system)
    window = SPLITS[rig].window
    left_out = pushed(system, train, heldout) if SPLITS[rig].fit_effort else {}
    row: dict[str, Any] = {"rig": rig, "command": command(rig), "window_s": window}
    row["published"] = judge(native(system), system, train, heldout, window, left_out)
    began, known = time.perf_counter(), (work / rig / "diagnosis.json").exists()
    answer, augmented, predictive = diagnosis(rig, folder, work)
    row["diagnose_s"] = None if known else round(time.perf_counter() - began, 1)
    held = any(note["kind"] == "held_effort" for note in answer["quality"])
    row["efforts_held"] = held
    row["denoc"] = judge(native(augmented, held=held), augmented, train, heldout, window, left_out)
    if predictive is not None:
        row["predictive"] = judge(native(predictive, held=held), predictive, train, heldout, window, left_out)
        row["predictive"]["effects"] = answer["predictive"]["effects"]
    for key in ("verdict", "summary", "findings", "noise", "fit", "quality", "explained_share", "discrepancy"):
        row[key] = answer.get(key)
    row["unexplained"] = answer.get("remainder", {})
    row["unexplained"].pop("map", None)
    if rig in AUTHORS_FIT:
        fitted = authors_fit(rig, system)
        row["authors_fit"] = judge(native(fitted), fitted, train, heldout, window, left_out)
    if len(system.joint_names) == 1:
        row["about_joint"] = {"published": about_joint(system), "denoc": about_joint(augmented)}
    if SPLITS[rig].friction:
        row["residual_torque"] = residual_torque(folder, rig, system)
        row["laws"] = at_both_joints(system, train, heldout, window or np.inf)
    if SPLITS[rig].levels:
        row["levels"] = with_levels(system, answer, train, heldout)
    if peer:
        try:
            row["mujoco_sysid"] = by_sysid(system, train, heldout, window, left_out)
        except Exception as error:  # a peer may fail in any way; the table says so
            row["mujoco_sysid"] = {"error": f"{type(error).__name__}: {error}"}
    return row


def by_sysid(
    system: System, train: list[Recording], heldout: list[Recording], window: float | None, left_out: Pushed
) -> dict[str, Any]:
    """What ``mujoco.sysid`` fits to the same recordings, in the same windows, and how well it predicts.

    What is freed of inertia is ``REAL``, whichever fits better.
    """
    runs = [as_run(system, r) for r in train]
    gaps = [left_out.get(r.name, ()) for r in train]
    began = time.perf_counter()
    found = fit_sysid(system, runs, window=window, left_out=gaps, inertial=REAL[any(r.driven for r in runs)])
    seconds = round(time.perf_counter() - began, 1)
    half = {k: v if np.isfinite(v) else None for k, v in found.half.items()}
    return {
        "values": dict(found.values), "half95": half, "seconds": seconds, "efforts_held": found.held,
        **judge(found.free_run, system, train, heldout, window, left_out),
    }  # fmt: skip


# What authors fitted to the same recordings (held-out ones included), where that is not the model they published of the rig:
# inertia and first moment about the joint, viscous and dry friction, a constant torque; SI.
AUTHORS_FIT = {
    "dfki-simple": (0.0626, 0.102, 0.047, 0.184, -0.076),
    "sydney-compass-leg": (0.04321897, 3.07194777 / 9.81, 0.01403128, 0.05452402, 0.0),
}


def authors_fit(rig: str, system: System) -> System:
    """The model with the numbers that its authors fitted."""
    inertia, moment, damping, friction, constant = AUTHORS_FIT[rig]
    link = system.links[-1]
    distance = moment / link.mass
    about_com = inertia - link.mass * distance**2
    tensor = np.diag([about_com, about_com, link.inertia[2, 2]])
    changed = replace(link, com=np.array([0.0, 0.0, -distance]), inertia=tensor)
    joint = system.joint(system.joint_names[0])
    system = replace(system, links=tuple(changed if x is link else x for x in system.links))
    system = system.replace_joint(replace(joint, damping=damping, friction=friction))
    return replace(system, attachments=(Attachment("constant_torque", joint.name, {"torque": constant}),))


def about_joint(system: System) -> dict[str, float]:
    """What a single joint feels of its link: inertia J [kg·m²] and first moment m·l [kg·m], effects attached included."""
    shaped = replace(system, attachments=())
    for attachment in system.attachments:
        if attachment.effect in ("payload_mass", "added_inertia", "com_offset"):
            shaped = apply(shaped, attachment)
    model = harness.Denoc(shaped)
    return {
        "inertia_kgm2": float(model.mass_matrix(np.zeros(1))[0, 0]),
        "first_moment_kgm": float(abs(model.gravity(np.array([np.pi / 2.0]))[0]) / np.linalg.norm(system.gravity)),
    }


def main() -> None:
    arguments, folder = asked_rigs(__doc__ or "", without_peer={"action": "store_true"})
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
