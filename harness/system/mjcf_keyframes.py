"""Keyframes of an MJCF that MuJoCo takes for others than were written: it fills up what is too short, and turns a quaternion of
length zero to no rotation, without a word.
"""

from __future__ import annotations

from typing import Any


def written(spec: Any) -> list[tuple[list[float], list[float]]]:
    """Positions and velocities of every keyframe as the file says them; to be asked before the specification is compiled."""
    return [(list(key.qpos), list(key.qvel)) for key in spec.keys]


def unusable(keyframes: list[tuple[list[float], list[float]]], model: Any) -> dict[int, str]:
    """Why a keyframe (as ``written``) says nothing that can be meant, by number."""
    found: dict[int, str] = {}
    for i, (position, velocity) in enumerate(keyframes):
        why = _too_short(position, velocity, model) or _turned_by_nothing(position, model)
        if why:
            found[i] = why
    return found


def _too_short(position: list[float], velocity: list[float], model: Any) -> str:
    """What has fewer numbers than the model's state, and not none; empty if nothing has."""
    if 0 < len(position) < model.nq:
        mixed = " (as many as there are velocities, nv)" if len(position) == model.nv else ""
        return f"its qpos has {len(position)} numbers{mixed} where the model has {model.nq} (nq)"
    if 0 < len(velocity) < model.nv:
        return f"its qvel has {len(velocity)} numbers where the model has {model.nv} (nv)"
    return ""


def _turned_by_nothing(position: list[float], model: Any) -> str:
    """Which joint's quaternion has length zero; empty if none has."""
    import mujoco

    shifts = {int(mujoco.mjtJoint.mjJNT_FREE): 3, int(mujoco.mjtJoint.mjJNT_BALL): 0}
    for k in range(model.njnt if position else 0):
        kind = int(model.jnt_type[k])
        if kind in shifts:
            first = int(model.jnt_qposadr[k]) + shifts[kind]
            if not any(position[first : first + 4]):
                return f"the quaternion of joint {model.joint(k).name!r} in it has length zero"
    return ""
