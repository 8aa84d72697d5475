"""Files of applied efforts: read as recordings are, but nothing needs to be measured in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.clean import fill_effort
from harness.recording.columns import resolve, rules_beside, told_rules
from harness.recording.formats import read_table
from harness.recording.read import check_clock_of, factor_of, ignored_notes
from harness.recording.recording import Channel, QualityNote
from harness.recording.timing import grouped_mean, mend_time
from harness.system import System
from harness.system.description import Array, constant


@dataclass(frozen=True, eq=False)
class EffortFile:
    """Applied efforts over time.

    time: [s] from the first sample, ascending, shape (T,). start: time of the first sample in the file [s].
    """

    time: Array
    efforts: tuple[Channel, ...]
    notes: tuple[QualityNote, ...]
    start: float


def read_efforts(path: str | Path, system: System, *, mapping: Sequence[str] = ()) -> EffortFile:
    """The ``<joint>.effort`` columns of a file in any format of recordings, in SI.

    mapping: rules for foreign headers, as of ``read_recording``. Raises InputError, naming file, line and column, for what cannot
    be used, an effort that is unknown somewhere included.
    """
    file = Path(path)
    table = read_table(file)
    own = told_rules(mapping)
    mapped = {rule.foreign for rule in own}
    rules = own + tuple(rule for rule in rules_beside(file) if rule.foreign not in mapped)
    found = resolve(tuple(table.columns), rules, system, source=file, aliases=table.aliases, unread=table.unread)
    clock = found.columns[0]
    notes = [*table.notes, *ignored_notes(found.ignored)]
    factor, _, other = factor_of(clock, table, prismatic=None, file=file)
    notes += other
    check_clock_of(clock, table, factor, file)
    efforts = [column for column in found.columns if column.quantity == "effort"]
    if not efforts:
        raise InputError("has no column <joint>.effort", source=path, mend="name the columns time and <joint>.effort")
    if table.interleaved:
        # Rows of other topics say nothing of the efforts.
        rows = np.any([np.isfinite(table.numbers(column.header)) for column in efforts], axis=0)
    else:
        rows = np.ones(table.rows, dtype=bool)
    stamps = table.numbers(clock.header)[rows] * factor * clock.sign
    timing = mend_time(stamps, table.lines if rows.all() else None, file)
    notes += timing.notes
    channels = []
    for column in efforts:
        size, unit, other = factor_of(column, table, prismatic=system.joint(column.site).prismatic, file=file)
        notes += other
        values = grouped_mean(table.numbers(column.header)[rows], timing.groups, len(timing.time)) * size * column.sign
        if not np.isfinite(values).any():
            raise InputError("holds no number", mend="an input must be known", source=file, column=column.header)
        filled, note = fill_effort(column.name, timing.time, values, file, column.header)
        if note is not None:
            notes.append(note)
        if not filled.any():
            notes.append(QualityNote("idle_effort", column.name, "is 0 throughout", "the joint is not driven"))
        channels.append(Channel(column.name, column.site, "effort", unit, constant(filled), column.header))
    start = timing.start + table.origins.get(clock.header, 0.0) * factor
    return EffortFile(constant(timing.time), tuple(channels), tuple(notes), start)
