"""Models held against recordings, for a person: on the terminal and as a page; and as files."""

from harness.report.arbitration.terminal import print_comparison
from harness.report.arbitration.write import write_comparison

__all__ = ["print_comparison", "write_comparison"]
