"""What each number of the diagnosis does to the answers of sealed cases when it is doubled and halved.

``python benchmarks/sensitivity.py [--out DIR] [--json FILE] [--tables WORD …] [--cases NAME …] [--minutes M] [--list]``

Thirty cases of one seed are concealed as ``denoc prove`` conceals them (quick form, one joint: they are the fastest), diagnosed as
they are, and again with one number of ``harness/diagnose/*/constants`` changed, each in a process of its own: the number is
changed in the source of its table before anything of ``harness.diagnose`` is imported, so that what follows from it follows. A
number that a diagnosis never reads cannot change its answer and is not tried on that case. Of a share between a half and one,
what it leaves to one is doubled and halved; whole numbers stay whole; of several every one is changed.

The file is written after every diagnosis and taken up again where it ends; what was found of another value, or of a case whose
answer has changed with the code since, is found again. --list prints what it says of every number.
"""

from __future__ import annotations

import argparse
import importlib
import json
import multiprocessing
import time
import tomllib
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from queue import Empty
from typing import Any

from harness.journal import code_digest
from harness.whole_files import write_whole

from changed_numbers import ROOT, before_import, numbers, short, values  # isort: skip

SEED = 46
DRAWN = {"single": 40, "clean": 16, "outside": 12}
KEPT = {"single": 20, "clean": 5, "outside": 5}
FACTORS = {"doubled": 2.0, "halved": 0.5}
# The work of one diagnosis may grow without end where a number that bounds it is changed.
LONGEST = 20.0  # times as long as unchanged
SCHEMA = "denoc.sensitivity/1"


def _conceal(out: Path, wanted: Sequence[str], names: Any) -> None:
    """Names of the cases, of one joint each and of every kind in turn; all, or those wanted, are concealed where they are not."""
    from harness.proof.run import conceal, tasks

    kinds: list[list[str]] = []
    for kind, count in KEPT.items():
        kept: list[str] = []
        for task in tasks({kind: DRAWN[kind]}):
            if len(kept) < count and (not wanted or task.name in wanted):
                name, _ = conceal(task, SEED, out, short=True)
                model = tomllib.loads((out / "cases" / name / "model.toml").read_text(encoding="utf-8"))
                kept += [name] if len(model["joint"]) == 1 else []
        kinds.append(kept)
    names.put([name for row in zip_longest(*kinds) for name in row if name])


def _ask(folder: Path, name: str, change: tuple[str, str, float] | None, noted: bool, answers: Any) -> None:
    """Diagnose a case with a number changed, or note what is read; what it comes to goes to ``answers``."""
    read: set[str] | None = set() if noted else None
    before_import(change, read)
    from harness.proof.run import diagnose_folder
    from harness.proof.score import score_case
    from harness.proof.seal import digest, unseal

    told = diagnose_folder(folder / "cases" / name)
    text = (folder / "sealed" / f"{name}.json").read_text(encoding="utf-8")
    row = essence(told)
    row["right"] = score_case(name, unseal(name, folder / "sealed", digest(text)), told).right
    row["seconds"] = round(told["seconds"], 1)
    if read is not None:
        row["read"] = sorted(read)
    answers.put(row)


def essence(told: dict[str, Any]) -> dict[str, Any]:
    """What of an answer is compared: verdict, findings with grade and class, and their estimates."""
    if "error" in told:
        return {"error": told["error"]}
    findings = sorted(told["findings"], key=lambda f: (f["effect"], f["site"]))
    return {
        "verdict": told["verdict"],
        "findings": [f"{f['effect']}@{f['site']} {f.get('grade')}" for f in findings],
        "class": [sorted(map(str, f.get("indistinguishable_from", []))) for f in findings],
        "estimates": [
            [p["value"], p["std"]]
            for f in findings
            for _, p in sorted(f["parameters"].items())
            if p["value"] is not None
        ],
    }


def differences(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """What of two answers differs: "error", "verdict", "findings", "class", "right" and "estimates" (by a tenth of σ)."""
    if "error" in one or "error" in other:
        return [] if one.get("error") == other.get("error") else ["error"]
    parts = [part for part in ("verdict", "findings", "class") if one[part] != other[part]]
    parts += ["right"] if one["right"] != other["right"] else []
    if "findings" not in parts:
        pairs = zip(one["estimates"], other["estimates"], strict=False)
        moved = any(abs(a[0] - b[0]) > 0.1 * (a[1] or 1e-6 * abs(a[0])) for a, b in pairs)
        parts += ["estimates"] if moved else []
    return parts


def apart(target: Any, *arguments: Any, seconds: float = 3600.0) -> Any:
    """What a function puts into its last argument, in a process forked for it; None if it does not in time or dies."""
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=target, args=(*arguments, queue))
    process.start()
    end, answer = time.monotonic() + seconds, None
    while answer is None and time.monotonic() < end:
        try:
            answer = queue.get(timeout=1.0)
        except Empty:
            if not process.is_alive():
                break
    process.terminate()
    process.join()
    return answer


