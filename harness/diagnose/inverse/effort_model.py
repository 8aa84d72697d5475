"""The effort that a hypothesis says was recorded, by inverse dynamics along the smoothed motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.answer.augmented import attached
from harness.diagnose.inverse.constants import INPUT_DIFFERENCE, LEAST_SLOPE
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.nominal_torque import NominalRows
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Hypothesis, Nominal, bent_by, nominal_quantities, scaled
from harness.effects.attach import input_chain, sensor_chain
from harness.effects.catalogue import effect
from harness.effects.effect import Effect
from harness.effects.room import STATED
from harness.engines.expressed import Expressed, express
from harness.system import Attachment, System

Array = NDArray[np.float64]

# Effects whose torque is a function of their own joint's motion and adds to what the mechanism needs; see ``law_shapes``.
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
    "link_inertia",
    "imbalance",
    "base_tilt",
    "sensor_offset",
    "sensor_gain",
    "sensor_delay",
    "sensor_nonlinearity",
    "actuator_gain",
    "servo_gain",
    "servo_torque",
    "actuator_delay",
    "actuator_deadzone",
    "actuator_saturation",
)
KEPT = 64  # mechanisms whose smoothed torque is kept: a search asks for the same ones again and again
MOTIONS = 8  # motions behind sensors' errors that are kept


class EffortModel:
    """Residual efforts of hypotheses about one system, along several runs."""

    def __init__(self, system: System, runs: Sequence[EffortRun], deadline: Deadline | None = None) -> None:
        self.deadline = deadline or Deadline()
        self.system = system
        self.runs = tuple(runs)
        self.nominal: tuple[Nominal, ...] = nominal_quantities(system)
        self._kept: dict[Any, list[tuple[EffortRun, Array]]] = {}
        self._motions: dict[Any, list[EffortRun]] = {}
        self._depends: dict[Any, NDArray[np.intp] | None] = {}
        self._added: dict[Any, tuple[Array, Expressed]] = {}

    def recorded(self, runs: Sequence[EffortRun]) -> EffortModel:
        """The same motions with other efforts recorded; torques that are known stay so."""
        other = copy(self)
        other.runs = tuple(replace(run, foretold=own.foretold) for run, own in zip(runs, self.runs, strict=True))
        return other

    @cached_property
    def rows(self) -> NominalRows | None:
        """Parameter rows of the system for any nominal quantities; None for systems that have none."""
        return NominalRows(self.system, self.nominal) if NominalRows.fits(self.system) else None

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
            arrives = member.effect.input is not None and not member.effect.of_servo
            kind = laws if own.effect in LAWS and not less else inputs if arrives else others
            kind.append(own)
        attachments = (*self.system.attachments, *others)
        out = []
        for run, (moved, torque) in zip(self.runs, self.needed(x[: len(self.nominal)], others), strict=True):
            acting: dict[int, Array] = {}
            for law in laws:
                j = self.system.joint_names.index(law.site)
                for name, share, given in law_shapes(law):
                    acting[j] = acting.get(j, 0.0) + share * law_shape(name, given, moved, run, j)
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

    def factor(self, kind: str, name: str, nominal: Array) -> float:
        """By how much a nominal quantity is multiplied at deviations (nominal,) [σ]; 1 for what is none."""
        for k, quantity in enumerate(self.nominal):
            if (quantity.kind, quantity.name) == (kind, name):
                return float(np.exp(quantity.tolerance * nominal[k]))
        return 1.0

    def motion_key(self, further: Sequence[Attachment]) -> tuple[Any, ...]:
        """What tells one true motion from another: the errors of sensors."""
        return tuple(_key(a) for a in further if effect(a.effect).sensor is not None)

    def torque_key(self, nominal: Array, further: Sequence[Attachment]) -> tuple[Any, ...]:
        """What tells one needed torque from another."""
        return nominal.tobytes(), tuple(map(_key, further))

    def moved(self, further: Sequence[Attachment]) -> list[EffortRun]:
        """Of every run the true motion."""
        key = self.motion_key(further)
        if key not in self._motions:
            attachments = (*self.system.attachments, *further)
            while len(self._motions) >= MOTIONS:
                del self._motions[next(iter(self._motions))]
            self._motions[key] = [_true_motion(self.system, attachments, run) for run in self.runs]
        return self._motions[key]

    def needed(self, nominal: Array, further: Sequence[Attachment]) -> list[tuple[EffortRun, Array]]:
        """Of every run the true motion and the smoothed torque that it needs, (T, n)."""
        key = self.torque_key(nominal, further)
        if key not in self._kept:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            moved, torques = self.moved(further), self.torques(nominal, further)
            self._kept[key] = [(m, run.smooth(t)) for m, run, t in zip(moved, self.runs, torques, strict=True)]
        return self._kept[key]

    def torques(self, nominal: Array, further: Sequence[Attachment]) -> list[Array]:
        """Of every run the torque that its true motion needs, before smoothing, (T, n)."""
        model, whole = self._mechanism(nominal, further)
        stribeck = {a.site: a.parameters for a in whole.beyond if a.effect == "stribeck_friction"}
        joints = [whole.system.joint(name) for name in whole.system.joint_names]
        out: list[Array] = []
        for moved in self.moved(further):
            torque = model(moved.q, moved.qd, moved.qdd)
            if whole.forces.any:
                torque = torque - whole.forces(moved.q, moved.qd)
            for j, joint in enumerate(joints):
                level: float | Array = joint.friction
                extra = stribeck.get(joint.name)
                if extra is not None:
                    level = level + _stribeck(extra, moved.qd[:, j])
                if np.any(level):
                    torque[:, j] += level * moved.direction[:, j]
            out.append(torque)
        return out

    def dry(self, run: EffortRun) -> Array:
        """Torque that the system's own dry friction takes along a run, (T, n)."""
        level = np.array([self.system.joint(name).friction for name in self.system.joint_names])
        return np.asarray(level * run.direction)

    def _mechanism(
        self, nominal: Array, further: Sequence[Attachment]
    ) -> tuple[Callable[[Array, Array, Array], Array], Expressed]:
        """Inverse dynamics of the changed system, and what of it they do not hold."""
        factors = bent_by(self.nominal, nominal)
        if self.rows is not None and all(effect(a.effect).sensor is not None for a in further):
            return self.rows.model.with_row(self.rows.row(factors)).inverse_dynamics, self._plain
        dynamic = [a for a in further if effect(a.effect).sensor is None]
        if self.rows is not None and not any(a.effect in STATED for a in dynamic):
            found = self._changed(nominal, factors, dynamic)
            if found is not None:
                row, whole = found
                return self.rows.model.with_row(row).inverse_dynamics, whole
        whole = express(attached(scaled(self.system, self.nominal, list(factors)), further))
        if self.rows is not None and NominalRows.fits(whole.system):
            return self.rows.model.with_row(self.rows.model.lanes.row(whole.system)).inverse_dynamics, whole
        return Denoc(whole.system).inverse_dynamics_batch, whole

    def _changed(self, nominal: Array, factors: Array, dynamic: Sequence[Attachment]) -> tuple[Array, Expressed] | None:
        """Parameter row of a mechanism with effects, and what of it no row holds; None where there is no row of it.

        What an effect adds to a row depends on few nominal quantities, those of its own link as a rule: it is asked for anew only
        where one of them is another.
        """
        assert self.rows is not None
        sites = tuple((a.effect, a.site) for a in dynamic)
        if sites not in self._depends:
            self._depends[sites] = self._dependence(dynamic)
        which = self._depends[sites]
        if which is None:
            return None
        key = (tuple(map(_key, dynamic)), nominal[which].tobytes())
        if key not in self._added:
            found = self._whole_row(factors, dynamic)
            if found is None:
                return None
            while len(self._added) >= KEPT:
                del self._added[next(iter(self._added))]
            self._added[key] = found[0] - self.rows.row(factors), found[1]
        added, whole = self._added[key]
        return self.rows.row(factors) + added, whole

    def _dependence(self, dynamic: Sequence[Attachment]) -> NDArray[np.intp] | None:
        """Which nominal quantities what some effects add to a row depends on; None where there is no row."""
        assert self.rows is not None
        usual = np.exp(0.1 * np.cos(np.arange(len(self.nominal))))
        found = self._whole_row(usual, dynamic)
        if found is None:
            return None
        added = found[0] - self.rows.row(usual)
        size = np.abs(found[0]) + np.abs(added)
        depends = []
        for k in range(len(usual)):
            other = usual.copy()
            other[k] *= 1.3
            changed = self._whole_row(other, dynamic)
            if changed is None:
                return None
            if np.any(np.abs(changed[0] - self.rows.row(other) - added) > 1e-12 * (size + np.abs(changed[0]))):
                depends.append(k)
        return np.array(depends, dtype=np.intp)

    def _whole_row(self, factors: Array, dynamic: Sequence[Attachment]) -> tuple[Array, Expressed] | None:
        """The row of the scaled mechanism with effects, which is made for it."""
        assert self.rows is not None
        whole = express(attached(scaled(self.system, self.nominal, list(factors)), dynamic))
        return (self.rows.model.lanes.row(whole.system), whole) if NominalRows.fits(whole.system) else None

    @cached_property
    def _plain(self) -> Expressed:
        return express(self.system)

    def _recorded(self, attachments: Sequence[Attachment], run: EffortRun, torque: Array) -> Array:
        """Recorded minus predicted effort: what arrives minus what the motion needs, in units of the record."""
        residual = run.effort - torque
        for j, name in enumerate(self.system.joint_names):
            chain = input_chain(attachments, name)
            if chain and run.driven[j]:
                arrived, slope = arriving(chain, run, j)
                residual[:, j] = (run.smooth(arrived) - torque[:, j]) / slope
        return residual


