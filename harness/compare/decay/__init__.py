"""Damping from the decay of a free swing: by logarithmic decrement, by its envelope, by the whole recording's likelihood."""

from harness.compare.decay.estimate import Decay, estimate

__all__ = ["Decay", "estimate"]
