"""The gate's answer: on a terminal, for programs, as a pull request's summary, as SARIF and as annotations."""

from harness.report.gate.document import as_dict
from harness.report.gate.places import Place, places
from harness.report.gate.sarif import github_annotations, sarif
from harness.report.gate.screen import print_change, print_judgement
from harness.report.gate.summary import append_summary, markdown

__all__ = [
    "Place",
    "append_summary",
    "as_dict",
    "github_annotations",
    "markdown",
    "places",
    "print_change",
    "print_judgement",
    "sarif",
]
