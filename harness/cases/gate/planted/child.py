"""What a copy with a fault in it says of some cases; run as a process of its own, which answers in JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from harness.cases.gate.judge import judge
from harness.cases.gate.planted.blamed import Blamed, of_judged
from harness.cases.gate.read import read_accepted
from harness.cases.run import Task, engine_names, run
from harness.engines import registry


def answer(cases: list[str], reference: Path) -> list[Blamed]:
    """One for each row that closes the gate on these cases."""
    accepted = read_accepted(reference)
    names = engine_names([name for name in registry.names() if name not in registry.own_names()])
    results = run([Task(case, names) for case in cases], workers=1)
    return [of_judged(judged) for judged in judge(results, accepted.of(cases)).failed]


if __name__ == "__main__":
    print(json.dumps([vars(one) for one in answer(sys.argv[2:], Path(sys.argv[1]))]))
