"""The effort that a hypothesis says was recorded, by inverse dynamics along the smoothed motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.answer.augmented import attached
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Hypothesis, Nominal, nominal_quantities, scaled
from harness.effects.attach import input_chain, sensor_chain
from harness.effects.effect import Effect
from harness.engines.expressed import express
from harness.system import Attachment, System

Array = NDArray[np.float64]

# Effects that inverse dynamics along a measured motion can express; the others have a memory or coordinates of their own, which
# need a free run.
KNOWN = (
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "joint_stiffness",
    "cubic_stiffness",
    "constant_torque",
    "cogging_torque",
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
PROBE = 0.05  # of the efforts' size, by which the slope of the input chain is read off


class EffortModel:
    """Residual efforts of hypotheses about one system, along several runs."""

    def __init__(self, system: System, runs: Sequence[EffortRun], deadline: Deadline | None = None) -> None:
        self.deadline = deadline or Deadline()
        self.system = system
        self.runs = tuple(runs)
        self.nominal: tuple[Nominal, ...] = nominal_quantities(system)

    def residuals(self, hypothesis: Hypothesis, x: Array) -> list[Array]:
        """Recorded minus predicted effort of every run, (T, n); x: nominal deviations [σ], then effect parameters [SI]."""
        self.deadline.check()
        factors = np.exp(self.system.tolerance * x[: len(self.nominal)])
        system = scaled(self.system, self.nominal, list(factors))
        at = len(self.nominal)
        own = []
        for member in hypothesis.members:
            own.append(Attachment(member.effect.name, member.site, member.effect.named(x[at : at + member.size])))
            at += member.size
        system = attached(system, own)
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
                    over = max(extra["static_torque"] - extra["coulomb_torque"], 0.0)
                    level = level + extra["coulomb_torque"] + over * np.exp(-((v / extra["stribeck_velocity"]) ** 2))
                if np.any(level):
                    torque[:, j] += level * np.tanh(v / run.still[j])
            out.append(self._recorded(system.attachments, run, run.smooth(torque)))
        return out

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
