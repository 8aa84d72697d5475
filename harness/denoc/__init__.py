"""Native dynamics by the decoupled natural orthogonal complement (DeNOC)."""

from harness.denoc import compensated  # which makes itself known to Denoc
from harness.denoc.loops import closed  # which does so too
from harness.denoc.model import Denoc

__all__ = ["Denoc", "closed", "compensated"]