def warmed() -> None:
    """Import what all diagnoses need and is no part of the diagnosis, once for all processes."""
    for name in ("scipy.optimize", "scipy.signal", "scipy.stats", "pint", "numba", "harness.effects.lanes",
                 "harness.effects.catalogue", "harness.denoc.lanes.model", "harness.recording", "harness.system"):  # fmt: skip
        importlib.import_module(name)


def _put_values(answers: Any) -> None:
    answers.put(values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("denoc-sensitivity"), help="folder of the sealed cases")
    parser.add_argument("--json", type=Path, default=ROOT.parent / "reference" / "sensitivity.json")
    parser.add_argument("--tables", nargs="*", default=(), help="only numbers whose name contains one of these")
    parser.add_argument("--cases", nargs="*", default=(), help="only these cases, such as clean-4")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="no diagnosis is begun after so long")
    parser.add_argument("--list", action="store_true", help="print what the file says, and do nothing")
    options = parser.parse_args()
    data: dict[str, Any] = {"schema": SCHEMA, "seed": SEED, "cases": {}, "numbers": {}}
    if options.json.exists():
        data = json.loads(options.json.read_text(encoding="utf-8"))
    if options.list:
        print(listed(data))
        return
    warmed()
    Run(options, data, time.monotonic() + 60.0 * options.minutes).go()


class Run:
    """One call of this script: what it has been asked, and the file that it writes."""

    def __init__(self, options: argparse.Namespace, data: dict[str, Any], end: float) -> None:
        self.options, self.data, self.end = options, data, end
        self.source = code_digest()

    def go(self) -> None:
        """Conceal; of one case after the other, diagnose it unchanged and then with every number changed that it reads."""
        options, data = self.options, self.data
        for name, value in apart(_put_values).items():
            # What was found of another value says nothing of this one.
            stands = json.loads(json.dumps(value))
            if data["numbers"].get(name, {}).get("value") != stands:
                data["numbers"][name] = {"value": stands, "doubled": {}, "halved": {}}
        for case in apart(_conceal, options.out, options.cases):
            before = data["cases"].get(case)
            if before is None or before.get("source") != self.source:
                if time.monotonic() > self.end:
                    return
                as_is = {**apart(_ask, options.out, case, None, True), "source": self.source}
                if before is not None and differences(before, as_is):
                    self._forget(case)
                data["cases"][case] = as_is
                self._write()
                print(case, as_is["verdict"], *as_is["findings"], flush=True)
            for table, number, _ in numbers():
                name = short(table, number)
                wanted = not options.tables or any(word in name for word in options.tables)
                if wanted and name in data["cases"][case]["read"]:
                    self._try(case, table, number)

    def _forget(self, case: str) -> None:
        """What was found on a case says nothing any more where its answer has changed with the code."""
        for row in self.data["numbers"].values():
            for way in FACTORS:
                row[way].pop(case, None)

    def _try(self, case: str, table: str, number: str) -> None:
        before = self.data["cases"][case]
        for way, factor in FACTORS.items():
            row = self.data["numbers"][short(table, number)][way]
            if case in row or time.monotonic() > self.end:
                continue
            longest = LONGEST * before["seconds"] + 60.0
            after = apart(_ask, self.options.out, case, (table, number, factor), False, seconds=longest)
            row[case] = ["no end"] if after is None else differences(before, after)
            print(case, short(table, number), way, row[case], "" if after is None else after["seconds"], flush=True)
            self._write()

    def _write(self) -> None:
        write_whole(self.options.json, json.dumps(self.data, indent=1, sort_keys=True) + "\n")


def listed(data: dict[str, Any]) -> str:
    """What the file says, a line a number: on how many cases it was read and tried, and what it changed."""
    asked = {n: c for n, c in data["cases"].items() if c}
    lines = [f"{len(asked)} cases, {len(data['numbers'])} numbers"]
    for name, row in data["numbers"].items():
        read = [c for c in asked if name in asked[c]["read"]]
        words = []
        for way in FACTORS:
            parts = sorted({part for found in row[way].values() for part in found})
            hits = sum(bool(found) for found in row[way].values())
            words.append(f"{way}: {hits} of {len(row[way])} {' '.join(parts)}".rstrip())
        lines.append(f"{name} = {row['value']}: read in {len(read)}; {'; '.join(words)}")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
