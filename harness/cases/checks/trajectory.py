"""The same motion in every engine."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series, thin
from harness.cases.checks.equation_blame import Told, blamed
from harness.cases.checks.finer import finer, step_of
from harness.compare.divergence_shape import course_of
from harness.compare.kinematics import astray, broken
from harness.compare.parting import Motion, Parting, parting
from harness.engines.protocol import EngineError
from harness.errors import UnsupportedError
from harness.system import System, Trajectory
from harness.system.closure import closed_position, closed_velocity, opening, stated_position, worst
from harness.system.lowering import neutral_position

# Said where what fails is no term of the equation of motion.
INTEGRATION = "the accelerations agree, so it is the integration"
# Samples this close [s] tell whether positions follow velocities.
CLOSE = 2e-3
# Of a run, by which fixed steps are looked at.
MOST_STEPS = 1000


@dataclass(frozen=True)
class TrajectoryAgreement:
    """Largest difference of the joints' positions between the native run and each other engine's.

    position, velocity: initial state by coordinate name [rad or m, rad/s or m/s]; others start at zero.
    duration [s], rate [Hz] of the samples; step: step [s] of engines with a fixed one. allowed [rad or m].
    signal: ``position``, or the ending of a channel (``tip_deflection``), then ``relative=True`` counts the RMS
    difference as a share of the peak.
    """

    allowed: float
    why: str
    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 10.0
    rate: float = 100.0
    step: float | None = None
    signal: str = "position"
    relative: bool = False
    quantity: str = "trajectory"
    figure: str = "trajectory"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        q0, qd0 = initial_state(bench.system, dict(self.position), dict(self.velocity))
        time = np.linspace(0.0, self.duration, round(self.duration * self.rate) + 1)
        runs: dict[str, Trajectory] = {}
        reasons: dict[str, str] = {}
        for name, model in bench.models.items():
            try:
                runs[name] = model.simulate(q0, qd0, time, step=step_of(name, self.step))
            except UnsupportedError as error:
                reasons[name] = str(error)
        if NATIVE not in runs:
            yield bench.skipped(self.quantity, (NATIVE,), reasons.get(NATIVE, "the native engine was left out"))
            return
        for name, run in runs.items():
            if name != NATIVE:
                yield self._row(bench, name, time, runs[NATIVE], run)
            yield from self._lines(bench, name, time, pick(run, bench.system, self.signal))
        for name, reason in reasons.items():
            yield bench.skipped(self.quantity, (NATIVE, name), reason)

    def _row(self, bench: Bench, name: str, time: Array, native: Trajectory, run: Trajectory) -> Row:
        ours, theirs = (pick(one, bench.system, self.signal) for one in (native, run))
        common = [key for key in ours if key in theirs]
        if not common:
            return bench.skipped(self.quantity, (NATIVE, name), f"{name} does not give {self.signal}")
        apart = np.array([np.abs(ours[key] - theirs[key]) for key in common])
        if self.relative:
            peak = max(float(np.abs(ours[key]).max()) for key in common)
            difference = float(np.sqrt((apart**2).mean(axis=1)).max() / peak)
            line = self.allowed * peak
        else:
            difference = float(apart.max()) if np.isfinite(apart).all() else float("nan")
            line = self.allowed
        left = ~(apart.max(axis=0) <= line)
        divergence: dict[str, object] | None = None
        if not difference <= self.allowed:
            first = int(np.argmax(left)) if left.any() else len(time) - 1
            worst = common[int(np.argmax(np.nan_to_num(apart[:, first], nan=np.inf)))]
            divergence = {"time": float(time[first]), "signal": worst}
        note, told = f"over {self.duration:g} s", Told()
        if divergence is not None and bench.models[name].names == bench.models[NATIVE].names:
            told = self._blame(bench, name, first)
            note = "; ".join(filter(None, [note, told.words]))
        if divergence is not None:
            begins = None
            if self.signal == "position":
                found = self._parting(bench, name, native, run, common, one_equation=told.agree)
                note = "; ".join(filter(None, [note, found.words]))
                divergence |= found.place(time)
                begins = found.begins
            divergence |= course_of(time, ours[worst], theirs[worst], begins) | told.place
        unit = "1" if self.relative else unit_of(bench.system, common)
        return bench.row(
            self.quantity,
            (NATIVE, name),
            difference,
            self.allowed,
            unit=unit,
            why=self.why,
            first_divergence=divergence,
            note=note,
        )

    def _parting(
        self, bench: Bench, name: str, native: Trajectory, run: Trajectory, common: list[str], *, one_equation: bool
    ) -> Parting:
        """From when on the two motions differ by more than their integration makes, and which of the two is to blame."""
        start = initial_state(bench.system, dict(self.position), dict(self.velocity))

        def motion_of(engine: str, motion: Trajectory) -> Motion:
            again = finer(bench.system, engine, bench.models[engine], *start, motion, step_of(engine, self.step))
            return Motion.of(engine, motion, again, common)

        first, second = motion_of(NATIVE, native), motion_of(name, run)
        return parting(native.time, first, second, self.allowed, one_equation=one_equation)

    def _blame(self, bench: Bench, name: str, sample: int) -> Told:
        """Which term is to blame, asked along the native motion up to where the two part."""
        q0, qd0 = initial_state(bench.system, dict(self.position), dict(self.velocity))
        time = np.linspace(0.0, self.duration, round(self.duration * self.rate) + 1)[: max(sample, 1) + 1]
        run = bench.models[NATIVE].simulate(q0, qd0, time, step=step_of(NATIVE, self.step))
        chosen = np.unique(np.linspace(0, len(time) - 1, 8).round().astype(int))
        q, qd = run.position[chosen], run.velocity[chosen]
        if not (np.isfinite(q).all() and np.isfinite(qd).all()):
            return Told()
        told = blamed(bench, name, q, qd, np.zeros_like(qd))
        return self._integrated(bench, name, q0, qd0) if told.agree else told

    def _integrated(self, bench: Bench, name: str, q0: Array, qd0: Array) -> Told:
        """Where the equations are one, and the motion is not: whether positions go where velocities say, from the start."""
        time = np.linspace(0.0, min(self.duration, CLOSE * 20), 21)
        for engine in (NATIVE, name):
            run = bench.models[engine].simulate(q0, qd0, time, step=step_of(engine, self.step))
            found = astray(bench.system, run)
            if found is not None:
                coordinate, share = found
                goes = "do not go as" if share is None else f"go {share:.3g} times as fast as"
                words = f"in {engine} the positions of {coordinate} {goes} its velocity says"
                place: dict[str, object] = {"term": "position_rates", "at": coordinate}
                return Told(f"{INTEGRATION}: {words}", place, agree=True)
        if (
            self.step is None
            or bench.system.loops
            or bench.system.attachments
            or any(joint.friction for joint in bench.system.joints)
        ):
            return Told(INTEGRATION, {"term": "integration"}, agree=True)
        return self._stepped(bench, name, self.step, q0, qd0)

    def _stepped(self, bench: Bench, name: str, step: float, q0: Array, qd0: Array) -> Told:
        """Which integral of an engine's fixed steps does not get better with smaller ones; its order is its own affair."""
        model, ours = bench.models[name], bench.models[NATIVE]
        duration = min(self.duration, MOST_STEPS * step)

        def run(length: float) -> Trajectory:
            return model.simulate(q0, qd0, np.linspace(0.0, duration, round(duration / length) + 1), step=length)

        def acceleration(q: Array, v: Array) -> Array:
            # The accelerations are one: the native ones are there whatever the engine answers.
            return ours.forward_dynamics(q, v, np.zeros_like(v))

        alone = Told(INTEGRATION, {"term": "integration"}, agree=True)
        try:
            # What differs in so short a part of the run is that part of the limit.
            wrong = broken(
                bench.system, run, acceleration, step, order=1.0, allowed=self.allowed * duration / self.duration
            )
        except (UnsupportedError, EngineError):
            return alone
        if wrong is None:
            return alone
        place: dict[str, object] = {"term": wrong.term, "at": wrong.coordinate}
        return Told(f"{INTEGRATION}: in {name} {wrong.sentence()}", place, agree=True)

    def _lines(self, bench: Bench, name: str, time: Array, signal: dict[str, Array]) -> Iterable[Series]:
        for key, values in signal.items():
            if not np.isfinite(values).all():
                continue
            label = name if len(signal) == 1 else f"{name}: {key}"
            unit = "m" if self.signal.endswith("deflection") else unit_of(bench.system, [key])
            yield Series(
                bench.case.name,
                self.figure,
                label,
                thin(time),
                thin(values),
                "time [s]",
                f"{self.signal.replace('_', ' ')} [{unit}]",
                title=bench.case.title,
                style="line" if name == NATIVE else "dashed",
            )


