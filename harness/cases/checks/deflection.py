"""A flexible mechanism's motion in the native engine against finite elements: deflection, joint angle, vibration."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from harness.cases.beam_shapes import told_shapes
from harness.cases.case import NATIVE, Array, Bench, Row, Series, thin
from harness.cases.checks.beam_blame import by_motion
from harness.cases.checks.trajectory import initial_state
from harness.compare.spectrum import lines, spectrum
from harness.engines.exudyn_planar import PlanarBeamModel
from harness.errors import UnsupportedError
from harness.system import System, Trajectory

DEFLECTION = ".tip_deflection"


@dataclass(frozen=True)
class Accuracy:
    """How near the native engine has to come with a number of modes on each beam.

    modes: None leaves them as the system has them. tip: RMS of the tip deflection's difference as a share of its peak.
    angle: largest difference of a joint's position [rad]. frequency: of the strongest vibration [Hz], None if the run
    is too short to tell.
    """

    modes: int | None
    tip: float
    angle: float
    why: str
    frequency: float | None = None


@dataclass(frozen=True)
class DeflectionAgreement:
    """Tip deflections, joint angles and vibration of one motion, native against one engine of finite elements.

    peer: name of that engine; it runs once, the native engine once for each accuracy and each of ``also_modes`` (drawn
    as convergence, not judged). elements: on each of the peer's beams, None for its default. position: initial state
    by coordinate name [rad]. duration [s], rate [Hz] of the samples; step: the peer's [s]. band: where the vibration
    is looked for [Hz].
    """

    peer: str
    accuracies: tuple[Accuracy, ...]
    position: tuple[tuple[str, float], ...]
    duration: float = 2.0
    rate: float = 1000.0
    step: float | None = None
    elements: int | None = None
    band: tuple[float, float] = (5.0, 500.0)
    also_modes: tuple[int, ...] = ()
    quantity: str = "motion"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        if self.peer not in bench.models or NATIVE not in bench.models:
            return
        time = np.linspace(0.0, self.duration, round(self.duration * self.rate) + 1)
        theirs = self._finite_elements(bench, time)
        for label in _deflections(theirs):
            yield self._line(bench, "tip_deflection", f"{self.peer}: {label}", time, theirs.channels[label], "dashed")
            yield self._spectrum(bench, f"{self.peer}: {label}", time, theirs.channels[label], "dashed")
        errors: dict[int, float] = {}
        for k, accuracy in enumerate(self.accuracies):
            system = bench.system if accuracy.modes is None else with_modes(bench.system, accuracy.modes)
            modes = _modes(system)
            try:
                ours = self._native(bench, system, time)
            except UnsupportedError as reason:
                yield bench.skipped(self.quantity, (NATIVE, self.peer), str(reason))
                return
            errors[modes] = tip_difference(ours, theirs)[0]
            yield from self._rows(bench, system, accuracy, modes, time, ours, theirs)
            if k == len(self.accuracies) - 1:
                for label in _deflections(theirs):
                    signal = ours.channels[label]
                    yield self._line(bench, "tip_deflection", f"{NATIVE}: {label}", time, signal, "line")
                    yield self._spectrum(bench, f"{NATIVE}: {label}", time, signal, "line")
        for modes in self.also_modes:
            if modes not in errors:
                ours = self._native(bench, with_modes(bench.system, modes), time)
                errors[modes] = tip_difference(ours, theirs)[0]
        if len(errors) > 1:
            yield Series(
                bench.case.name,
                "convergence",
                f"{NATIVE} against {self.peer}",
                tuple(float(modes) for modes in sorted(errors)),
                tuple(errors[modes] for modes in sorted(errors)),
                "modes on each beam",
                "RMS of tip deflection over its peak",
                title=bench.case.title,
                style="points",
                log="y",
            )

    def _finite_elements(self, bench: Bench, time: Array) -> Trajectory:
        model = bench.models[self.peer]
        if self.elements is not None:
            assert isinstance(model, PlanarBeamModel)
            model = replace(model, elements=self.elements)
        q0, qd0 = initial_state(bench.system, dict(self.position), {})
        return model.simulate(q0, qd0, time, step=self.step)

    def _native(self, bench: Bench, system: System, time: Array) -> Trajectory:
        model = bench.models[NATIVE] if system is bench.system else bench.build(NATIVE, system)
        q0, qd0 = initial_state(system, dict(self.position), {})
        return model.simulate(q0, qd0, time, step=None)

    def _rows(
        self,
        bench: Bench,
        system: System,
        accuracy: Accuracy,
        modes: int,
        time: Array,
        ours: Trajectory,
        theirs: Trajectory,
    ) -> Iterable[Row]:
        engines = (NATIVE, self.peer)
        blame = self._blame(bench, system, accuracy, time, ours, theirs)
        count = f"{modes}_mode" + ("s" if modes > 1 else "")
        share, where = tip_difference(ours, theirs)
        yield bench.row(
            f"tip_deflection_{count}",
            engines,
            share,
            accuracy.tip,
            why=accuracy.why,
            note="; ".join(
                [
                    f"RMS over {self.duration:g} s as a share of the peak, worst at {where}",
                    *told_shapes(bench.system),
                    *([blame[0]] if not share <= accuracy.tip else []),
                ]
            ),
            first_divergence=(_first(time, ours, theirs, 3.0 * accuracy.tip) or {}) | blame[1]
            if not share <= accuracy.tip
            else None,
        )
        angle, joint = angle_difference(ours, theirs, bench.system)
        yield bench.row(
            f"joint_angle_{count}",
            engines,
            angle,
            accuracy.angle,
            unit="rad",
            why=accuracy.why,
            note="; ".join(
                [f"largest over {self.duration:g} s, at {joint}", *([blame[0]] if not angle <= accuracy.angle else [])]
            ),
            first_divergence={"signal": joint} | blame[1] if not angle <= accuracy.angle else None,
        )
        if accuracy.frequency is None:
            return
        for label in _deflections(theirs):
            pair = [lines(time, run.channels[label], band=self.band, most=1) for run in (ours, theirs)]
            if not all(pair):
                yield bench.row(
                    f"vibration_{count}",
                    engines,
                    np.nan,
                    accuracy.frequency,
                    unit="Hz",
                    why=accuracy.why,
                    note="no line",
                )
                continue
            one, other = pair[0][0], pair[1][0]
            yield bench.row(
                f"vibration_{count}" if len(_deflections(theirs)) == 1 else f"vibration_{label.split('.')[0]}_{count}",
                engines,
                abs(one.frequency - other.frequency),
                accuracy.frequency,
                unit="Hz",
                why=accuracy.why,
                note=f"{one.frequency:.4f} Hz against {other.frequency:.4f} Hz, strongest line of {label}",
            )

    def _blame(
        self, bench: Bench, system: System, accuracy: Accuracy, time: Array, ours: Trajectory, theirs: Trajectory
    ) -> tuple[str, dict[str, object]]:
        """What number of the description the difference of the two motions would come of; nothing where they agree."""
        share, angle = tip_difference(ours, theirs)[0], angle_difference(ours, theirs, bench.system)[0]
        if share <= accuracy.tip and angle <= accuracy.angle:
            return "", {}
        labels = _deflections(theirs)
        peaks = {label: float(np.abs(theirs.channels[label]).max()) for label in labels}

        def flat(run: Trajectory) -> Array:
            # Deflections count as shares of their peaks, angles by what is allowed of them.
            angles = [run.position[:, run.names.index(name)] for name in bench.system.joint_names]
            bent = [accuracy.angle / accuracy.tip / peaks[label] * run.channels[label] for label in labels]
            return np.concatenate([*angles, *bent])

        # The first part of the motion: later on its difference is no more in proportion to its cause.
        part = time[: max(8, len(time) // 4)]
        base = flat(ours)
        few = np.concatenate([np.arange(len(time)) < len(part)] * (len(base) // len(time)))
        said, place = by_motion(
            system,
            self.peer,
            lambda of: flat(self._native(bench, of, part)) if of is not system else base[few],
            (flat(theirs) - base)[few],
        )
        if place is None and angle <= accuracy.angle:
            # What the joints feel of the beams is right.
            label = tip_difference(ours, theirs)[1]
            said = "the joints move alike, so it is how the deflection is read, or to which side a beam bends"
            return said, {"term": DEFLECTION.lstrip("."), "link": label.removesuffix(DEFLECTION)}
        return said, place or {}

    def _line(self, bench: Bench, figure: str, label: str, time: Array, values: Array, style: str) -> Series:
        return Series(
            bench.case.name,
            figure,
            label,
            thin(time, 1000),
            thin(values, 1000),
            "time [s]",
            "tip deflection [m]",
            title=bench.case.title,
            style=style,
        )

    def _spectrum(self, bench: Bench, label: str, time: Array, values: Array, style: str) -> Series:
        found = spectrum(time, values)
        inside = (found.frequency > 0.0) & (found.frequency <= self.band[1])
        return Series(
            bench.case.name,
            "spectrum",
            label,
            thin(found.frequency[inside], 2000),
            thin(found.amplitude[inside], 2000),
            "frequency [Hz]",
            "amplitude [m]",
            title=bench.case.title,
            style=style,
            log="y",
        )


def with_modes(system: System, modes: int) -> System:
    """The system with that many modes in each bending plane of every beam."""
    for link in system.links:
        if link.beam is not None:
            system = system.replace_link(replace(link, beam=replace(link.beam, modes=modes)))
    return system


def _modes(system: System) -> int:
    return max(link.beam.modes for link in system.links if link.beam is not None)


def _deflections(run: Trajectory) -> list[str]:
    return [label for label in run.channels if label.endswith(DEFLECTION)]


def tip_difference(ours: Trajectory, theirs: Trajectory) -> tuple[float, str]:
    """Worst RMS difference of a tip deflection as a share of its peak, and its channel."""
    worst, where = -1.0, ""
    for label in _deflections(theirs):
        apart = ours.channels[label] - theirs.channels[label]
        share = float(np.sqrt(np.mean(apart**2)) / np.abs(theirs.channels[label]).max())
        if not share <= worst:
            worst, where = share, label
    return worst, where


def angle_difference(ours: Trajectory, theirs: Trajectory, system: System) -> tuple[float, str]:
    """Largest difference of a joint's position [rad], and the joint."""
    worst, where = -1.0, ""
    for name in system.joint_names:
        apart = ours.position[:, ours.names.index(name)] - theirs.position[:, theirs.names.index(name)]
        largest = float(np.abs(apart).max())
        if not largest <= worst:
            worst, where = largest, name
    return worst, where


def _first(time: Array, ours: Trajectory, theirs: Trajectory, share: float) -> dict[str, object] | None:
    """Where a tip deflection first differs by more than ``share`` of its peak."""
    found: dict[str, object] | None = None
    earliest = np.inf
    for label in _deflections(theirs):
        apart = np.abs(ours.channels[label] - theirs.channels[label])
        beyond = np.flatnonzero(~(apart <= share * np.abs(theirs.channels[label]).max()))
        if len(beyond) and time[beyond[0]] < earliest:
            earliest = float(time[beyond[0]])
            found = {"time": earliest, "signal": label}
    return found
