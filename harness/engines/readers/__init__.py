"""Model files read once more, by engines' own readers, so that a misreading of ours does not reach every engine alike."""

from harness.engines.readers.reading import Placed, Reading, placed_bodies
from harness.engines.readers.register import OWN, read_by, readers_of

__all__ = ["OWN", "Placed", "Reading", "placed_bodies", "read_by", "readers_of"]
