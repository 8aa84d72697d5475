"""Recordings read from files, checked and put into SI."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.recording.clean import (
    fill_effort,
    find_bursts,
    find_outliers,
    find_saturation,
    quantisation_step,
)
from harness.recording.clocks import one_clock
from harness.recording.columns import Column, Rule, resolve, rules_beside, told_rules, unpacked_name
from harness.recording.folded import unfold
from harness.recording.formats import Table, read_table
from harness.recording.jitter import jitter_note
from harness.recording.magnitudes import LEAST, check_clock, without_absurd
from harness.recording.recording import GIVEN, POSITIONS, SPATIAL_UNITS, Channel, QualityNote, Recording
from harness.recording.rezero import undo_rezeroing
from harness.recording.stale import find_stale
from harness.recording.stamp_pattern import healed
from harness.recording.timing import Timing, grouped_mean, mend_time
from harness.recording.units import factor_to_si, is_unit
from harness.system import System
from harness.system.description import Array, constant

FEWEST = 20  # samples below which neither motion nor noise can be told
FEW_COLUMNS = 6  # left out for one reason that are named one by one
COARSE_SHARE = 0.02  # of equal neighbours, from which a step is worth a word


def read_recording(
    path: str | Path, *, mapping: str | Sequence[str] | Mapping[str, str] | None = (), system: System | None = None
) -> Recording:
    """Read one recording.

    path: CSV, Parquet, HDF5, netCDF, MATLAB, NumPy, MCAP or a ROS bag, packed or not, told by content.
    mapping: rules for foreign headers, ``theta_meas=pivot.position[deg]``, one or several, or a dictionary;
        before those of a TOML file beside it.
    system: to check joints and links against, and to tell revolute from prismatic ones.
    Raises InputError, naming file, line and column, for what cannot be used; what was mended stands in ``quality``.
    """
    file = Path(path)
    table = read_table(file)
    own = told_rules(mapping)
    mapped = {rule.foreign for rule in own}
    rules = own + tuple(rule for rule in rules_beside(file) if rule.foreign not in mapped)
    return recording_from_table(table, rules, system, file)


def read_recordings(
    paths: Iterable[str | Path],
    *,
    mapping: str | Sequence[str] | Mapping[str, str] | None = (),
    system: System | None = None,
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
    found = resolve(tuple(table.columns), rules, system, source=file, aliases=table.aliases, unread=table.unread)
    notes = [*table.notes, *ignored_notes(found.ignored)]
    columns, empty = _with_numbers(found.columns, table, file)
    notes += empty
    if table.interleaved:
        table, told = one_clock(table, columns)
        notes += told
    clock = columns[0]
    factor, _, other = factor_of(clock, table, prismatic=None, file=file)
    notes += other
    _refuse_short(int(np.isfinite(table.columns[clock.header]).sum()), file)
    check_clock_of(clock, table, factor, file)
    try:
        timing = mend_time(_finite(table.columns[clock.header]) * factor * clock.sign, table.lines, file)
    except InputError as error:
        raise InputError(error.what, mend=error.mend, source=file, line=error.line, column=clock.header) from None
    notes += timing.notes
    _refuse_short(len(timing.time), file)
    channels: list[Channel] = []
    efforts: list[Channel] = []
    steps: dict[str, float] = {}
    for column in columns[1:]:
        channel, seen, steps[column.name] = _channel(column, table, timing, system, file)
        notes += seen
        (efforts if column.quantity in GIVEN else channels).append(channel)
    if not channels:
        raise InputError(
            "nothing is measured; only efforts are given",
            mend="a position or another measured column is needed",
            source=file,
        )
    headers = [column.header for column in columns[1:] if column.quantity not in GIVEN]
    measured = np.array(
        [np.isfinite(grouped_mean(_finite(table.columns[h]), timing.groups, len(timing.time))) for h in headers]
    )
    time, channels, efforts, dropped = _drop_blank(timing.time, measured, channels, efforts)
    notes += dropped
    _refuse_short(len(time), file)
    time, late = _read_when(time, channels, steps)
    notes += late
    first = float(time[0])
    moving = [c for c in channels if float(np.ptp(c.values[np.isfinite(c.values)])) > LEAST]
    if not moving:
        raise InputError(
            "nothing moves: every channel is constant", mend="check the columns and the cable", source=file
        )
    efforts, filled = _complete(efforts, time, file)
    return Recording(
        name=unpacked_name(file).rsplit(".", 1)[0],
        source=str(file),
        time=constant(time - first),
        channels=tuple(channels),
        efforts=tuple(c for c in efforts if c.quantity == "effort"),
        commands=tuple(c for c in efforts if c.quantity == "command"),
        quality=tuple(notes + filled),
        start=timing.start + first + table.origins.get(clock.header, 0.0) * factor,
        clock=clock.header,
    )


def ignored_notes(ignored: Sequence[tuple[str, str]]) -> list[QualityNote]:
    """A note for each column that is left out; one for all where many are for one reason."""
    by_reason: dict[str, list[str]] = {}
    for header, reason in ignored:
        by_reason.setdefault(reason, []).append(header)
    notes = []
    for reason, headers in by_reason.items():
        if len(headers) <= FEW_COLUMNS:
            notes += [QualityNote("ignored_column", header, reason, "left out") for header in headers]
        else:
            some = ", ".join(headers[:4])
            what = f"{len(headers)} columns ({some}, …): each {reason}"
            notes.append(QualityNote("ignored_column", "", what, "left out", len(headers)))
    return notes


def _with_numbers(columns: Sequence[Column], table: Table, file: Path) -> tuple[tuple[Column, ...], list[QualityNote]]:
    """The columns that hold numbers; those that hold none are left out and told, unless nothing is left to be fitted."""
    kept, notes = [], []
    for column in columns:
        if np.isfinite(table.numbers(column.header)).any() or column.quantity == "time":
            kept.append(column)
        else:
            notes.append(QualityNote("empty_column", column.name, "holds no number", "left out"))
    if notes and all(column.quantity in ("time", *GIVEN) for column in kept):
        lost = next(c for c in columns if c.quantity not in ("time", *GIVEN) and c not in kept)
        raise InputError("holds no number", mend="map another column or remove it", source=file, column=lost.header)
    return tuple(kept), notes


def _count(table: Table, column: Column, factor: float) -> float:
    """One of the file's numbers [channel unit] where they are all whole ones, as counts are, else 0."""
    raw = table.columns[column.header]
    finite = raw[np.isfinite(raw)]
    counts = bool(np.all(finite == np.round(finite))) and len(np.unique(finite)) > FEWEST
    return abs(factor) if counts else 0.0


