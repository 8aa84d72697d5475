"""Messages as numbers by path: joint states by their joints' names, anything else by its fields.

A message is what ``rosbags`` makes of CDR or ROS 1 bytes, or a JSON object. Paths are spelt as PlotJuggler does:
``/joint_states/pivot/position``, ``/imu/linear_acceleration/x``, ``/strain/data[0]``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

NAMES = ("name", "names", "joint_names")
LONGEST = 64  # numbers of an array; longer ones are pictures, clouds and maps
# trajectory_msgs and control_msgs speak of joints in the plural.
SINGULAR = {"positions": "position", "velocities": "velocity", "efforts": "effort", "accelerations": "acceleration"}
STAMPS = ("header", "stamp", "timestamp", "time")


def numbers_of(message: Any) -> tuple[dict[str, float], set[str]]:
    """Numbers of a message by path within it, and the paths that it states more than once.

    Text, flags, stamps and long arrays are left out.
    """
    found: dict[str, list[float]] = {}
    _walk(message, "", (), found)
    numbers = {path: stated[0] for path, stated in found.items()}
    return numbers, {path for path, stated in found.items() if len(stated) > 1}


def stamp_of(message: Any) -> int | None:
    """Nanoseconds of the message's own stamp (``header.stamp``, or ``timestamp`` and ``stamp`` at its top), None without one."""
    members = dict(_members(message))
    header = members.get("header")
    if header is not None:
        inner = dict(_members(header))
        return _nanoseconds(inner.get("stamp", inner.get("timestamp")))
    return _nanoseconds(members.get("stamp", members.get("timestamp")))


def _nanoseconds(stamp: Any) -> int | None:
    if stamp is None or isinstance(stamp, int | float | str):
        return None
    members = dict(_members(stamp))
    seconds = members.get("sec", members.get("secs"))
    rest = members.get("nanosec", members.get("nsec", members.get("nsecs")))
    if not isinstance(seconds, int) or not isinstance(rest, int) or (seconds, rest) == (0, 0):
        return None
    return seconds * 1_000_000_000 + rest


def _members(value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        yield from value.items()
    elif is_dataclass(value):
        for field in fields(value):
            if not field.name.startswith("__"):
                yield field.name, getattr(value, field.name)


def _walk(value: Any, prefix: str, joints: Sequence[str], found: dict[str, list[float]]) -> None:
    members = dict(_members(value))
    own = next((members[key] for key in NAMES if _are_names(members.get(key))), None)
    if own is not None:
        joints = [str(name) for name in own]
    for key, inner in members.items():
        if key in STAMPS and not prefix and (key == "header" or not isinstance(inner, int | float) or key == "time"):
            continue
        if key in NAMES and inner is own:
            continue
        path = f"{prefix}/{key}" if prefix else key
        array = _array(inner)
        if array is not None:
            if joints and len(array) == len(joints):
                quantity = SINGULAR.get(key, key)
                for joint, number in zip(joints, array, strict=True):
                    found.setdefault(f"{prefix}/{joint}/{quantity}".lstrip("/"), []).append(float(number))
            elif 0 < len(array) <= LONGEST:
                for k, number in enumerate(array):
                    found.setdefault(f"{path}[{k}]", []).append(float(number))
        elif isinstance(inner, bool | np.bool_ | str | bytes) or inner is None:
            continue
        elif isinstance(inner, int | float | np.integer | np.floating):
            found.setdefault(path, []).append(float(inner))
        elif isinstance(inner, list | tuple):
            _walk_list(inner, path, prefix, joints, found)
        else:
            _walk(inner, path, joints, found)


def _walk_list(
    items: Sequence[Any], path: str, prefix: str, joints: Sequence[str], found: dict[str, list[float]]
) -> None:
    """A list of messages: one for each joint with its own interfaces (``control_msgs/DynamicJointState``), or numbered."""
    for k, item in enumerate(items[:LONGEST]):
        members = dict(_members(item))
        words, values = members.get("interface_names"), _array(members.get("values"))
        if len(items) == len(joints) and _are_names(words) and values is not None and len(values) == len(words or ()):
            for word, number in zip(words or (), values, strict=True):
                found.setdefault(f"{prefix}/{joints[k]}/{word}".lstrip("/"), []).append(float(number))
        elif members:
            _walk(item, f"{path}[{k}]", (), found)


def _are_names(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(isinstance(item, str) for item in value)


def _array(value: Any) -> list[float] | np.ndarray | None:
    """A vector of numbers, nan for a JSON null in it; None if it is none."""
    if isinstance(value, np.ndarray):
        return value.reshape(-1) if value.dtype.kind in "iuf" else None
    if not isinstance(value, list | tuple) or not value:
        return None
    if any((item is not None and not isinstance(item, int | float)) or isinstance(item, bool) for item in value):
        return None
    return [float("nan") if item is None else float(item) for item in value]
