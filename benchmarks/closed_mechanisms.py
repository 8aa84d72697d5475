"""What is concealed in closed mechanisms, balls and bodies in space: what the diagnosis names, and what it names that is not there.

``python benchmarks/closed_mechanisms.py [--cases N] [--seed S] [--time-limit SECONDS] [--work DIR]``

Case k is of family k (four-bar, slider-crank, five-bar, trammel, ball pendulum, thrown body, in turn); every third one has nothing
concealed. Of a closed mechanism one or two angles are recorded, of bodies their pose. MuJoCo makes the recordings from its own
file (``closed_mechanisms_drawn.py``), and the whole catalogue is asked. Answers already in the work folder are used again; the
table counts findings that are told for more than possible.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.system import load
from harness.whole_files import write_whole

from closed_mechanisms_drawn import FAMILIES, recorded, written  # isort: skip

CLEAN_EVERY = 3


def answered(number: int, seed: int, folder: Path, limit: float | None) -> dict[str, Any]:
    """The answer of ``denoc diagnose`` to a case, beside the truth."""
    random = np.random.default_rng([seed, number])
    family = FAMILIES[number % len(FAMILIES)]
    numbers = family.drawn(random)
    own = family.concealed[int(random.integers(len(family.concealed)))]
    # Every family is without anything in its turn.
    clean = (number + number // len(FAMILIES)) % CLEAN_EVERY == CLEAN_EVERY - 1
    size = 0.0 if clean else float(own.size(numbers, float(np.exp(random.uniform(0.0, np.log(4.0))))))
    model = folder / f"{seed}-{number}.xml"
    model.write_text(written(family, numbers, {}), encoding="utf-8")
    recordings = recorded(family, written(family, numbers, {} if clean else {own.place: size}), random)
    began, work = time.perf_counter(), time.process_time()
    found = harness.diagnose(recordings, load(model), time_limit=limit)
    told = [
        {
            "effect": f["effect"], "site": f["site"], "grade": f["grade"], "parameters": f["parameters"],
            "cannot_be_told_from": [str(other) for other in f.get("indistinguishable_from", [])],
        }
        for f in found.findings
    ]  # fmt: skip
    truth = {} if clean else {"effect": own.effect, "site": own.site, "parameter": own.parameter, "value": size}
    return {
        "family": family.name, "truth": truth, "verdict": found.verdict, "complete": not found.not_tried, "findings": told,
        "seconds": time.perf_counter() - began, "processor": time.process_time() - work,
    }  # fmt: skip


def scored(row: dict[str, Any]) -> dict[str, Any]:
    """Whether the truth is told, with an interval that holds it, and what else is told for more than possible."""
    truth = row["truth"]
    key = f"{truth['effect']}@{truth['site']}" if truth else ""

    def alike(finding: dict[str, Any]) -> bool:
        return any(key == other or truth["effect"] == other for other in finding["cannot_be_told_from"])

    firm = [f for f in row["findings"] if f["grade"] != "possible"]
    exact = [f for f in row["findings"] if key == f"{f['effect']}@{f['site']}"]
    in_class = [f for f in firm if truth and f not in exact and alike(f)]
    # A body that flies is damped in both its motions: MuJoCo's joint has one number for them.
    twin = [f for f in firm if truth and f["effect"] == truth["effect"] and truth["site"].startswith("root")]
    false = [f"{f['effect']}@{f['site']}" for f in firm if f not in exact and f not in in_class and f not in twin]
    low, high = exact[0]["parameters"][truth["parameter"]]["ci95"] if exact else (np.inf, -np.inf)
    named = exact[0]["grade"] if exact else ("in a class" if in_class else "")
    return {
        "named": named,
        "exact": bool(exact),
        "holds": bool(exact and low <= truth["value"] <= high),
        "false": false,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time-limit", type=float, default=None)
    parser.add_argument("--work", type=Path, default=Path("closed_mechanisms"))
    asked = parser.parse_args()
    asked.work.mkdir(parents=True, exist_ok=True)
    rows = []
    for number in range(asked.cases):
        kept = asked.work / f"{asked.seed}-{number}.json"
        if not kept.exists():
            write_whole(kept, json.dumps(answered(number, asked.seed, asked.work, asked.time_limit), indent=1))
        row = json.loads(kept.read_text(encoding="utf-8"))
        score = scored(row)
        rows.append((row, score))
        truth = row["truth"]
        hidden = f"{truth['effect']}@{truth['site']} {truth['value']:.3g}" if truth else "nothing"
        told = ", ".join(f"{f['effect']}@{f['site']} ({f['grade']})" for f in row["findings"]) or "–"
        print(
            f"{number:3} {row['family']:14} {hidden:36} {row['processor']:4.0f} s {row['verdict']:16} "
            f"{'holds' if score['holds'] else '':6}{told}"
            + (f"  FALSE: {', '.join(score['false'])}" if score["false"] else ""),
            flush=True,
        )
    there, clean = [(r, s) for r, s in rows if r["truth"]], [(r, s) for r, s in rows if not r["truth"]]
    named = [s for _, s in there if s["named"] and s["named"] != "possible"]
    exact = [s for _, s in there if s["exact"]]
    print(
        f"named for more than possible: {len(named)} of {len(there)}, {sum(s['exact'] for s in named)} of them exactly"
    )
    print(f"intervals that hold the truth: {sum(s['holds'] for s in exact)} of {len(exact)}")
    print(f"nothing concealed and nothing found: {sum(r['verdict'] == 'consistent' for r, _ in clean)} of {len(clean)}")
    print(f"cases with a finding that is not there: {sum(bool(s['false']) for _, s in rows)} of {len(rows)}")


if __name__ == "__main__":
    main()
