"""Known interventions on real rigs: given the model of one state and recordings of another, is the change named, with its size?

``python benchmarks/known_interventions.py --recordings DIR --prepare | --run [CASE …] | --score``

Every folder of --recordings with a ``known.toml`` is a rig (its form is in ``docs/known_interventions.md``). --prepare fits what
has no drawing (armature, viscous and dry friction, the gain of a drive) to recordings of the *given* state by plain least squares,
copies that model and the recordings of the other state into the work folder, seals what is expected, and writes the digests into
the plan. --run diagnoses the cases that have no answer yet, in a fixed order, or those that are named. --score opens the sealed
answers, refuses those that do not fit their digest, and writes the table. What is judged is in ``known_interventions_score.py``.
"""

from __future__ import annotations

import argparse
import json
import secrets
import shutil
import time
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.errors import InputError
from harness.proof.peers.practitioner import Practitioner
from harness.proof.peers.runs import as_run
from harness.proof.seal import digest, unseal
from harness.recording import read_recordings
from harness.report.diagnosis.write import write_diagnosis
from harness.system import Attachment, System
from harness.system.write import write
from harness.whole_files import staged

from known_interventions_plain import LAWS, plain  # isort: skip
from known_interventions_score import scored, shares  # isort: skip
from real_recordings import folder_of_recordings  # isort: skip

HERE = Path(__file__).resolve().parents[1]
LIMIT = 240.0  # s, of one diagnosis


@dataclass(frozen=True)
class Case:
    """One intervention: what is given, what was recorded, and what is expected.

    name: of the folder that the diagnosing process is given; it says nothing of the change. given: files of the model and of the
    recordings that it is fitted to. recordings: of the other state, the last one held out. answer: what is sealed.
    """

    name: str
    rig: str
    given: tuple[Path, tuple[Path, ...]]
    recordings: tuple[Path, ...]
    answer: Mapping[str, Any]


def cases_of(folder: Path) -> Iterator[Case]:
    """All cases of all rigs, rigs in turn, so that a run that has to end has asked of each."""
    found: list[list[Case]] = []
    for file in sorted(folder.glob("*/known.toml")):
        document = tomllib.loads(file.read_text(encoding="utf-8"))
        rig, root = file.parent.name, file.parent
        cases = []
        for number, case in enumerate(document["case"], 1):
            state = document["state"][case["given"]]
            sealed = {key: case[key] for key in ("what", "effect", "site", "parameters")} | {
                "rig": rig, "kind": case["kind"], "like": case.get("like", {}),
            }  # fmt: skip
            given = root / state["model"], tuple(root / f for f in state["calibrate"])
            cases.append(Case(f"{rig}-{number}", rig, given, tuple(root / f for f in case["recordings"]), sealed))
        found.append(cases)
    for number in range(max(map(len, found), default=0)):
        yield from (cases[number] for cases in found if number < len(cases))


def calibrated(system: System, recordings: Sequence[Path]) -> System:
    """The model with armature, viscous and dry friction, and the gain of its drive, as recordings of that very state ask for.

    One joint; by ``harness.proof.peers.practitioner``, which shares no dynamics with the diagnosis. A driven fit has factors f on
    inertia and γ on gravity, in units of the effort as recorded: divided by γ all is in units of the weight, which is known.
    Inertia that is less than the links' own is not taken away from them.
    """
    (joint,) = system.movable_joints
    runs = [as_run(system, r) for r in read_recordings(recordings, system=system)]
    fitted = Practitioner(system, runs, held=None).fit(LAWS)
    weight = fitted.values.get("gravity", 1.0)
    own = float(harness.Denoc(system).mass_matrix(np.zeros(1))[0, 0])
    inertia = own * fitted.values[f"{joint.name}:inertia"] / weight
    joint = replace(
        joint,
        armature=joint.armature + max(inertia - own, 0.0),
        damping=fitted.values[f"{joint.name}:viscous"] / weight,
        friction=fitted.values[f"{joint.name}:dry"] / weight,
    )
    system = system.replace_joint(joint)
    if "gravity" in fitted.values:
        system = replace(system, attachments=(Attachment("actuator_gain", joint.name, {"gain": 1.0 / weight}),))
    return system


