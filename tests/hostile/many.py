"""Many more hostile files than the tests read: ``python tests/hostile/many.py 100000 --out figures.jsonl``.

Kinds take turns, seeds go up from --first; each input's outcome is counted, and each defect written with its seed. What was done
before is kept in the file, and a second run goes on behind it.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from attempts import KINDS, attempt, tried, valid_file

EVERY = 500  # inputs between two lines of the file


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, help="inputs in all")
    parser.add_argument("--out", type=Path, required=True, help="figures, a JSON line each 500 inputs")
    parser.add_argument("--first", type=int, default=1_000_000, help="first seed; the tests use small ones")
    parser.add_argument("--kind", action="append", choices=KINDS, help="only these")
    parsed = parser.parse_args()
    kinds = parsed.kind or KINDS
    done = 0
    if parsed.out.exists():
        done = sum(json.loads(line)["inputs"] for line in parsed.out.read_text().splitlines())
    defects = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        valid = {kind: valid_file(kind, folder) for kind in kinds}
        for kind in kinds:  # what is compiled or imported at first counts for no hostile input, however long that takes
            attempt(kind, valid[kind], folder)
            valid_one = attempt(kind, valid[kind], folder)
            assert valid_one.outcome == "read", f"{kind}: {valid_one.told}"
        while done < parsed.count:
            counts: Counter[str] = Counter()
            bad, slowest, begin = [], 0.0, time.perf_counter()
            many = min(EVERY, parsed.count - done)
            for k in range(done, done + many):
                kind, seed = kinds[k % len(kinds)], parsed.first + k // len(kinds)
                one = tried(kind, seed, valid[kind], folder)
                counts[f"{kind} {one.outcome}"] += 1
                crash = "crashed" in one.told
                counts["process ended"] += crash
                slowest = max(slowest, one.seconds)
                if one.outcome == "defect":
                    bad.append({"kind": kind, "seed": seed, "told": one.told[:300]})
            done, defects = done + many, defects + len(bad)
            line = {"inputs": many, "counts": dict(counts), "slowest": round(slowest, 2), "defects": bad}
            line["seconds"] = round(time.perf_counter() - begin, 1)
            with parsed.out.open("a") as stream:
                stream.write(json.dumps(line) + "\n")
                stream.flush()
                os.fsync(stream.fileno())
            print(f"{done} of {parsed.count}, {defects} defects in this run", flush=True)
    return int(defects > 0)


if __name__ == "__main__":
    sys.exit(main())