def check_clock_of(clock: Column, table: Table, factor: float, file: Path) -> None:
    """Refuse a column of time whose numbers are of another unit than they are taken for; see ``check_clock``."""
    origin = table.origins.get(clock.header, 0.0) * factor
    unit = clock.unit or table.units.get(clock.header, "")
    check_clock(table.columns[clock.header] * factor, origin, clock.header, unit, file)


def factor_of(
    column: Column, table: Table, *, prismatic: bool | None, file: Path
) -> tuple[float, str, list[QualityNote]]:
    """The number to multiply a column by, the SI unit it then has, and a note where what states its unit differs.

    A mapping's unit goes before the header's, and that before what the format states; stamps of the calendar are in seconds
    whatever is said. Raises InputError where two of them would give other numbers. Where one fits no such quantity (counts, volts),
    the mapping says what it stands for.
    """
    told = table.units.get(column.header, "")
    stamped = bool(told) and column.header in table.origins

    def factor(unit: str) -> tuple[float, str]:
        return factor_to_si(unit, column.quantity, prismatic=prismatic, source=file, column=column.header)

    unit = told if stamped else column.unit or told
    size, si = factor(unit)
    notes: list[QualityNote] = []
    for other in dict.fromkeys((column.stated, "" if stamped else told)):
        if other in ("", unit):
            continue
        try:
            same = bool(np.isclose(factor(other)[0], size, rtol=1e-9, atol=0.0))
        except InputError:
            if is_unit(other):  # else a word in brackets: theta (filtered)
                what = f"is in {other} by the file, and mapped as {unit}"
                notes.append(QualityNote("unit", column.name, what, f"one {other} taken as {unit}"))
            continue
        if not same:
            raise InputError(
                f"is in {other!r} by the file itself, and {unit!r} is said of it",
                mend="leave out the unit that is wrong",
                source=file,
                column=column.header,
            )
    return size, si, notes


