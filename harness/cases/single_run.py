"""One run of one system in one engine, as the columns of a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.cases.acting import bounded, can_be_reached, driven, passed, reached, without_room
from harness.cases.case import NATIVE, Array
from harness.cases.checks.trajectory import initial_state
from harness.effects import input_chain, sensor_chain
from harness.engines import registry
from harness.engines.expressed import realised
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import InputError, UnsupportedError
from harness.recording.efforts import read_efforts
from harness.recording.recording import QualityNote
from harness.recording.units import factor_to_si
from harness.system import Joint, System, Trajectory
from harness.system.lowering import followed
from harness.system.magnitudes import check_start
from harness.system.suggest import did_you_mean

# Eight columns of doubles of this length are half a gigabyte.
MOST_SAMPLES = 10_000_000
# How closely limits are looked for [s], as many times at most.
CLOSE, MOST_LOOKED_AT = 1e-3, 1_000_000


@dataclass(frozen=True, eq=False)
class SingleRun:
    """A finished run.

    columns: recording column name to samples, ``time`` first, each shape (T,). energy: largest change of the total
    energy relative to the largest kinetic energy, None where the engine does not tell or something drives or damps.
    notes: what acted of the model beside its description, and what did not though the motion met it.
    """

    engine: str
    version: str
    columns: Mapping[str, Array]
    energy: float | None
    notes: tuple[str, ...] = ()

    def at(self, time: Array) -> SingleRun:
        """The same at some of its sample times alone, shape (T,)."""
        chosen = np.searchsorted(self.columns["time"], time)
        return replace(self, columns={name: values[chosen] for name, values in self.columns.items()})


def assignments(texts: Sequence[str], option: str, quantity: str, system: System) -> dict[str, float]:
    """``pivot=1.2`` and ``pivot=70[deg]`` as SI values by coordinate name.

    Raises InputError for what is not of that form, an unknown joint, a joint given twice, a unit that does not fit, a number beyond
    any mechanism.
    """
    values: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.rpartition("=")
        value, bracket, unit = value.partition("[")
        if not equals or not name.strip() or (bracket and not unit.endswith("]")):
            raise InputError(
                f"{option} {text!r} is not of the form joint=value", mend=f"{option} pivot=1.2 or pivot=70[deg]"
            )
        name = name.strip()
        known = system.position_names if quantity == "position" else system.coordinate_names
        if name not in known:
            if name in system.joint_names:
                own = system.joint(name).position_names if quantity == "position" else system.joint(name).velocity_names
                followed = system.joint(name).mimic
                raise InputError(
                    f"{option}: joint {name!r} has several numbers"
                    if own
                    else f"{option}: joint {name!r} follows another",
                    mend=f"give them by name: {', '.join(own)}" if own or followed is None else f"set {followed.joint}",
                )
            raise InputError(f"{option}: no joint is named {name!r}", mend=did_you_mean(name, known))
        if name in values:
            raise InputError(f"{option}: {name} is given twice", mend="give each joint once")
        prismatic = name in system.joint_names and system.joint(name).prismatic
        factor = factor_to_si(unit.rstrip("]"), quantity, prismatic=prismatic)[0] if bracket else 1.0
        try:
            values[name] = float(value) * factor
        except ValueError:
            raise InputError(f"{option}: {value.strip()!r} is not a number", mend=f"{option} {name}=1.2") from None
        if not np.isfinite(values[name]):
            raise InputError(f"{option}: {name} is {value.strip()}", mend="give a finite number")
    check_start(system, values, "" if quantity == "position" else "/s", option)
    return values


def sample_times(duration: float, rate: float) -> Array:
    """Sample times [s] from 0 to the duration; InputError for figures that make no run."""
    for name, value in (("--duration", duration), ("--rate", rate)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} {value:g} is not positive", mend="give seconds, and samples a second")
    count = duration * rate
    if count > MOST_SAMPLES:
        raise InputError(f"{count:.0f} samples are more than {MOST_SAMPLES}", mend="lower --rate or --duration")
    if count < 1.0:
        raise InputError(f"no sample falls into {duration:g} s at {rate:g} Hz", mend="raise --rate or --duration")
    return np.arange(int(np.floor(count * (1.0 + 1e-12))) + 1) / rate


@dataclass(frozen=True, eq=False)
class Drive:
    """Applied efforts, shape (T, n), and what there is to tell of the file they are from.

    time: [s], shape (T,): the sample times of the run, and between them those at which the file says something.
    """

    time: Array
    tau: Array
    notes: tuple[QualityNote, ...] = ()


def drive_from(path: str | Path, time: Array, system: System, *, hold: str = "zero") -> Drive:
    """Applied efforts from a file's ``<joint>.effort`` columns, whose first sample is the run's time 0; time: of the run's samples.

    hold: between the file's samples the last one holds ("zero"), as a controller's command does, or they are joined by straight
    lines ("linear"), as is right for a measured effort. After the last it is zero. Raises InputError for what cannot be used.
    """
    file = read_efforts(path, system)
    stamps = file.time
    usual = float(np.median(np.diff(stamps)))
    # Stamps since 1970 are kept to a quarter of a microsecond only.
    slack = 1e-12 + 4.0 * np.finfo(np.float64).eps * abs(file.start)
    time = _with_stamps(time, np.append(stamps, stamps[-1] + usual), slack)
    tau = np.zeros((len(time), len(system.coordinate_names)))
    place = np.searchsorted(stamps, time * (1.0 + 1e-12) + slack, side="right") - 1
    inside = (place >= 0) & (time <= stamps[-1] * (1.0 + 1e-12) + slack)
    notes = list(file.notes)
    for effort in file.efforts:
        acting = effort.values[place[inside]] if hold == "zero" else np.interp(time[inside], stamps, effort.values)
        tau[inside, system.coordinate_names.index(effort.site)] = acting
        if not acting.any() and effort.values.any():
            first = float(stamps[np.flatnonzero(effort.values)[0]])
            what = f"is 0 until {first:.4g} s, after the run of {time[-1]:.4g} s has ended"
            notes.append(QualityNote("idle_effort", effort.name, what, "the joint is not driven"))
    if stamps[-1] + 1.01 * usual < time[-1]:
        what = f"the file ends at {stamps[-1]:.4g} s, the run at {time[-1]:.4g} s"
        notes.append(QualityNote("short_effort", "time", what, "no effort after that"))
    return Drive(time, tau, tuple(notes))


def _with_stamps(time: Array, stamps: Array, slack: float) -> Array:
    """The run's sample times, and between them a file's stamps that are none of these but for rounding."""
    slack = max(slack, 1e-9 * float(np.diff(time).min()))
    near = np.clip(np.searchsorted(time, stamps), 1, len(time) - 1)
    away = np.minimum(np.abs(stamps - time[near]), np.abs(stamps - time[near - 1])) > slack
    return np.union1d(time, stamps[away & (stamps > time[0]) & (stamps < time[-1])])


def run_once(
    system: System,
    time: Array,
    position: Mapping[str, float],
    velocity: Mapping[str, float],
    *,
    engine: str = NATIVE,
    tau: Array | None = None,
    hold: str = "zero",
    step: float | None = None,
    command: Mapping[str, float] | None = None,
    limits: bool = False,
) -> SingleRun:
    """Run a system once.

    command: of its actuators, held, by name (0 where absent); None leaves actuators out. limits: whether those of the joints act
    where the motion reaches them, as soft constraints.

    position, velocity: initial values by coordinate name, others zero [rad or m, rad/s or m/s]. tau: (T, n), as
    recorded; effects of the input attached to the system act on it, those of sensors on what is returned. hold: between samples
    it keeps the earlier value ("zero") or runs straight ("linear"), which every engine is given as its mean from each to the next.
    Raises InputError for an unknown engine, a system the engine cannot express, and a motion that leaves all bounds.
    """
    if engine not in registry.every_name():
        raise InputError(f"no engine is named {engine!r}", mend=did_you_mean(engine, registry.every_name()))
    notes: tuple[str, ...] = ()
    if command is not None:
        efforts = system.joint_names if tau is not None else ()
        system, driving = driven(system, command, efforts)
        notes = tuple(each.said for each in driving)
    adapter = registry.engine(engine)
    version = adapter.version()
    # Effects may add coordinates of their own (a base that slides, a link that bends); these start at rest, undriven.
    whole = realised(system)
    reason = adapter.refuses(whole)
    if reason is not None:
        raise UnsupportedError(
            f"{engine} cannot run it: {reason}", source=system.source, mend="choose another --engine"
        )
    model = adapter.build(whole)
    names = list(system.coordinate_names)
    q0, qd0 = initial_state(whole, dict(position), dict(velocity))
    if whole.loops:
        begins = (f"{n} = {x:.6g}" for n, x in zip(whole.position_names, q0, strict=True) if n not in position)
        notes += (f"the loops are closed at {', '.join(begins)}",)
    arriving = None if tau is None else _arriving(system, whole, tau, time)
    if arriving is not None and hold == "linear":
        from harness.denoc.motion.hold import kept

        arriving = kept(arriving)
    try:
        run = model.simulate(q0, qd0, time, tau=arriving, step=step)
        met: tuple[str, ...] = ()
        if limits:
            notes += without_room(system)
        if limits and can_be_reached(system):
            close = _closely(model, run, q0, qd0, arriving, step)
            met = reached(system, close.position_names, close.time, close.position)
            notes += met
            if met and system.limits_act:
                ends = realised(bounded(system))
                reason = adapter.refuses(ends)
                if reason is None:
                    bounded_model = adapter.build(ends)
                    run = bounded_model.simulate(q0, qd0, time, tau=arriving, step=step)
                    close = _closely(bounded_model, run, q0, qd0, arriving, step)
                else:
                    notes += (f"limits do not act, the motion runs through them: {reason}",)
            notes += passed(system, close.position_names, close.time, close.position)
    except EngineError as error:
        raise InputError(str(error), mend="a smaller --step or --duration, or a gentler start") from error
    columns: dict[str, Array] = {"time": time}
    for joint in system.movable_joints:
        for name in joint.position_names:
            columns[column_name(joint, name, "position")] = run.position[:, run.position_names.index(name)]
        for name in joint.velocity_names:
            columns[column_name(joint, name, "velocity")] = run.velocity[:, run.names.index(name)]
            if tau is not None:
                columns[column_name(joint, name, "effort")] = tau[:, names.index(name)]
        if joint.mimic is not None:
            leader, multiplier, offset = followed(system, joint)
            course = run.position[:, run.position_names.index(leader)]
            columns[column_name(joint, joint.name, "position")] = multiplier * course + offset
            columns[column_name(joint, joint.name, "velocity")] = multiplier * run.velocity[:, run.names.index(leader)]
    columns.update(run.channels)
    for name, values in columns.items():
        if not np.isfinite(values).all():
            first = float(time[int(np.argmin(np.isfinite(values)))])
            raise InputError(
                f"{engine}: {name} stops being finite at {first:g} s", mend="a smaller --step, or a gentler start"
            )
    seen = {name: _through_sensors(system, name, values, time) for name, values in columns.items()}
    change = None if system.drives or (met and system.limits_act) else _energy_change(system, model, run, tau)
    return SingleRun(engine, version, seen, change, notes)


def _closely(
    model: EngineModel, run: Trajectory, q0: Array, qd0: Array, tau: Array | None, step: float | None
) -> Trajectory:
    """The run at times so close that no limit is reached and left again unseen between two of them."""
    apart = np.diff(run.time)
    spacing = max(CLOSE, float(run.time[-1] - run.time[0]) / MOST_LOOKED_AT)
    parts = int(np.ceil(apart.max() / spacing * (1.0 - 1e-9)))
    if parts <= 1:
        return run
    between = (run.time[:-1, None] + apart[:, None] * np.arange(parts) / parts).ravel()
    held = None if tau is None else np.vstack([np.repeat(tau[:-1], parts, axis=0), tau[-1:]])
    return model.simulate(q0, qd0, np.append(between, run.time[-1]), tau=held, step=step)


def column_name(joint: Joint, name: str, quantity: str) -> str:
    """A recording's column of a joint's position, velocity or effort by name: ``knee.position``, ``root.position.qw``."""
    return f"{joint.name}.{quantity}{name.removeprefix(joint.name)}"


def _arriving(system: System, whole: System, tau: Array, time: Array) -> Array:
    """What arrives of recorded efforts at the coordinates of the system with its effects in it, (T, n) to (T, m)."""
    through = _through_inputs(system, tau, time)
    arriving = np.zeros((len(time), len(whole.coordinate_names)))
    for column, name in enumerate(system.coordinate_names):
        arriving[:, whole.coordinate_names.index(name)] = through[:, column]
    return arriving


def _through_inputs(system: System, tau: Array, time: Array) -> Array:
    arriving = tau.copy()
    for joint in system.joint_names:
        if not system.joint(joint).simple:
            continue
        column = system.coordinate_names.index(joint)
        for kind, attachment in input_chain(system.attachments, joint):
            if kind.input is not None:
                values = kind.values(attachment.parameters)[None, :]
                arriving[:, column] = kind.input.apply(arriving[None, :, column], time, values)[0]
    return arriving


def _through_sensors(system: System, channel: str, signal: Array, time: Array) -> Array:
    if channel == "time" or channel.endswith(".effort"):
        return signal
    for kind, attachment in sensor_chain(system.attachments, channel):
        if kind.sensor is not None:
            signal = kind.sensor.apply(signal[None, :], time, kind.values(attachment.parameters)[None, :])[0]
    return signal


def _energy_change(system: System, model: object, run: object, tau: Array | None) -> float | None:
    """Change of the total energy where it should be kept: nothing drives, damps or rubs."""
    losing = any(joint.damping or joint.friction or joint.stiffness for joint in system.joints)
    if tau is not None or losing or system.attachments or system.flexible:
        return None
    if (
        not isinstance(model, EngineModel)
        or not isinstance(run, Trajectory)
        or len(run.names) != len(system.coordinate_names)
    ):
        return None
    some = np.unique(np.linspace(0, len(run.time) - 1, 50).round().astype(int))
    try:
        parts = np.array([model.energy(run.position[k], run.velocity[k]) for k in some])
    except UnsupportedError:
        return None
    total = parts.sum(axis=1)
    largest = float(parts[:, 0].max())
    return float(np.abs(total - total[0]).max() / largest) if largest > 0.0 else 0.0
