"""A diagnosis for a person: on the terminal, and as a page with pictures."""

from harness.report.diagnosis.terminal import print_diagnosis
from harness.report.diagnosis.write import write_diagnosis

__all__ = ["print_diagnosis", "write_diagnosis"]
