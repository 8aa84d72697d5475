"""Where in a model's file a link or a joint stands, for messages that point at it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.system.xml_source import parse_xml

# Words by which a number of the description is written in each format: elements of URDF, attributes and elements of
# MJCF, keys of TOML.
_WRITTEN = {
    "mass": ("mass", "inertial"),
    "com": ("inertial", "com"),
    "inertia": ("inertia", "inertial"),
    "beam": ("section", "material", "length"),
    "lower": ("limit", "range"),
    "upper": ("limit", "range"),
    "effort": ("limit",),
    "velocity": ("limit",),
    "damping": ("dynamics", "damping"),
    "friction": ("dynamics", "friction"),
    "armature": ("armature",),
    "stiffness": ("stiffness",),
    "axis": ("axis",),
    "xyz": ("origin", "xyz"),
    "rotation": ("origin", "rpy"),
}


def line_of(path: str | Path, name: str, value: str = "") -> int | None:
    """Line, counted from 1, at which the link or joint of that name stands in a model file; None if it cannot be told.

    value: a member of the description (``mass``, ``lower``); the line of what states it, where there is one.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
        if data.lstrip()[:1] == b"<":
            return _in_xml(parse_xml(data, path), name, value)
        return _in_toml(data.decode("utf-8-sig"), name, value)
    except (OSError, InputError, UnicodeDecodeError):
        return None


def _in_xml(root: Any, name: str, value: str) -> int | None:
    owners = [e for e in root.iter("link", "joint", "body", "freejoint") if e.get("name") == name]
    if not owners:
        return None
    # A joint of URDF that carries the name of a link is asked for by what it states.
    for owner in owners:
        for word in _WRITTEN.get(value.split(".")[0], ()):
            for element in _own(owner):
                if element.tag == word or element.get(word) is not None:
                    return int(element.sourceline)
    return int(owners[0].sourceline)


def _own(owner: Any) -> Iterator[Any]:
    """An element and what is in it; what a nested body or joint states is its own."""
    yield owner
    for child in owner:
        if child.tag not in ("body", "joint"):
            yield from _own(child)


def _in_toml(text: str, name: str, value: str) -> int | None:
    lines = text.splitlines()
    named = re.compile(r"""^\s*name\s*=\s*["']""" + re.escape(name) + r"""["']\s*(#.*)?$""")
    for index, line in enumerate(lines):
        if not named.match(line):
            continue
        start = index
        while start > 0 and not lines[start].lstrip().startswith("[["):
            start -= 1
        end = index + 1
        while end < len(lines) and not lines[end].lstrip().startswith("[["):
            end += 1
        for word in (value.split(".")[-1], *_WRITTEN.get(value.split(".")[0], ())):
            for k in range(start, end):
                if word and re.match(rf"\s*{re.escape(word)}\s*=", lines[k]):
                    return k + 1
        return index + 1
    return None
