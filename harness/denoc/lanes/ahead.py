"""The kernels of the lanes with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

import numpy as np

from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import CUBE, LANES, MATRIX, VECTOR, WHOLE
from harness.denoc.lanes import address
from harness.denoc.lanes.closed import close_states
from harness.denoc.lanes.exponential import march_groups
from harness.denoc.lanes.integrate import run_groups
from harness.denoc.lanes.model import step_method
from harness.denoc.lanes.rows import prepare_lane


def planar() -> None:
    """The recursion of the lanes in a plane."""
    address.planar()


def spatial() -> None:
    """The recursion of the lanes in space."""
    address.spatial()


def closed() -> None:
    """What goes around a recursion of a mechanism with loops or balls, and what closes its states."""
    address.closed()
    signature.compile_for(close_states, MATRIX, MATRIX, WHOLE, WHOLE, 1, VECTOR, WHOLE, WHOLE, WHOLE, 1.0, 1.0)


def lane_parameters() -> None:
    """What writes a parameter row's constants into a lane."""
    links, tree, _, axes, nominal, plane = LANES
    signature.compile_for(prepare_lane, VECTOR, 1, links, tree, axes, nominal, plane, *[VECTOR] * 4)


def lanes() -> None:
    """The lanes' adaptive method."""
    signature.compile_for(
        run_groups, 1, 1, MATRIX, MATRIX, 1, *LANES, 1, VECTOR, WHOLE, CUBE, WHOLE, 1, 1, VECTOR, 1.0,
        *step_method(8),
        CUBE, CUBE, CUBE,
    )  # fmt: skip


def exponential() -> None:
    """The lanes' exponential method."""
    signature.compile_for(
        march_groups, MATRIX, CUBE, 1, *LANES, 1, CUBE, CUBE, np.zeros((1, 1, 1, 1)), CUBE, CUBE, 1.0, 1.0, 1,
        CUBE, CUBE, CUBE, MATRIX,
    )  # fmt: skip
