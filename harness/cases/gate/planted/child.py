"""What a copy with a fault in it says of some cases; run as a process of its own, which answers in JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from harness.cases.gate.judge import judge
from harness.cases.gate.read import read_accepted
from harness.cases.run import Task, engine_names, run
from harness.engines import registry


def answer(cases: list[str], reference: Path) -> list[str]:
    """One line for each row that closes the gate on these cases: key, reason, place, note."""
    accepted = read_accepted(reference)
    names = engine_names([name for name in registry.names() if name not in registry.own_names()])
    results = run([Task(case, names) for case in cases], workers=1)
    judgement = judge(results, accepted.of(cases))
    lines = []
    for judged in judgement.failed:
        row = judged.row
        place = "" if row is None or row.first_divergence is None else json.dumps(dict(row.first_divergence))
        lines.append("; ".join(filter(None, [judged.key, judged.reason, place, "" if row is None else row.note])))
    return lines


if __name__ == "__main__":
    print(json.dumps(answer(sys.argv[2:], Path(sys.argv[1]))))
