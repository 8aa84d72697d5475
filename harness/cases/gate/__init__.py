"""The regression gate: the suite held against accepted figures, and the gate held against planted defects."""

from harness.cases.gate.accept import Change, accept
from harness.cases.gate.accepted import Accepted, Entry
from harness.cases.gate.judge import Judged, Judgement, judge
from harness.cases.gate.read import read_accepted
from harness.cases.gate.self_test import SelfTest, self_test

__all__ = [
    "Accepted",
    "Change",
    "Entry",
    "Judged",
    "Judgement",
    "SelfTest",
    "accept",
    "judge",
    "read_accepted",
    "self_test",
]
