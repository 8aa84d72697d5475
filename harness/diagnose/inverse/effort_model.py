"""The effort that a hypothesis says was recorded, by inverse dynamics along the smoothed motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.answer.augmented import attached
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Hypothesis, Nominal, nominal_quantities, scaled
from harness.effects.attach import input_chain, sensor_chain
from harness.effects.effect import Effect
from harness.effects.room import STATED
from harness.engines.expressed import express
from harness.system import Attachment, System

Array = NDArray[np.float64]

# Effects whose torque is a function of their own joint's motion and adds to what the mechanism needs; see ``_law``.
LAWS = (
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "joint_stiffness",
    "cubic_stiffness",
    "constant_torque",
    "cogging_torque",
)
# Effects that inverse dynamics along a measured motion can express; the others have a memory or coordinates of their own, which
# need a free run.
KNOWN = (
    *LAWS,
    "payload_mass",
    "added_inertia",
    "com_offset",
    "com_side_offset",
    "base_tilt",
    "sensor_offset",
    "sensor_gain",
    "sensor_delay",
    "sensor_nonlinearity",
    "actuator_gain",
    "actuator_delay",
    "actuator_deadzone",
)
KEPT = 64  # mechanisms whose smoothed torque is kept: a search asks for the same ones again and again
PROBE = 0.05  # of the efforts' size, by which the slope of the input chain is read off


class EffortModel:
    """Residual efforts of hypotheses about one system, along several runs."""

    def __init__(self, system: System, runs: Sequence[EffortRun], deadline: Deadline | None = None) -> None:
        self.deadline = deadline or Deadline()
        self.system = system
        self.runs = tuple(runs)
        self.nominal: tuple[Nominal, ...] = nominal_quantities(system)
        self._kept: dict[Any, tuple[tuple[Attachment, ...], list[tuple[EffortRun, Array]]]] = {}

    def residuals(self, hypothesis: Hypothesis, x: Array) -> list[Array]:
        """Recorded minus predicted effort of every run, (T, n); x: nominal deviations [σ], then effect parameters [SI]."""
        self.deadline.check()
        laws: list[Attachment] = []
        inputs: list[Attachment] = []
        others: list[Attachment] = []
        for member, span in zip(hypothesis.members, self.spans(hypothesis), strict=True):
            own = Attachment(member.effect.name, member.site, member.effect.named(x[span]))
            # Less than the model states of something is another number in the model, and not below nothing.
            less = own.effect in STATED and x[span][0] < 0.0
            kind = laws if own.effect in LAWS and not less else inputs if member.effect.input is not None else others
            kind.append(own)
        attachments, needed = self._needed(x[: len(self.nominal)], others)
        out = []
        for run, (moved, torque) in zip(self.runs, needed, strict=True):
            acting: dict[int, Array] = {}
            for law in laws:
                j = self.system.joint_names.index(law.site)
                acting[j] = acting.get(j, 0.0) + _law(law, moved.q[:, j], moved.qd[:, j], float(run.still[j]))
            if acting:
                torque = torque.copy()
                joints = list(acting)
                torque[:, joints] += run.smooth(np.stack(list(acting.values()), axis=1))
            out.append(self._recorded((*attachments, *inputs), run, torque))
        return out

    def spans(self, hypothesis: Hypothesis) -> list[slice]:
        """Where each member's parameters stand in x."""
        ends = np.cumsum([len(self.nominal), *(member.size for member in hypothesis.members)])
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    def _needed(
        self, nominal: Array, further: Sequence[Attachment]
    ) -> tuple[tuple[Attachment, ...], list[tuple[EffortRun, Array]]]:
        """What acts on sensors and inputs, and of every run the true motion and the smoothed torque that it needs, (T, n)."""
        key = (nominal.tobytes(), tuple((a.effect, a.site, tuple(a.parameters.items())) for a in further))
        if key in self._kept:
            return self._kept[key]
        system = attached(scaled(self.system, self.nominal, list(np.exp(self.system.tolerance * nominal))), further)
        whole = express(system)
        stribeck = {a.site: a.parameters for a in whole.beyond if a.effect == "stribeck_friction"}
        model = Denoc(whole.system)
        joints = [whole.system.joint(name) for name in whole.system.joint_names]
        out = []
        for run in self.runs:
            moved = _true_motion(whole.system, system.attachments, run)
            torque = model.inverse_dynamics_batch(moved.q, moved.qd, moved.qdd)
            if whole.forces.any:
                torque = torque - whole.forces(moved.q, moved.qd)
            for j, joint in enumerate(joints):
                v = moved.qd[:, j]
                level = np.full(len(v), joint.friction)
                extra = stribeck.get(joint.name)
                if extra is not None:
                    level = level + _stribeck(extra, v)
                if np.any(level):
                    torque[:, j] += level * np.tanh(v / run.still[j])
            out.append((moved, run.smooth(torque)))
        while len(self._kept) >= KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = system.attachments, out
        return self._kept[key]

    def _recorded(self, attachments: Sequence[Attachment], run: EffortRun, torque: Array) -> Array:
        """Recorded minus predicted effort: what arrives minus what the motion needs, in units of the record."""
        residual = run.effort - torque
        for j, name in enumerate(self.system.joint_names):
            chain = input_chain(attachments, name)
            if not chain or not run.driven[j]:
                continue

            def arrives(
                effort: Array, chain: tuple[tuple[Effect, Attachment], ...] = chain, run: EffortRun = run
            ) -> Array:
                out = effort[None]
                for effect, attachment in chain:
                    assert effect.input is not None
                    values = effect.values(attachment.parameters)[None]
                    out = effect.input.apply(out.copy(), run.time, values)
                return np.asarray(out[0])

            probe = PROBE * float(np.std(run.raw[:, j])) + 1e-12
            slope = float(np.mean(arrives(run.raw[:, j] + probe) - arrives(run.raw[:, j] - probe))) / (2.0 * probe)
            if abs(slope) < 1e-3:
                slope = 1e-3
            residual[:, j] = (run.smooth(arrives(run.raw[:, j])) - torque[:, j]) / slope
        return residual