def initial_state(system: System, position: dict[str, float], velocity: dict[str, float]) -> tuple[Array, Array]:
    """Positions (nq,) and velocities (nv,) by name, others zero or the identity; KeyError for a name the system does not have.

    Where loops close the mechanism, what is not given is what closes them, the nearest to where the file places it.
    """
    q, qd = stated_position(system) if system.loops else neutral_position(system), np.zeros(system.nv)
    for vector, values, known in ((q, position, system.position_names), (qd, velocity, system.coordinate_names)):
        names = list(known)
        for name, value in values.items():
            if name not in names:
                raise KeyError(name)
            vector[names.index(name)] = value
    if system.loops:
        # What is given whole may be rounded: then it is closed without being held.
        held = () if worst(system, opening(system, q)) < 1e-6 else [n for n in position if n in system.coordinate_names]
        q = closed_position(system, q, held=held)
        qd = closed_velocity(system, q, qd, held=[] if len(velocity) == system.nv else list(velocity))
    return q, qd


def pick(trajectory: Trajectory, system: System, signal: str) -> dict[str, Array]:
    """Joint positions by name, or the channels that end in ``.signal``."""
    if signal == "position":
        names = [name for joint in system.joints for name in joint.position_names if name in trajectory.position_names]
        return {name: trajectory.position[:, trajectory.position_names.index(name)] for name in names}
    return {key: values for key, values in trajectory.channels.items() if key.endswith("." + signal)}


def unit_of(system: System, names: list[str]) -> str:
    """rad, or m if every named joint slides."""
    joints = [system.joint(name) for name in names if name in system.joint_names]
    return "m" if joints and all(joint.prismatic for joint in joints) else "rad"