def arriving(chain: Sequence[tuple[Effect, Attachment]], run: EffortRun, j: int) -> tuple[Array, float]:
    """What arrives at a joint of its recorded effort (T,), and how much more does if more is recorded.

    How much of it a dead zone swallows is told by the effort that the motion foretells. The recorded one would know when friction
    turns better than the motion does, and a joint that does little but rub would have a dead zone by that alone: what is explained
    must not explain itself (Söderström and Stoica, Instrumental Variable Methods for System Identification, 1983).
    """

    def arrives(effort: Array) -> Array:
        out = effort
        for acting, attachment in chain:
            assert acting.input is not None
            given = acting.values(attachment.parameters)[None]
            if acting.name == "actuator_deadzone" and run.foretold is not None:
                # By the motion of the same time, however late the effort came to it.
                sent = run.foretold[:, j]
                out = out - (sent - acting.input.apply(sent[None].copy(), run.time, given)[0])
            else:
                out = acting.input.apply(out[None].copy(), run.time, given)[0]
        return np.asarray(out)

    probe = INPUT_DIFFERENCE * float(np.std(run.raw[:, j])) + 1e-12
    slope = float(np.mean(arrives(run.raw[:, j] + probe) - arrives(run.raw[:, j] - probe))) / (2.0 * probe)
    return arrives(run.raw[:, j]), LEAST_SLOPE if abs(slope) < LEAST_SLOPE else slope