def _law(law: Attachment, q: Array, v: Array, still: float) -> Array:
    """Torque that a joint needs beside an effect of its own, shape (T,)."""
    p = law.parameters
    if law.effect == "viscous_damping":
        return np.asarray(p["coefficient"] * v)
    if law.effect == "quadratic_drag":
        return np.asarray(p["coefficient"] * v * np.abs(v))
    if law.effect == "coulomb_friction":
        return np.asarray(p["torque"] * np.tanh(v / still))
    if law.effect == "stribeck_friction":
        return _stribeck(p, v) * np.tanh(v / still)
    if law.effect == "joint_stiffness":
        return np.asarray(p["stiffness"] * (q - p["rest_angle"]))
    if law.effect == "cubic_stiffness":
        return np.asarray(p["stiffness"] * q**3)
    if law.effect == "constant_torque":
        return np.full(len(q), -p["torque"])
    return np.asarray(-p["amplitude"] * np.sin(p["periods"] * q + p["phase"]))


def _stribeck(p: Mapping[str, float], v: Array) -> Array:
    over = max(p["static_torque"] - p["coulomb_torque"], 0.0)
    return np.asarray(p["coulomb_torque"] + over * np.exp(-((v / p["stribeck_velocity"]) ** 2)))


def _true_motion(system: System, attachments: Sequence[Attachment], run: EffortRun) -> EffortRun:
    """The motion behind what the sensors read, to first order in what they do to it."""
    q = run.q
    for j, name in enumerate(system.joint_names):
        chain = sensor_chain(attachments, f"{name}.position")
        if not chain:
            continue
        read = q[:, j][None].copy()
        for effect, attachment in chain:
            assert effect.sensor is not None
            read = effect.sensor.apply(read, run.time, effect.values(attachment.parameters)[None])
        q = q.copy()
        q[:, j] = 2.0 * q[:, j] - read[0]
    return run if q is run.q else run.moved(q)
