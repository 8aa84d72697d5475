"""Runs the benchmarks without the command line tool: ``python benchmarks/run.py [NAME …] [--quick] [--json FILE]``.

Prints one line a row as it is measured. Set OMP_NUM_THREADS=1 for figures that compare between machines.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from harness.compare.bench import BENCHMARKS, Options, Row, document, machine, run
from harness.errors import InputError


def number(value: float | None, unit: str = "") -> str:
    return "-" if value is None else f"{value:.3g} {unit}".strip()


def line(row: Row) -> str:
    """One row for a terminal."""
    size = "" if row.n is None else f"n={row.n}"
    aim = "" if row.wanted is None else f" (wanted {row.wanted:g}{'' if row.met else ', missed'})"
    if row.skipped:
        return f"{row.what:30} {size:7} {row.peer:12} skipped: {row.note}"
    costs = f"{number(row.ours, row.unit):>12} {number(row.theirs, row.unit):>12}  ×{number(row.ratio)}{aim}"
    return f"{row.what:30} {size:7} {row.peer:12} {costs}  {row.case}"


def main() -> int:
    parser = argparse.ArgumentParser(description="Time and memory against the peers, side by side in one run.")
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help=f"any of: {', '.join(BENCHMARKS)}, or rows of them; all but suite if none",
    )
    parser.add_argument("--quick", action="store_true", help="small mechanisms only, fewer rounds")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows there, schema denoc.bench/1")
    given = parser.parse_args()

    def tell(what: str) -> None:
        print(f"… {what}", file=sys.stderr, flush=True)

    options = Options(quick=given.quick, rounds=7 if given.quick else 15, tell=tell)
    rows = []
    print(f"{'what':30} {'':7} {'peer':12} {'ours':>12} {'theirs':>12}  theirs/ours")
    try:
        for row in run(given.names, options):
            rows.append(row)
            print(line(row), flush=True)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    if given.json:
        given.json.write_text(json.dumps(document(rows, machine()), indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
