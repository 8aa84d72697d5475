"""MCAP logs whose messages are JSON: joint states (arrays of name, position, velocity, effort) or flat objects of numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader

from harness.errors import InputError
from harness.recording.table import Table

ARRAYS = ("position", "velocity", "effort")


def read_mcap(path: Path) -> Table:
    """Columns ``<joint>.position``, … over the time the messages were stamped with, or logged at.

    Messages of several topics are put on one time axis; a topic has nan where another has its message.
    Raises InputError for a damaged file and, naming topic and encoding, for messages that are not JSON.
    """
    samples: list[tuple[int, dict[str, float]]] = []
    encodings: dict[str, str] = {}
    broken = 0
    try:
        with path.open("rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages():
                if channel.message_encoding != "json":
                    encodings[channel.topic] = channel.message_encoding
                    continue
                try:
                    content = json.loads(message.data)
                except ValueError:
                    broken += 1
                    continue
                values = _values(content) if isinstance(content, dict) else {}
                if values:
                    samples.append((_stamp(content, message.log_time), values))
    except (McapError, OSError, EOFError, ValueError) as failure:
        raise InputError(
            f"damaged MCAP file: {failure or type(failure).__name__}", mend="record or convert it again", source=path
        ) from None
    if not samples:
        if encodings:
            topic, encoding = next(iter(encodings.items()))
            raise InputError(
                f"topic {topic!r} is encoded as {encoding!r}",
                mend="only JSON messages are read; convert it, for example to CSV",
                source=path,
            )
        raise InputError("holds no joint states", mend="messages with name, position, velocity, effort", source=path)
    samples.sort(key=lambda sample: sample[0])
    first = samples[0][0]
    merged: dict[int, dict[str, float]] = {}
    repeated = []
    for stamp, values in samples:
        if stamp in merged and merged[stamp].keys() & values.keys():
            repeated.append((stamp, values))
        else:
            merged.setdefault(stamp, {}).update(values)
    rows = sorted([*merged.items(), *repeated], key=lambda sample: sample[0])
    names = list(dict.fromkeys(name for _, values in rows for name in values))
    columns = {"time": np.array([(stamp - first) * 1e-9 for stamp, _ in rows])}
    for name in names:
        columns[name] = np.array([values.get(name, np.nan) for _, values in rows])
    remarks = [f"topic {topic!r} is encoded as {encoding!r} and was left out" for topic, encoding in encodings.items()]
    if broken:
        remarks.append(f"{broken} messages are no valid JSON and were left out")
    return Table(columns, remarks=tuple(remarks))


def _values(content: dict[str, Any]) -> dict[str, float]:
    names = content.get("name")
    found: dict[str, float] = {}
    if isinstance(names, list):
        for quantity in ARRAYS:
            numbers = content.get(quantity)
            if not isinstance(numbers, list) or len(numbers) != len(names):
                continue
            for name, number in zip(names, numbers, strict=True):
                found[f"{name}.{quantity}"] = float(number) if isinstance(number, int | float) else np.nan
        return found
    for key, value in content.items():
        if isinstance(value, int | float) and not isinstance(value, bool) and key != "time":
            found[key] = float(value)
    return found


def _stamp(content: dict[str, Any], log_time: int) -> int:
    """Nanoseconds of the message's own stamp, if it has one, else of its logging."""
    header = content.get("header")
    stamp = header.get("stamp") if isinstance(header, dict) else None
    if isinstance(stamp, dict):
        seconds = stamp.get("sec", stamp.get("secs"))
        nanoseconds = stamp.get("nanosec", stamp.get("nsec", stamp.get("nsecs")))
        if isinstance(seconds, int) and isinstance(nanoseconds, int) and (seconds, nanoseconds) != (0, 0):
            return seconds * 1_000_000_000 + nanoseconds
    return log_time
