"""Whether recorded efforts are a controller's commands: a torque that is measured does not jump from one sample to the next.

What is behind a drive's electronics and before an anti-aliasing filter takes a few samples to change; a command is a number in a
program, which is there from one sample on and stays until the next (Franklin, Powell and Workman, Digital Control of Dynamic
Systems, 3rd ed. (1998), 2.4: the zero-order hold).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LARGE = 0.1  # of an effort's range, from which on a change within one interval may be a jump
SUDDEN = 10.0  # times the change in half of all intervals, that a jump is
ALONE = 0.3  # of a jump, that the changes before and after it stay below: what passes through a filter takes several intervals
FEWEST = 20  # intervals that say how an effort changes otherwise


def are_commands(efforts: Iterable[Array]) -> bool:
    """Whether any of some recorded efforts (T,) jumps."""
    return any(_jumps(np.asarray(values, dtype=np.float64)) for values in efforts)


def _jumps(values: Array) -> bool:
    values = values[np.isfinite(values)]
    if len(values) <= FEWEST:
        return False
    changes = np.abs(np.diff(values))
    around = np.concatenate([[0.0], changes, [0.0]])
    beside = np.maximum(around[:-2], around[2:])
    least = max(LARGE * float(np.ptp(values)), SUDDEN * float(np.median(changes)))
    return bool(np.any((changes > least) & (beside < ALONE * changes)))
