"""What a group of eight copies needs before it is advanced: its lanes of constants, its laws' terms, its nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.nodes import ABSENT, CONSTANTS, KIND, MASS, PARENT, SECTION
from harness.denoc.lanes.rows import prepare_lane
from harness.denoc.simd.vector import allocating, inner


@allocating
def prepare_group(
    rows: Any, first: int, lanes: int, links: Any, tree: Any, axes: Any, nominal: Any, plane: Any, constants: Any,
    beams: Any, laws: Any, shake: Any, flags: Any, present: Any, made: Any,
) -> int:  # fmt: skip
    """Write the constants of ``lanes`` rows from ``first`` on into a group, the last again in the lanes beyond.

    flags: terms in use of each coordinate's law, in any lane, (n,); present: the tree without sections that carry nothing; made:
    which row each lane's constants were made of last, −1 of none, (8,), so that those of an equal row stay; the other arrays as in
    ``prepare_lane``. Returns whether the base is shaken in any lane.
    """
    shaken: Any = np.int64(0)  # not the literal 0, which would be compiled for separately
    for i in range(len(flags)):
        flags[i] = 0
    for lane in range(8):
        source = first + min(lane, lanes - 1)
        if not _alike(rows, source, made[lane]):
            # A short run costs less than the constants of its row, and many in turn may have one row.
            prepare_lane(rows[source], lane, links, tree, axes, nominal, plane, constants, beams, laws, shake)
        made[lane] = source
        for i in range(len(flags)):
            flags[i] |= law.terms_in_use(laws, i * law.WIDTH * 8 + lane, 8)
        if rows[source, 3] != 0.0:
            shaken = np.int64(1)
    present_nodes(tree, constants, present)
    return shaken


@inner
def _alike(rows: Any, one: int, other: int) -> bool:
    """Whether two rows, of which the other may be none (−1), are equal."""
    if other < 0:
        return False
    for k in range(rows.shape[1]):  # noqa: SIM110 - a generator is not compiled
        if rows[one, k] != rows[other, k]:
            return False
    return True


@inner
def copy_numbers(rows: Any, first: int, lanes: int, sizes: Any, ws: Any) -> None:
    """What ``lanes.closed`` wants of ``lanes`` rows from ``first`` on into the workspace, the last again in the lanes beyond."""
    for lane in range(8):
        source = first + min(lane, lanes - 1)
        for k in range(sizes[2]):
            ws[(sizes[3] + k) * 8 + lane] = rows[source, sizes[4] + k]


@inner
def present_nodes(tree: Any, constants: Any, present: Any) -> None:
    """Mark the sections that carry nothing in any lane, to ``present``.

    Contributions of nothing are exact zeros: leaving them out changes no lane's result.
    """
    for i in range(tree.shape[0]):
        present[i, KIND] = tree[i, KIND]
        if tree[i, KIND] == SECTION:
            carried = 0.0
            for k in range((i * CONSTANTS + MASS) * 8, (i + 1) * CONSTANTS * 8):
                carried += abs(constants[k])
            for child in range(i + 1, tree.shape[0]):
                if tree[child, PARENT] == i:
                    carried = 1.0
            if carried == 0.0:
                present[i, KIND] = ABSENT
