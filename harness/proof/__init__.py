"""Conceal effects in recordings made by other engines, score what diagnosis finds.

``prove(out, seed=…, counts=…)`` draws cases, seals the answers, publishes their digests, lets diagnosis loose on folders
that hold only a model and recordings, then opens the answers and scores.
"""

from harness.proof.run import FULL, QUICK, Proof, prove, scaled

__all__ = ["FULL", "QUICK", "Proof", "prove", "scaled"]
