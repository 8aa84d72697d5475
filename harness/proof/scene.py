"""A concealed scene: the true rig, what is planted in it, how it is released, driven, sensed and written down."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from harness.proof.rigs import Rig
from harness.proof.truth import RELATIVE_TOLERANCE, Constraint, DryFriction, Hidden, Truth, mechanism_xml

Array = NDArray[np.float64]
Signal = Callable[[Array], Array]

FINE_STEP = 1e-3  # s, grid on which the truth is kept between the integrator and the sensor
ROUGH = 1e-6  # relative tolerance of a step where it is only sought how strong a thing has to be
JUMP = 1e-12  # s, to which the times of held commands are known
ROUNDING = 1e-9  # of a command's time, by which its own instant may come out earlier
LEAD = 0.25  # relative length simulated beyond the last sample, so that a slow clock still finds data


@dataclass(frozen=True)
class Planted:
    """One concealed effect: its name, where it sits, its true parameters (SI)."""

    effect: str
    site: str
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class Sensor:
    """What stands between a true joint angle and the file.

    std: white part of the noise [rad]; colour: AR(1) coefficient of one sample step; step: quantisation [rad], 0 if none;
    jitter: standard deviation of the sampling instant [s], written down truly (``time`` holds the jittered instants).
    """

    rate: float
    std: float
    colour: float = 0.0
    step: float = 0.0
    jitter: float = 0.0


@dataclass(frozen=True)
class Run:
    """One recording: release state, length [s], and the drive as sines (amplitude [N·m], frequency [Hz], phase [rad]).

    held: for how long [s] a command is kept before the next one; 0 if it follows the sines.
    """

    q0: tuple[float, ...]
    v0: tuple[float, ...]
    duration: float
    drive: tuple[tuple[float, float, float], ...] = ()
    held: float = 0.0

    def effort(self, t: Array | float) -> Array:
        """The commanded torque at the first joint [N·m]."""
        amplitudes, rates, phases = self._waves
        when = np.asarray(t, dtype=np.float64)
        if self.held > 0.0:
            when = np.floor(when / self.held + ROUNDING) * self.held
        return np.asarray(np.sin(when[..., None] * rates + phases) @ amplitudes)

    @cached_property
    def _waves(self) -> tuple[Array, Array, Array]:
        """Amplitudes [N·m], angular frequencies [rad/s] and phases [rad] of the drive."""
        amplitudes, frequencies, phases = np.array(self.drive, dtype=np.float64).reshape(-1, 3).T
        return amplitudes, 2 * np.pi * frequencies, phases


@dataclass
class Scene:
    """Built up by planting; ``record`` lets it run.

    segments of ``rig`` may be edited by planting; laws are collected and become the ``Hidden`` of the truth.
    signal: stages between true angle and samples, by joint; command: stages between commanded and acting effort; each turns
    one function of time into another. zeros: of a joint's sensor in every run [rad].
    motions: of mechanisms without hidden laws, by what determines them; scenes with the same
    runs may share them, since effects of sensors do not alter the motion.
    """

    rig: Rig
    runs: Sequence[Run]
    sensor: Sensor
    torques: list[Callable[[float, Array, Array], Array]] = field(default_factory=list)
    dry: list[DryFriction] = field(default_factory=list)
    states: list[tuple[int, Callable[..., Array], Callable[..., Array]]] = field(default_factory=list)
    gravity: Callable[[float], Array] | None = None
    edit: Callable | None = None
    constraint: tuple[int, Constraint] | None = None
    breaks: list[float] = field(default_factory=list)
    kicks: dict[float, Callable[[Array, Array], tuple[Array, Array]]] = field(default_factory=dict)
    inserts: dict[int, str] = field(default_factory=dict)
    base: str = ""
    extra: dict[int, str] = field(default_factory=dict)
    splits: dict[int, list[tuple[float, str]]] = field(default_factory=dict)
    signal: dict[str, list[Callable[[Signal], Signal]]] = field(default_factory=dict)
    zeros: dict[str, Sequence[float]] = field(default_factory=dict)
    command: list[Callable[[Signal], Signal]] = field(default_factory=list)
    motions: dict[tuple[object, ...], tuple[Array, Array]] = field(default_factory=dict)

    def edit_segment(self, k: int, **changes: Any) -> None:
        """Replace data of one segment of the true rig."""
        segments = list(self.rig.segments)
        segments[k] = replace(segments[k], **changes)
        self.rig = replace(self.rig, segments=tuple(segments))

    def std(self, column: str) -> float:
        """White noise of a channel [rad]."""
        return self.sensor.std

    def truth(self) -> Truth:
        """The mechanism as planted so far."""
        hidden = Hidden(
            torques=tuple(self.torques),
            dry=tuple(self.dry),
            states=tuple(self.states),
            gravity=self.gravity,
            edit=self.edit,
            breaks=tuple(self.breaks),
            kicks=dict(self.kicks),
            constraint=self.constraint,
        )
        xml = mechanism_xml(self.rig, inserts=self.inserts, base=self.base, extra=self.extra, splits=self.splits)
        return Truth(xml, hidden)

    def dof(self, joint: str) -> int:
        """Index of the joint's degree of freedom in the true mechanism (a moving base and inserted hinges come between)."""
        order: list[str] = ["base"] if self.base else []
        for k, s in enumerate(self.rig.segments):
            order.append(s.joint)
            if k in self.inserts:
                order.append(f"{s.joint}_inserted")
            if k in self.splits:
                order += [f"{s.joint}_bend{i}" for i in range(len(self.splits[k]))]
            if k in self.extra and "<joint" in self.extra[k]:
                order.append(f"{s.joint}_extra")
        return order.index(joint)

    def record(self, index: int, instants: Array | None = None, *, roughly: bool = False) -> dict[str, Array]:
        """Noise-free samples of one run: ``time``, ``<joint>.position`` and, if driven, ``<joint>.effort`` as commanded.

        roughly: to a ten thousandth of what shows, to find out how strong a thing has to be.
        """
        run = self.runs[index]
        truth = self.truth()
        q0, v0 = np.zeros(truth.n), np.zeros(truth.n)
        for k, joint in enumerate(self.rig.joints):
            q0[truth.dof[joint]] = run.q0[k]
            v0[truth.dof[joint]] = run.v0[k]
        if instants is None:
            instants = np.arange(0.0, run.duration, 1.0 / self.sensor.rate)
        fine = np.arange(0.0, run.duration * (1.0 + (LEAD if self.signal else 0.0)) + 2 * FINE_STEP, FINE_STEP)
        effort, jumps = None, np.zeros(0)
        if run.drive:
            acting: Signal = run.effort
            for stage in self.command:
                acting = stage(acting)
            if run.held > 0.0:
                jumps = _jumps(acting, float(fine[-1]), run.held)
            first = truth.dof[self.rig.joints[0]]

            def effort(t: Array | float) -> Array:
                force = np.zeros((*np.shape(t), truth.n))
                force[..., first] = acting(np.asarray(t))
                return force

        key = (truth.xml, index, run.held, len(fine), q0.tobytes(), v0.tobytes())
        if truth.hidden != Hidden() or self.command:
            tolerance = ROUGH if roughly else RELATIVE_TOLERANCE
            q, v = truth.release(q0, v0, fine, effort=effort, jumps=jumps, tolerance=tolerance)
        else:
            if key not in self.motions:
                self.motions[key] = truth.release(q0, v0, fine, effort=effort, jumps=jumps)
            q, v = self.motions[key]
        out = {"time": instants}
        for joint in self.rig.joints:
            j = truth.dof[joint]
            signal: Signal = CubicHermiteSpline(fine, q[:, j], v[:, j])
            for stage in self.signal.get(joint, ()):
                signal = stage(signal)
            out[f"{joint}.position"] = signal(instants) + (self.zeros[joint][index] if joint in self.zeros else 0.0)
        if run.drive:
            out[f"{self.rig.joints[0]}.effort"] = np.asarray(run.effort(instants))
        return out


def _jumps(acting: Signal, end: float, held: float) -> Array:
    """Times [s] up to ``end`` where a signal changes that is constant for about ``held`` at a time."""
    grid = np.arange(0.0, end + held, held / 4.0)
    values = acting(grid)
    changes = np.flatnonzero(np.diff(values))
    before, after = grid[changes], grid[changes + 1]
    while np.max(after - before, initial=0.0) > JUMP:
        middle = 0.5 * (before + after)
        early = acting(middle) == values[changes]
        before, after = np.where(early, middle, before), np.where(early, after, middle)
    return after
