"""A force over a joint's state that nobody has named, as a table: an effect, and the file that brings it into other runs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.effects.effect import Effect, Family, Parameter, SiteKind, UserLaw

Array = NDArray[np.float64]

NAME = "unnamed_force"
TITLE = "force that nobody has named"
WHAT = "which table, from 0"
SIGNATURE = "acts wherever the motion passes the same position at the same velocity"

_FILE = '''"""The force over a joint's state that was left without a name, beside which predictive.toml predicts best.

denoc simulate predictive.toml --effects {file}

FORCE[table, i, k] acts on the joint [N*m or N] at position FIRST[table, 0] + i STEP[table, 0] and velocity
FIRST[table, 1] + k STEP[table, 1]; between these it is bilinear, beyond them that of the edge.
"""

import numpy as np

from harness.effects.force_table import bilinear

name = "{name}"
title = "{title}"
signature = "{signature}"
parameters = {{"table": {{"unit": "1", "what": "{what}", "lower": -0.5, "upper": {last:g}, "starts": [0.0]}}}}

FIRST = np.array({first})
STEP = np.array({step})
FORCE = np.array({force})

torque = bilinear(FIRST, STEP, FORCE)
'''


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Forces over the states of joints.

    joints: names. first, step: position and velocity of the first node and from one to the next, (joints, 2). force: that acts on
    the joint at the nodes, (joints, positions, velocities) [N·m or N].
    """

    joints: tuple[str, ...]
    first: Array
    step: Array
    force: Array

    def effect(self) -> Effect:
        """As an effect at joints, whose one number says which table is theirs."""
        return Effect(
            name=NAME,
            title=TITLE,
            family=Family.STIFFNESS,
            site=SiteKind.JOINT,
            parameters=(Parameter("table", "1", WHAT, lower=-0.5, upper=len(self.joints) - 0.5, starts=(0.0,)),),
            signature=SIGNATURE,
            shows_in="motion that passes there",
            source="what the recordings leave beside the effects",
            expressed_by={"denoc": "a joint law of its own"},
            needs=("motion",),
            user=UserLaw(bilinear(self.first, self.step, self.force)),
        )

    def text(self, file: str) -> str:
        """The Python file of that name, for ``--effects``."""
        return _FILE.format(
            file=file, name=NAME, title=TITLE, signature=SIGNATURE, what=WHAT, last=len(self.joints) - 0.5,
            first=_numbers(self.first), step=_numbers(self.step), force=_numbers(self.force),
        )  # fmt: skip


def bilinear(first: Array, step: Array, force: Array) -> Callable[[float, float, float, Any], float]:
    """The joint law of tables over position and velocity, p[0] the number of the table; arguments as in ``ForceTable``."""
    rows, columns = force.shape[1:]

    def torque(position: float, velocity: float, time: float, p: Any) -> float:
        j = round(p[0])
        x = min(max((position - first[j, 0]) / step[j, 0], 0.0), rows - 1.0)
        y = min(max((velocity - first[j, 1]) / step[j, 1], 0.0), columns - 1.0)
        i, k = min(int(x), rows - 2), min(int(y), columns - 2)
        u, v = x - i, y - k
        low = (1.0 - v) * force[j, i, k] + v * force[j, i, k + 1]
        high = (1.0 - v) * force[j, i + 1, k] + v * force[j, i + 1, k + 1]
        return float((1.0 - u) * low + u * high)

    return torque


def _numbers(values: Array | Sequence[Any]) -> str:
    """As Python reads them, to the digits that matter."""
    return np.array2string(
        np.asarray(values),
        separator=", ",
        threshold=sys.maxsize,
        max_line_width=118,
        formatter={"float_kind": "{:.9g}".format},
    )
