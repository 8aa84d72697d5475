"""Limits of an MJCF's joints: where they begin to push, and how softly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from harness.system.description import Stops
from harness.system.mjcf_left_out import disabled
from harness.system.soft_constraints import limit_law


def ends(model: Any, k: int) -> tuple[float, float]:
    """Where the limits of a joint of one degree of freedom begin to push [rad or m]; infinite where it has none.

    A margin shortens the range: MuJoCo pushes back to where the margin begins, not to the end of the range.
    """
    if not model.jnt_limited[k]:
        return -np.inf, np.inf
    margin = float(model.jnt_margin[k])
    low, high = float(model.jnt_range[k, 0]) + margin, float(model.jnt_range[k, 1]) - margin
    return (low, high) if low < high else (-np.inf, np.inf)


def act(model: Any) -> bool:
    """Whether the file lets limits act at all."""
    return not (disabled(model, "LIMIT") or disabled(model, "CONSTRAINT"))


def stops(model: Any, joints: Sequence[str]) -> tuple[Stops, ...]:
    """The limits of joints of one degree of freedom that act, with their softness; names in MuJoCo's order."""
    return tuple(_stops(model, joints)) if act(model) else ()


def _stops(model: Any, joints: Sequence[str]) -> Iterator[Stops]:
    for k, name in _of_one_degree(model, joints):
        low, high = ends(model, k)
        if np.isfinite(low):
            solref, solimp = model.jnt_solref[k], model.jnt_solimp[k]
            weight = float(model.dof_invweight0[model.jnt_dofadr[k]])
            law = limit_law((float(solref[0]), float(solref[1])), (float(solimp[0]), float(solimp[1])), weight)
            yield Stops(name, low, high, *law)


def margins(model: Any, joints: Sequence[str]) -> Iterator[str]:
    """One line for each joint whose margin moves the ends of its range."""
    for k, name in _of_one_degree(model, joints):
        if model.jnt_limited[k] and model.jnt_margin[k]:
            low, high = ends(model, k)
            to = f"to {low:.4g} … {high:.4g}, as in MuJoCo" if np.isfinite(low) else "to none: its limits are left out"
            yield f"joint {name!r}: its margin of {float(model.jnt_margin[k]):g} shortens its range {to}"


def _of_one_degree(model: Any, joints: Sequence[str]) -> Iterator[tuple[int, str]]:
    import mujoco

    one = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    return ((k, name) for k, name in enumerate(joints) if int(model.jnt_type[k]) in one)
