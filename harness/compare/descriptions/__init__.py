"""Two descriptions of one mechanism held against one another: which body, joint and field differs, by how much, at what cost."""

from harness.compare.descriptions.compare import TOLERANCE, Comparison, compare
from harness.compare.descriptions.cost import Cost, costs
from harness.compare.descriptions.fields import Difference
from harness.compare.descriptions.matching import alike, namesakes

__all__ = ["TOLERANCE", "Comparison", "Cost", "Difference", "alike", "compare", "costs", "namesakes"]
