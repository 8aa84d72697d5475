"""A user's robot guarded: what was recorded of it when it was accepted, and what it is now."""

from harness.cases.gate.robot.compare import RECORDED, compare, of_description
from harness.cases.gate.robot.record import record

__all__ = ["RECORDED", "compare", "of_description", "record"]
