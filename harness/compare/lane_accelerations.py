"""What the lanes accelerate by, asked like an engine that has forward dynamics alone."""

from __future__ import annotations

import numpy as np

from harness.compare.answers import Array, Completed, Few
from harness.denoc.lanes.model import LaneModel
from harness.engines.protocol import EngineModel

LANES = "the lanes"
_SHORT = 1e-9  # s


def of_lanes(lanes: LaneModel, beside: EngineModel) -> Completed:
    """The lanes as a model whose other answers are worked out from their accelerations; beside: the native one, for its springs."""

    def forward_dynamics(q: Array, qd: Array, tau: Array) -> Array:
        # At the first sample of a motion nothing is integrated yet; the second one is what forces act up to.
        found = lanes.simulate(lanes.row(), q, qd, np.array([0.0, _SHORT]), tau=np.array([tau, tau]))
        return found[2][0, 0]

    return Completed(Few(beside.names, forward_dynamics=forward_dynamics), beside)
