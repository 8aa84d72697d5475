"""A fleet on the terminal, as a page and as files."""

from harness.report.fleet.terminal import print_fleet
from harness.report.fleet.write import fleet_html, write_fleet

__all__ = ["fleet_html", "print_fleet", "write_fleet"]
