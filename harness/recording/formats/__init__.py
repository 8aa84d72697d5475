"""File formats: each reader gives one table of named columns; which one reads a file is told by its first bytes."""

from harness.recording.formats.detect import read_table
from harness.recording.formats.table import Table

__all__ = ["Table", "read_table"]