def prepare(cases: Sequence[Case], work: Path, plan: Path) -> None:
    """Model and recordings of every case, sealed answers, and their digests into the plan, which must not be there yet."""
    if plan.exists():
        raise InputError("there is a plan already: its answers are sealed", source=plan, mend="give another --plan")
    lines = []
    for case in cases:
        target = work / "cases" / case.name
        target.mkdir(parents=True, exist_ok=True)
        model, calibration = case.given
        system = calibrated(harness.load(model, physical=False), calibration)
        with staged(target / "model.toml") as temporary:
            write(system, temporary)
        for number, recording in enumerate(case.recordings, 1):
            shutil.copyfile(recording, target / f"run{number}{''.join(recording.suffixes)}")
        text = json.dumps({"salt": secrets.token_hex(16), **case.answer}, indent=1)
        sealed = work / "sealed" / f"{case.name}.json"
        sealed.parent.mkdir(parents=True, exist_ok=True)
        sealed.write_text(text, encoding="utf-8")
        given = digest((target / "model.toml").read_text(encoding="utf-8"))
        lines.append({"case": case.name, "rig": case.rig, "answer_sha256": digest(text), "model_sha256": given})
        print(f"{case.name:20s} sealed", flush=True)
    document = {"schema": "denoc.known_interventions_plan/1", "version": harness.__version__, "cases": lines}
    plan.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def planned(plan: Path) -> list[dict[str, str]]:
    """The lines of a plan, in the order in which cases are run."""
    if not plan.exists():
        raise InputError("there is no plan", source=plan, mend="run with --prepare first")
    lines: list[dict[str, str]] = json.loads(plan.read_text(encoding="utf-8"))["cases"]
    return lines


def run(names: Sequence[str], work: Path, limit: float) -> None:
    """Diagnose the cases, each from its own folder alone; those that have an answer are passed over."""
    for name in names:
        folder, out = work / "cases" / name, work / "found" / name
        if (out / "diagnosis.json").exists():
            continue
        began = time.perf_counter()
        files = sorted(folder.glob("run*.csv*"))
        try:
            found = harness.diagnose([str(f) for f in files], str(folder / "model.toml"), time_limit=limit)
            write_diagnosis(found, out)
            verdict = found.to_json()["verdict"]
        except (InputError, ArithmeticError, ValueError, RuntimeError) as error:  # an error is an answer too
            verdict = f"{type(error).__name__}: {error}"
            out.mkdir(parents=True, exist_ok=True)
            (out / "diagnosis.json").write_text(json.dumps({"error": verdict}), encoding="utf-8")
        print(f"{name:20s} {time.perf_counter() - began:6.0f} s  {verdict}", flush=True)


def plain_once(work: Path, case: str, answer: Mapping[str, Any]) -> list[float]:
    """What a plain fit gives for a case, kept in the work folder."""
    kept = work / "plain" / f"{case}.json"
    if not kept.exists():
        found = plain(work / "cases" / case, answer["effect"], answer["site"], list(answer["parameters"]))
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(found), encoding="utf-8")
    sizes: list[float] = json.loads(kept.read_text(encoding="utf-8"))
    return sizes


def score(plan: Path, work: Path, target: Path, limit: float = LIMIT) -> None:
    """Open what was sealed, hold the answers against it, and write the table; limit: what they were run with [s]."""
    rows, missing = [], []
    for line in planned(plan):
        answer = unseal(line["case"], work / "sealed", line["answer_sha256"])
        told = work / "found" / line["case"] / "diagnosis.json"
        if told.exists():
            row = scored(line["case"], answer, json.loads(told.read_text(encoding="utf-8")))
            if answer["kind"] == "free":
                row["plain_fit"] = plain_once(work, line["case"], answer)
            rows.append(row)
        else:
            missing.append(line["case"])
    document = {
        "schema": "denoc.known_interventions/1", "version": harness.__version__, "time_limit_s": limit, "shares": shares(rows),
        "not_run": missing, "rows": rows,
    }  # fmt: skip
    target.write_text(json.dumps(document, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    for row in rows:
        print(f"{row['case']:20s} {row['what']:44s} {row['named']:9s} {', '.join(row['told']) or '-'}")
    print(json.dumps(document["shares"], indent=1))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="with --run: these only")
    what = parser.add_mutually_exclusive_group(required=True)
    for name in ("prepare", "run", "score"):
        what.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--recordings", help="folder of the rigs")
    parser.add_argument("--work", type=Path, default=Path("known_interventions"), help="folder for cases and answers")
    parser.add_argument("--plan", type=Path, default=HERE / "reference" / "known_interventions_plan.json")
    parser.add_argument("--json", type=Path, default=HERE / "reference" / "known_interventions.json")
    parser.add_argument("--time-limit", type=float, default=LIMIT, help="seconds of one diagnosis")
    given = parser.parse_args()
    try:
        if given.prepare:
            folder = folder_of_recordings(given.recordings)
            if folder is None:
                parser.error("no folder of recordings: give --recordings DIR")
            prepare(list(cases_of(folder)), given.work, given.plan)
        elif given.run:
            run(given.cases or [line["case"] for line in planned(given.plan)], given.work, given.time_limit)
        else:
            score(given.plan, given.work, given.json, given.time_limit)
    except InputError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
