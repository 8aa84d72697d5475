"""Another revision's diagnosis beside this one's: ``python benchmarks/against_build.py REV [--cases N] [--flexible N] …``.

The same sealed cases are diagnosed by both, one after the other, whichever began last time going second. Told are the ratios (this
over the other) of processor time, wall-clock time and peak memory, whether verdicts and findings agree, and how many answers of
each are right. What is done is kept in the folder given, so that the same command goes on after an interruption.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from harness.proof.run import FULL, conceal, scaled, tasks
from harness.proof.score import score_case
from harness.proof.seal import unseal

HERE = Path(__file__).resolve().parents[1]
MEASURED = {"cpu": "processor time", "wall": "wall-clock time", "memory": "peak memory"}

# Kernels are loaded once, by a case that is not measured; each case has a process of its own, whose peak memory is its own.
SERVER = """
import json, os, resource, sys, time
from pathlib import Path
import harness
def run(folder):
    runs = sorted(str(r) for r in Path(folder).glob("run*.csv"))
    wall, cpu = time.perf_counter(), time.process_time()
    try:
        found = harness.diagnose(runs, model=str(Path(folder) / "model.toml")).to_json()
    except (ArithmeticError, ValueError, RuntimeError) as error:
        found = {"error": f"{type(error).__name__}: {error}"}
    return {
        "wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, "found": found,
    }
print("ready", flush=True)
warm = False
for line in sys.stdin:
    folder, target = json.loads(line)
    if not warm:
        run(folder)
        warm = True
    child = os.fork()
    if child == 0:
        Path(target).write_text(json.dumps(run(folder)))
        os._exit(0)
    _, status = os.waitpid(child, 0)
    print(status, flush=True)
"""


class Build:
    """A revision's code in a process of its own."""

    def __init__(self, root: Path) -> None:
        one = {f"{pool}_NUM_THREADS": "1" for pool in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
        self._process = subprocess.Popen(
            [sys.executable, "-c", SERVER], cwd=root, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env={**os.environ, **one, "PYTHONPATH": str(root)},
        )  # fmt: skip
        self._heard()

    def _heard(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline().strip()
        if not line:
            raise RuntimeError("the other process ended")
        return line

    def diagnose(self, folder: Path, target: Path) -> dict[str, Any]:
        """What a diagnosis of a case costs and says; as it is if that is known."""
        if not target.exists():
            assert self._process.stdin is not None
            self._process.stdin.write(json.dumps([str(folder), str(target)]) + "\n")
            self._process.stdin.flush()
            if self._heard() != "0":
                target.write_text(
                    json.dumps({"wall": np.nan, "cpu": np.nan, "memory": np.nan, "found": {"error": "died"}})
                )
        found: dict[str, Any] = json.loads(target.read_text())
        return found

    def close(self) -> None:
        self._process.kill()
        self._process.wait()


def claimed(found: Mapping[str, Any]) -> set[tuple[str, str]]:
    """Effects and sites that an answer names."""
    return {(f["effect"], f["site"]) for f in found.get("findings", ())}


def compared(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Ratios over all cases, agreement, and how many answers are right."""
    out: dict[str, Any] = {"cases": len(rows)}
    for key in MEASURED:
        own, other = (np.array([row[who][key] for row in rows]) for who in ("this", "other"))
        ratio = own / other
        out[key] = {
            "median_ratio": float(np.median(ratio)), "worst_ratio": float(ratio.max()),
            "this": [float(np.median(own)), float(own.max())], "other": [float(np.median(other)), float(other.max())],
        }  # fmt: skip
    pairs = [(row["this"]["found"], row["other"]["found"]) for row in rows]
    out["same_verdict"] = sum(a.get("verdict") == b.get("verdict") for a, b in pairs)
    out["same_findings"] = sum(claimed(a) == claimed(b) for a, b in pairs)
    out["right"] = {who: sum(row[who]["right"] for row in rows) for who in ("this", "other")}
    return out


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("revision", metavar="REV", help="what git calls the other one")
    parser.add_argument("--cases", type=int, default=34, help="rigid ones, in the full proof's mix (default 34)")
    parser.add_argument("--flexible", type=int, default=6, help="flexible ones (default 6)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=Path, metavar="DIR", help="where the other revision, cases and answers are kept")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write ratios and every case there")
    options = parser.parse_args()
    work = options.work or Path(tempfile.mkdtemp(prefix="against-build-"))
    work.mkdir(parents=True, exist_ok=True)
    work = work.resolve()
    root = work / "other"
    if not root.exists():
        subprocess.run(["git", "-C", str(HERE), "worktree", "add", "--detach", str(root), options.revision], check=True)
    flexible = {kind: 0 for kind in FULL if kind.startswith("flexible")}
    counts = {**scaled(options.cases), **flexible}
    counts["flexible single"] = options.flexible
    digests = dict(conceal(task, options.seed, work, True) for task in tasks(counts))
    builds = {"this": Build(HERE), "other": Build(root)}
    rows: list[dict[str, Any]] = []
    try:
        for number, name in enumerate(digests):
            row: dict[str, Any] = {"case": name}
            for who in ("this", "other") if number % 2 else ("other", "this"):
                row[who] = builds[who].diagnose(work / "cases" / name, work / f"{name}.{who}.json")
                score = score_case(name, unseal(name, work / "sealed", digests[name]), row[who]["found"])
                row[who]["right"] = bool(score.right)
            rows.append(row)
            costs = "  ".join(f"{row[who]['cpu']:7.1f} s" for who in ("this", "other"))
            said = "  ".join(str(row[who]["found"].get("verdict", "error")) for who in ("this", "other"))
            print(f"{name:22} {costs}  ×{row['this']['cpu'] / row['other']['cpu']:.2f}  {said}", flush=True)
    finally:
        for build in builds.values():
            build.close()
    result = compared(rows)
    for key, what in MEASURED.items():
        print(f"{what}: median ×{result[key]['median_ratio']:.2f}, worst ×{result[key]['worst_ratio']:.2f}")
    print(
        f"of {len(rows)}: verdicts agree in {result['same_verdict']}, findings in {result['same_findings']}; "
        f"right: {result['right']['this']} here, {result['right']['other']} there"
    )
    if options.json is not None:
        options.json.write_text(json.dumps({**result, "rows": rows}, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
