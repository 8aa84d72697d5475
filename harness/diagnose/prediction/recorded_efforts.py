"""Recorded efforts as they act on lanes: on the grids of windows, after the effects of the input side, each of them once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.prediction.mechanisms import Mechanisms
from harness.diagnose.problem.drive import Drive
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window
from harness.effects.attach import input_chain
from harness.effects.effect import Effect
from harness.system import Attachment

Array = NDArray[np.float64]
Lanes = Sequence[tuple[int, Window, Array]]

MOST_KEPT = 1000  # efforts on the grids of windows


class RecordedEfforts:
    """Efforts of a problem's runs; those on a window's grid are kept as long as no effect changes them.

    mechanisms: what tells the values of effects from parameter vectors.
    """

    def __init__(self, problem: Problem, mechanisms: Mechanisms) -> None:
        self.problem = problem
        self.mechanisms = mechanisms
        self._drives: dict[tuple[int, int], Drive | None] = {}
        self._signals: dict[tuple[int, int], tuple[Array, Array]] = {}
        self._acting: dict[tuple[int, int, float, float], Array] = {}

    def on(
        self, names: Sequence[str], time: Array, asked: Sequence[tuple[Hypothesis, Array, Lanes]]
    ) -> tuple[Array, NDArray[np.intp]]:
        """Generalized forces on a grid, (E, G, n), and which of them acts on each lane, (B,).

        names: coordinates of the mechanism, n; time: the grid from every window's first sample [s], (G,); asked: hypotheses with
        parameter vectors (K, size) and lanes, one after another.
        """
        forces: list[Array] = []
        known: dict[tuple[int, int, float], int] = {}
        alike: dict[bytes, int] = {}
        source: list[int] = []
        for hypothesis, x, lanes in asked:
            pace = self._pace(hypothesis, x, lanes)
            if any(member.effect.input is not None for member in hypothesis.members):
                for changed in self._changed(names, time, hypothesis, x, lanes, pace):
                    source.append(alike.setdefault(changed.tobytes(), len(forces)))
                    if source[-1] == len(forces):
                        forces.append(changed)
                continue
            for (_, window, _), own in zip(lanes, pace.tolist(), strict=True):
                key = window.run, window.first, own
                if key not in known:
                    known[key] = len(forces)
                    forces.append(self._stated(names, time, *key))
                source.append(known[key])
        return np.array(forces), np.array(source)

    def _pace(self, hypothesis: Hypothesis, x: Array, lanes: Lanes) -> Array:
        """Seconds of the file's clock in one true second, (B,): a clock that is off stamped the efforts as well."""
        pace = np.ones(len(lanes))
        for k, member in enumerate(hypothesis.members):
            if member.effect.sensor is not None and member.effect.sensor.clock:
                pace *= self.mechanisms.effect_values(hypothesis, k, x[[lane for lane, _, _ in lanes]])[:, 0]
        return pace

    def _stated(self, names: Sequence[str], time: Array, run_index: int, first: int, pace: float) -> Array:
        """Efforts of a run from sample ``first`` on as the model states that they act, (G, n)."""
        joints = self.mechanisms.system.joint_names
        key = run_index, first, float(time[1] - time[0]), pace
        found = self._acting.get(key)
        if found is None or len(found) < len(time):
            run = self.problem.runs[run_index]
            when = run.time[first] - run.time[0] + pace * time
            drives = (self._drive(run_index, j) for j in range(len(joints)))
            found = np.array([np.zeros(len(time)) if drive is None else drive.at(when) for drive in drives]).T
            if len(self._acting) > MOST_KEPT:
                self._acting.clear()
            self._acting[key] = found
        out = np.zeros((len(time), len(names)))
        out[:, [names.index(joint) for joint in joints]] = found[: len(time)]
        return out

    def _changed(
        self, names: Sequence[str], time: Array, hypothesis: Hypothesis, x: Array, lanes: Lanes, pace: Array
    ) -> Array:
        """Efforts that effects of the input side change, by every lane's own parameters, (B, G, n)."""
        tau = np.zeros((len(lanes), len(time), len(names)))
        inputs = [(k, m) for k, m in enumerate(hypothesis.members) if m.effect.input is not None]
        inputs.sort(key=lambda item: item[1].effect.input.stage if item[1].effect.input else 0)
        by_run: dict[int, list[int]] = {}
        for lane, (_, window, _) in enumerate(lanes):
            by_run.setdefault(window.run, []).append(lane)
        for j, joint in enumerate(self.mechanisms.system.joint_names):
            own = [(k, m) for k, m in inputs if m.site == joint or m.site.split(".")[0] == joint]
            for run_index, places in by_run.items():
                run, drive = self.problem.runs[run_index], self._drive(run_index, j)
                if drive is None:
                    continue
                stamps = run.time - run.time[0]
                if own:
                    vectors = x[[lanes[i][0] for i in places]]
                    drive = self._by_effects(run_index, j, hypothesis, own, vectors)
                for row, i in enumerate(places):
                    when = stamps[lanes[i][1].first] + pace[i] * time
                    tau[i, :, names.index(joint)] = drive.at(when, row if own else 0)
        return tau

    def _by_effects(
        self, run_index: int, j: int, hypothesis: Hypothesis, own: Sequence[tuple[int, Candidate]], x: Array
    ) -> Drive:
        """A run's effort at joint ``j`` as it acts after effects of the input side with parameter vectors (B, size)."""
        stamps, signal = self._recorded(run_index, j)
        signal = np.broadcast_to(signal, (len(x), len(stamps)))
        for k, member in own:
            assert member.effect.input is not None
            values = self.mechanisms.effect_values(hypothesis, k, x)
            signal = member.effect.input.apply(np.ascontiguousarray(signal), stamps, values)
        return self._acts(run_index, stamps, signal)

    def _recorded(self, run_index: int, j: int) -> tuple[Array, Array]:
        """A run's effort at joint ``j`` after the effects of the input side that the model states, (1, T), and its times (T,).

        A smooth effort is at finer times than the samples: what a law does to it between two of them is seen there.
        """
        if (run_index, j) not in self._signals:
            run = self.problem.runs[run_index]
            assert run.effort is not None
            stamps, signal = run.time - run.time[0], run.effort[None, :, j]
            if not self.problem.held:
                stamps, signal = Drive(run, signal, held=False).finer()
            for effect, attachment in self._stated_laws(j):
                assert effect.input is not None
                fixed = effect.values(attachment.parameters)[None, :]
                signal = effect.input.apply(np.ascontiguousarray(signal), stamps, fixed)
            self._signals[run_index, j] = stamps, signal
        return self._signals[run_index, j]

    def _stated_laws(self, j: int) -> tuple[tuple[Effect, Attachment], ...]:
        """Effects of the input side that the model states at joint ``j``."""
        return input_chain(self.mechanisms.system.attachments, self.mechanisms.system.joint_names[j])

    def _acts(self, run_index: int, stamps: Array, signal: Array) -> Drive:
        held = self.problem.held
        return Drive(self.problem.runs[run_index], signal, held=held, times=None if held else stamps)

    def _drive(self, run_index: int, j: int) -> Drive | None:
        """The same as it acts; None if nothing was recorded to act there."""
        if (run_index, j) not in self._drives:
            run = self.problem.runs[run_index]
            assert run.effort is not None
            drive = None
            if np.any(run.effort[:, j]):
                if self._stated_laws(j):
                    drive = self._acts(run_index, *self._recorded(run_index, j))
                else:
                    drive = Drive(run, run.effort[None, :, j], held=self.problem.held)
            self._drives[run_index, j] = drive
        return self._drives[run_index, j]