def law_shapes(law: Attachment) -> list[tuple[str, float, tuple[float, ...]]]:
    """The shapes that a law's torque is a sum of: name, how much of it, and the numbers that it depends on otherwise."""
    p = law.parameters
    if law.effect == "viscous_damping":
        return [("speed", p["coefficient"], ())]
    if law.effect == "quadratic_drag":
        return [("drag", p["coefficient"], ())]
    if law.effect == "coulomb_friction":
        return [("sign", p["torque"], ())]
    if law.effect == "stribeck_friction":
        over = max(p["static_torque"] - p["coulomb_torque"], 0.0)
        return [("sign", p["coulomb_torque"], ()), ("stiction", over, (p["stribeck_velocity"],))]
    if law.effect == "joint_stiffness":
        return [("angle", p["stiffness"], ()), ("one", -p["stiffness"] * p["rest_angle"], ())]
    if law.effect == "cubic_stiffness":
        return [("cube", p["stiffness"], ())]
    if law.effect == "constant_torque":
        return [("one", -p["torque"], ())]
    share = -p["amplitude"]
    return [
        ("sine", share * np.cos(p["phase"]), (p["periods"],)),
        ("cosine", share * np.sin(p["phase"]), (p["periods"],)),
    ]


def law_shape(name: str, given: tuple[float, ...], moved: EffortRun, run: EffortRun, j: int) -> Array:
    """Torque that a joint needs beside a law of unit size, shape (T,); moved: the true motion of the run."""
    q, v = moved.q[:, j], moved.qd[:, j]
    if name == "speed":
        return v
    if name == "drag":
        return np.asarray(v * np.abs(v))
    if name == "sign":
        return np.asarray(moved.direction[:, j])
    if name == "stiction":
        return np.asarray(np.exp(-((v / given[0]) ** 2)) * moved.direction[:, j])
    if name == "angle":
        return q
    if name == "cube":
        return np.asarray(q**3)
    if name == "one":
        return np.ones(len(q))
    return np.asarray((np.sin if name == "sine" else np.cos)(given[0] * q))


def _key(attachment: Attachment) -> tuple[Any, ...]:
    return attachment.effect, attachment.site, tuple(attachment.parameters.items())


def _stribeck(p: Mapping[str, float], v: Array) -> Array:
    over = max(p["static_torque"] - p["coulomb_torque"], 0.0)
    return np.asarray(p["coulomb_torque"] + over * np.exp(-((v / p["stribeck_velocity"]) ** 2)))


def _true_motion(system: System, attachments: Sequence[Attachment], run: EffortRun) -> EffortRun:
    """The motion behind what the sensors read, by a step of Newton's from it: a gain and an offset are taken back exactly, what is
    not linear or comes late to first order.
    """
    q = run.q
    changed: list[int] = []
    for j, name in enumerate(system.joint_names):
        chain = sensor_chain(attachments, f"{name}.position")
        if not chain:
            continue

        def read(motion: Array, chain: Sequence[tuple[Effect, Attachment]] = chain) -> Array:
            out = motion[None].copy()
            for law, attachment in chain:
                assert law.sensor is not None
                out = law.sensor.apply(out, run.time, law.values(attachment.parameters)[None])
            return np.asarray(out[0])

        seen, own = q[:, j], read(q[:, j])
        step = INPUT_DIFFERENCE * max(float(np.std(seen)), 1e-12)
        slope = (read(seen + step) - own) / step
        q = q.copy()
        q[:, j] = seen + (seen - own) / np.where(np.abs(slope) < LEAST_SLOPE, LEAST_SLOPE, slope)
        changed.append(j)
    return run if q is run.q else run.moved(q, changed)