def _refuse_short(samples: int, file: Path) -> None:
    if samples < FEWEST:
        raise InputError(
            f"has {samples} usable sample{'' if samples == 1 else 's'}, too short to tell motion from noise",
            mend=f"at least {FEWEST} are needed",
            source=file,
        )


def _finite(values: Array) -> Array:
    """The same with infinities as missing samples."""
    return np.where(np.isfinite(values), values, np.nan)


def _channel(
    column: Column, table: Table, timing: Timing, system: System | None, file: Path
) -> tuple[Channel, list[QualityNote], float]:
    """A column's channel, what was found in it, and its quantisation step."""
    prismatic = None
    if system is not None and column.site in system.joint_names:
        prismatic = system.joint(column.site).prismatic
    factor, unit, other = factor_of(column, table, prismatic=prismatic, file=file)
    factor *= column.sign
    rows = _finite(table.columns[column.header] + table.origins.get(column.header, 0.0)) * factor
    rows, notes = without_absurd(column.name, unit, rows, column.header, table.lines, file)
    notes = other + notes
    values = grouped_mean(rows, timing.groups, len(timing.time))
    if column.quantity in POSITIONS:
        # Made continuous in the file's own samples: the mean of two of them across a jump would be neither.
        samples = values
        if len(timing.time) != len(rows):
            first = np.full(len(timing.time), -1, dtype=np.intp)
            for row in np.flatnonzero(timing.groups >= 0)[::-1]:
                first[timing.groups[row]] = row
            samples = rows[first]
        grain = quantisation_step(samples) or _count(table, column, factor)
        whole, told = unfold(column.name, unit, timing.time, samples, grain, factor, file, column.header)
        values = whole if told else values
        notes += told
    step = quantisation_step(values) or _count(table, column, factor)
    if column.quantity not in GIVEN and column.quantity not in SPATIAL_UNITS:
        values, stale = find_stale(column.name, timing.time, values, step)
        if stale is not None:
            notes.append(stale)
    for look, quantities in ((find_outliers, POSITIONS), (find_bursts, (*POSITIONS, "velocity"))):
        if column.quantity in quantities:
            values, outliers = look(column.name, timing.time, values, step)
            notes += [outliers] if outliers is not None else []
    if column.quantity in POSITIONS:
        values, joins = undo_rezeroing(column.name, unit, timing.time, values, step)
        notes += joins
    finite = values[np.isfinite(values)]
    if float(np.ptp(finite)) == 0.0:
        notes.append(QualityNote("constant", column.name, f"is {finite[0]:.6g} throughout", "kept", len(finite)))
    elif column.quantity not in GIVEN:
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
        saturation = find_saturation(column.name, timing.time, values, step)
        if saturation is not None:
            notes.append(saturation)
    channel = Channel(column.name, column.site, column.quantity, unit, constant(values), column.header)
    return channel, notes, step


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


def _read_when(time: Array, channels: Sequence[Channel], steps: Mapping[str, float]) -> tuple[Array, list[QualityNote]]:
    """Stamps put right where they are late in a pattern; what is late at random is told. steps: of quantisation, by channel."""
    positions = [c for c in channels if c.quantity == "position" and np.nanstd(c.values) > 0.0]
    time, pattern = healed(time, [(c.values, steps[c.name]) for c in positions])
    found = [jitter_note(c.name, c.unit, time, c.values, steps[c.name]) for c in positions]
    return time, [note for note in (pattern, *found) if note is not None]


def _complete(efforts: list[Channel], time: Array, file: Path) -> tuple[list[Channel], list[QualityNote]]:
    complete, notes = [], []
    for effort in efforts:
        values, note = fill_effort(effort.name, time, effort.values, file, effort.column)
        if note is not None:
            notes.append(note)
        complete.append(
            Channel(effort.name, effort.site, effort.quantity, effort.unit, constant(values), effort.column)
        )
    return complete, notes
