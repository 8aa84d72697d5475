"""Messages of several topics on one time axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.formats.ros_messages import numbers_of, stamp_of
from harness.recording.formats.ros_types import Decoder, RawMessage, UnknownMessageError
from harness.recording.formats.table import Table, left_out, stated_twice
from harness.recording.recording import QualityNote


def read_messages(path: Path, messages: Iterable[RawMessage]) -> Table:
    """The numbers of all messages that can be read; raises InputError, naming a topic and why, if none can."""
    decoder = Decoder()
    samples: list[tuple[str, int, dict[str, float]]] = []
    twice: set[str] = set()
    failed: dict[str, str] = {}
    broken: dict[str, int] = {}
    for raw in messages:
        if raw.topic in failed:
            continue
        try:
            content = decoder.message(raw)
        except UnknownMessageError as failure:
            failed[raw.topic] = str(failure)
            continue
        except ValueError:
            broken[raw.topic] = broken.get(raw.topic, 0) + 1
            continue
        numbers, doubled = numbers_of(content)
        twice |= {named(raw.topic, number) for number in doubled}
        if numbers:
            stamp = stamp_of(content)
            samples.append((raw.topic, raw.time if stamp is None else stamp, numbers))
    if not samples and failed:
        topic, reason = next(iter(failed.items()))
        raise InputError(
            f"topic {topic!r} {reason}", mend="JSON, CDR and ROS 1 messages are read; convert it", source=path
        )
    notes = [left_out(topic, reason) for topic, reason in failed.items()]
    notes += [left_out(topic, f"{count} messages are damaged") for topic, count in broken.items()]
    faults = {name: stated_twice(path, name) for name in twice}
    return _merged(path, samples, notes, faults)


def _merged(
    path: Path,
    samples: Iterable[tuple[str, int, dict[str, float]]],
    notes: Iterable[QualityNote],
    faults: Mapping[str, InputError],
) -> Table:
    """One column for each number of each topic, ``/joint_states/pivot/position``, nan where another topic has its message.

    samples: topic, stamp [ns] and numbers by path. What is found in one topic only goes by its path alone as well. Raises
    InputError if there is no sample.
    """
    notes = tuple(notes)
    ordered = sorted(samples, key=lambda sample: sample[1])
    if not ordered:
        told = f": {notes[0].what} ({notes[0].channel})" if notes else ""
        raise InputError(
            f"holds no numbers{told}", mend="messages with name, position, velocity, effort, or any fields", source=path
        )
    first = ordered[0][1]
    rows: dict[tuple[int, int], dict[str, float]] = {}
    for topic, stamp, numbers in ordered:
        values = {named(topic, key): number for key, number in numbers.items()}
        turn = 0
        # A second message of one stamp is a sample of its own.
        while rows.get((stamp, turn), {}).keys() & values.keys():
            turn += 1
        rows.setdefault((stamp, turn), {}).update(values)
    order = sorted(rows)
    names = list(dict.fromkeys(name for key in order for name in rows[key]))
    columns = {"time": np.array([(stamp - first) * 1e-9 for stamp, _ in order])}
    for name in names:
        columns[name] = np.array([rows[key].get(name, np.nan) for key in order])
    topics = {f"/{topic.strip('/')}/" for topic, _, _ in ordered}
    return Table(
        columns,
        faults=faults,
        origins={"time": first * 1e-9},
        aliases=_aliases(names, topics),
        interleaved=len({topic for topic, _, _ in ordered}) > 1,
        notes=notes,
    )


def named(topic: str, path: str) -> str:
    """A column's name: ``/joint_states/pivot/position``."""
    return f"/{topic.strip('/')}/{path}" if topic else path


def _aliases(names: list[str], topics: set[str]) -> dict[str, str]:
    """What is left of each name without its topic, where no other topic has the same."""
    short: dict[str, list[str]] = {}
    for name in names:
        topic = max((t for t in topics if name.startswith(t)), key=len, default="")
        short.setdefault(name[len(topic) :], []).append(name)
    return {whole[0]: tail for tail, whole in short.items() if len(whole) == 1}
