"""Many units of one kind, each diagnosed by itself, and one table of all of them."""

from harness.fleet.fleet import Fleet
from harness.fleet.run import diagnose_fleet

__all__ = ["Fleet", "diagnose_fleet"]
