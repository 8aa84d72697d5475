"""Joint equalities of an MJCF that a mimic says: position = offset + multiplier · position of another joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.system.description import Mimic
from harness.system.mjcf_left_out import disabled


def mimics(model: Any, names: list[str]) -> tuple[dict[str, Mimic], frozenset[int]]:
    """What follows what, by joint name, and the numbers of the equalities that say so.

    An equality is about positions relative to ``qpos0``. One that is off, is no line, is about no other joint, or would make a
    joint follow two, or follow in a circle, is none of them. names: of the joints in MuJoCo's order.
    """
    import mujoco

    found: dict[str, Mimic] = {}
    used: set[int] = set()
    if disabled(model, "CONSTRAINT") or disabled(model, "EQUALITY"):
        return found, frozenset()
    for i in range(model.neq):
        if int(model.eq_type[i]) != int(mujoco.mjtEq.mjEQ_JOINT) or not model.eq_active0[i]:
            continue
        first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
        constant, slope, *beyond = (float(c) for c in model.eq_data[i, :5])
        if second < 0 or np.any(beyond) or names[first] in found or _follows(found, names[second], names[first]):
            continue
        places = [float(model.qpos0[model.jnt_qposadr[k]]) for k in (first, second)]
        found[names[first]] = Mimic(names[second], slope, places[0] + constant - slope * places[1])
        used.add(i)
    return found, frozenset(used)


def _follows(found: dict[str, Mimic], name: str, other: str) -> bool:
    """Whether a joint is the other one, or follows it."""
    while name != other and name in found:
        name = found[name].joint
    return name == other
