"""Recordings read from files, checked and put into SI."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.recording.clean import (
    fill_effort,
    find_outliers,
    find_saturation,
    quantisation_step,
    unwrap_angle,
)
from harness.recording.columns import Column, Rule, parse_rule, resolve, rules_beside
from harness.recording.jitter import jitter_note
from harness.recording.recording import Channel, QualityNote, Recording
from harness.recording.rezero import undo_rezeroing
from harness.recording.stale import find_stale
from harness.recording.table import Table, read_table
from harness.recording.timing import Timing, grouped_mean, mend_time
from harness.recording.units import factor_to_si
from harness.system import System
from harness.system.description import Array, constant

FEWEST = 20  # samples below which neither motion nor noise can be told
COARSE_SHARE = 0.02  # of equal neighbours, from which a step is worth a word


def read_recording(path: str | Path, *, mapping: Sequence[str] = (), system: System | None = None) -> Recording:
    """Read one recording.

    path: CSV, ``.csv.gz``, Parquet, HDF5, MATLAB or MCAP with JSON messages, told by content.
    mapping: rules for foreign headers, ``theta_meas=pivot.position[deg]``; they go before those of a TOML file beside it.
    system: to check joints and links against, and to tell revolute from prismatic ones.
    Raises InputError, naming file, line and column, for what cannot be used; what was mended stands in ``quality``.
    """
    file = Path(path)
    table = read_table(file)
    own = tuple(parse_rule(text) for text in mapping)
    mapped = {rule.foreign for rule in own}
    rules = own + tuple(rule for rule in rules_beside(file) if rule.foreign not in mapped)
    return recording_from_table(table, rules, system, file)


def read_recordings(
    paths: Iterable[str | Path], *, mapping: Sequence[str] = (), system: System | None = None
) -> tuple[Recording, ...]:
    """Read several recordings of one system, in the order given; see ``read_recording``.

    Raises InputError as well if none is given, one is given twice, or they have no measured channel in common.
    """
    files = [Path(path) for path in paths]
    if not files:
        raise InputError("no recording given", mend="name at least one file")
    seen: set[Path] = set()
    for file in files:
        if file.resolve() in seen:
            raise InputError("is given twice", mend="name each recording once", source=file)
        seen.add(file.resolve())
    recordings = tuple(read_recording(file, mapping=mapping, system=system) for file in files)
    common = set(recordings[0].channel_names)
    for recording in recordings[1:]:
        common &= set(recording.channel_names)
        if not common:
            raise InputError(
                f"measures {', '.join(recording.channel_names)}, nothing that {recordings[0].name} measures",
                mend="recordings given together must share a channel",
                source=recording.source,
            )
    return recordings


def recording_from_table(table: Table, rules: Sequence[Rule], system: System | None, file: Path) -> Recording:
    """The recording that a table holds; see ``read_recording``."""
    columns, ignored = resolve(tuple(table.columns), rules, system, source=file)
    notes = [QualityNote("cut_off", "", remark, "left out") for remark in table.remarks]
    notes += [QualityNote("ignored_column", header, "is no column of ours", "left out") for header in ignored]
    clock = columns[0]
    factor, _ = factor_to_si(
        clock.unit or table.units.get(clock.header, ""), "time", prismatic=None, source=file, column=clock.header
    )
    _refuse_short(int(np.isfinite(table.columns[clock.header]).sum()), file)
    timing = mend_time(_finite(table.columns[clock.header]) * factor * clock.sign, table.lines, file)
    notes += timing.notes
    _refuse_short(len(timing.time), file)
    channels: list[Channel] = []
    efforts: list[Channel] = []
    for column in columns[1:]:
        channel, found = _channel(column, table, timing, system, file)
        notes += found
        (efforts if column.quantity == "effort" else channels).append(channel)
    if not channels:
        raise InputError(
            "nothing is measured; only efforts are given",
            mend="a position or another measured column is needed",
            source=file,
        )
    headers = [column.header for column in columns[1:] if column.quantity != "effort"]
    measured = np.array(
        [np.isfinite(grouped_mean(_finite(table.columns[h]), timing.groups, len(timing.time))) for h in headers]
    )
    time, channels, efforts, dropped = _drop_blank(timing.time, measured, channels, efforts)
    notes += dropped
    first = float(time[0])
    _refuse_short(len(time), file)
    moving = [c for c in channels if float(np.ptp(c.values[np.isfinite(c.values)])) > 0.0]
    if not moving:
        raise InputError(
            "nothing moves: every channel is constant", mend="check the columns and the cable", source=file
        )
    efforts, filled = _complete(efforts, time, file)
    return Recording(
        name=file.name.removesuffix(".gz").rsplit(".", 1)[0],
        source=str(file),
        time=constant(time - first),
        channels=tuple(channels),
        efforts=tuple(efforts),
        quality=tuple(notes + filled),
        start=timing.start + first,
    )


def _refuse_short(samples: int, file: Path) -> None:
    if samples < FEWEST:
        raise InputError(
            f"has {samples} usable samples, too short to tell motion from noise",
            mend=f"at least {FEWEST} are needed",
            source=file,
        )


def _finite(values: Array) -> Array:
    """The same with infinities as missing samples."""
    return np.where(np.isfinite(values), values, np.nan)


def _channel(
    column: Column, table: Table, timing: Timing, system: System | None, file: Path
) -> tuple[Channel, list[QualityNote]]:
    prismatic = None
    if system is not None and column.site in system.joint_names:
        prismatic = system.joint(column.site).prismatic
    factor, unit = factor_to_si(
        column.unit or table.units.get(column.header, ""),
        column.quantity,
        prismatic=prismatic,
        source=file,
        column=column.header,
    )
    rows = _finite(table.columns[column.header]) * (factor * column.sign)
    if not np.isfinite(rows).any():
        raise InputError("holds no number", mend="map another column or remove it", source=file, column=column.header)
    notes: list[QualityNote] = []
    angle = column.quantity == "position" and unit == "rad"
    if angle and len(timing.time) == len(rows):
        # Unwrapped in the file's own samples: the mean of two of them across a wrap would be no angle.
        values, found = unwrap_angle(
            column.name, timing.time, grouped_mean(rows, timing.groups, len(timing.time)), file
        )
        notes += found
    elif angle:
        first = np.full(len(timing.time), -1, dtype=np.intp)
        for row in np.flatnonzero(timing.groups >= 0)[::-1]:
            first[timing.groups[row]] = row
        values, found = unwrap_angle(column.name, timing.time, rows[first], file)
        if not found:
            values = grouped_mean(rows, timing.groups, len(timing.time))
        notes += found
    else:
        values = grouped_mean(rows, timing.groups, len(timing.time))
    step = quantisation_step(values)
    if column.quantity != "effort":
        values, stale = find_stale(column.name, timing.time, values, step)
        if stale is not None:
            notes.append(stale)
    if column.quantity == "position":
        values, outliers = find_outliers(column.name, timing.time, values, step)
        if outliers is not None:
            notes.append(outliers)
        values, joins = undo_rezeroing(column.name, unit, timing.time, values, step)
        notes += joins
    finite = values[np.isfinite(values)]
    if float(np.ptp(finite)) == 0.0:
        notes.append(QualityNote("constant", column.name, f"is {finite[0]:.6g} throughout", "kept", len(finite)))
    elif column.quantity != "effort":
        equal = float(np.mean(np.diff(finite) == 0.0))
        if step > 0.0 and equal > COARSE_SHARE:
            notes.append(
                QualityNote(
                    "quantisation",
                    column.name,
                    f"comes in steps of {step:.4g} {unit}",
                    "counted as noise of the channel",
                    len(finite),
                    size=step,
                )
            )
        late = jitter_note(column.name, unit, timing.time, values, step) if column.quantity == "position" else None
        if late is not None:
            notes.append(late)
        saturation = find_saturation(column.name, timing.time, values, step)
        if saturation is not None:
            notes.append(saturation)
    return Channel(column.name, column.site, column.quantity, unit, constant(values), column.header), notes


def _drop_blank(
    time: Array, present: NDArray[np.bool_], channels: list[Channel], efforts: list[Channel]
) -> tuple[Array, list[Channel], list[Channel], list[QualityNote]]:
    """Samples at which nothing was measured are left out; what single channels lack is told.

    present: whether the file has a number, shape (channels, samples).
    """
    keep = present.any(axis=0)
    notes: list[QualityNote] = []
    blank = int((~keep).sum())
    if blank:
        notes.append(
            QualityNote(
                "missing",
                "time",
                f"{blank} samples hold no measurement",
                "left out",
                blank,
                tuple((float(t), float(t)) for t in time[~keep][:8]),
            )
        )
    for channel, has in zip(channels, present, strict=True):
        lacking = int((~has & keep).sum())
        if lacking:
            notes.append(
                QualityNote("missing", channel.name, f"{lacking} samples are missing", "left open; not fitted", lacking)
            )

    def cut(channel: Channel) -> Channel:
        values = constant(channel.values[keep])
        return Channel(channel.name, channel.site, channel.quantity, channel.unit, values, channel.column)

    return time[keep], [cut(c) for c in channels], [cut(e) for e in efforts], notes


def _complete(efforts: list[Channel], time: Array, file: Path) -> tuple[list[Channel], list[QualityNote]]:
    complete, notes = [], []
    for effort in efforts:
        values, note = fill_effort(effort.name, time, effort.values, file)
        if note is not None:
            notes.append(note)
        complete.append(
            Channel(effort.name, effort.site, effort.quantity, effort.unit, constant(values), effort.column)
        )
    return complete, notes
