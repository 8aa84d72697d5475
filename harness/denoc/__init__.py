"""Native dynamics by the decoupled natural orthogonal complement (DeNOC)."""

from harness.denoc.model import Denoc

__all__ = ["Denoc"]
