"""Whether recorded efforts are a controller's commands: a torque that is measured does not jump from one sample to the next.

What is behind a drive's electronics and before an anti-aliasing filter takes a few samples to change; a command is a number in a
program, which is there from one sample on and stays until the next (Franklin, Powell and Workman, Digital Control of Dynamic
Systems, 3rd ed. (1998), 2.4: the zero-order hold).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.constants import (
    COMMAND_JUMP_RATIO,
    COMMAND_JUMP_SHARE,
    FEWEST_EFFORT_INTERVALS,
    LONE_JUMP_SHARE,
)

Array = NDArray[np.float64]


def are_commands(efforts: Iterable[Array]) -> bool:
    """Whether any of some recorded efforts (T,) jumps."""
    return any(_jumps(np.asarray(values, dtype=np.float64)) for values in efforts)


def _jumps(values: Array) -> bool:
    values = values[np.isfinite(values)]
    if len(values) <= FEWEST_EFFORT_INTERVALS:
        return False
    changes = np.abs(np.diff(values))
    around = np.concatenate([[0.0], changes, [0.0]])
    beside = np.maximum(around[:-2], around[2:])
    least = max(COMMAND_JUMP_SHARE * float(np.ptp(values)), COMMAND_JUMP_RATIO * float(np.median(changes)))
    return bool(np.any((changes > least) & (beside < LONE_JUMP_SHARE * changes)))
