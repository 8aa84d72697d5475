"""Whitened residual efforts of many hypotheses, put together of parts that are computed once.

Smoothing, taking samples and whitening are linear, and so are most torques in their numbers: what a law of unit size, a product
of nominal factors and the recorded effort leave in the rows is kept, and a hypothesis is a sum of such columns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.inverse.constants import NOISE_LAGS, SAME_TORQUE
from harness.diagnose.inverse.effort_model import LAWS, EffortModel, arriving, law_shape, law_shapes
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_noise import EffortNoise, Grid
from harness.diagnose.problem.hypothesis import Hypothesis, bent_by
from harness.effects.attach import input_chain
from harness.effects.room import STATED
from harness.system import Attachment

Array = NDArray[np.float64]

COLUMNS = 4000  # that are kept
AT_ONCE = 16  # torques smoothed together
DENSE = 1_000_000  # numbers in a table of what every sample compared takes of the others, beyond which whole signals are smoothed


@dataclass(frozen=True, eq=False)
class _Place:
    """Where a run's samples go. samples: indices (N,); begins: those too near a stretch's beginning to be whitened, (N,).

    sure: by which rows are multiplied where dry friction's direction is unsure, of all joints, (N, n).
    joints: driven ones (J,); order: of the rows, in an array (N, J) of samples; first: of the run's rows among all.
    """

    run: EffortRun
    samples: NDArray[np.intp]
    begins: NDArray[np.bool_]
    sure: Array
    joints: NDArray[np.intp]
    order: NDArray[np.intp]
    first: int

    @cached_property
    def _table(self) -> Array | None:
        small = len(self.samples) * len(self.run.time) <= DENSE
        return self.run.smooth_at(self.samples) if small else None

    def smooth(self, values: Array) -> Array:
        """Signals (T, …) through the low-pass, at the samples, (N, …)."""
        return self.run.smooth(values)[self.samples] if self._table is None else np.asarray(self._table @ values)


class Whitened:
    """Whitened rows of hypotheses about the efforts of a model's runs.

    clusters: of which stretch each row is, (rows,). which: of which joint, (rows,). weights: by which rows are multiplied where
    dry friction's direction is unsure, (rows,): the more it may be off beside the noise, the less a row tells.
    """

    def __init__(self, model: EffortModel, grids: Sequence[Grid], noises: Sequence[EffortNoise]) -> None:
        self.model = model
        self._ahead = np.array([noise.ahead for noise in noises])
        self._innovation = np.array([noise.innovation for noise in noises])
        self._std = np.array([noise.std for noise in noises])
        dry = np.array([noise.dry for noise in noises])
        self._places: list[_Place] = []
        clusters: list[NDArray[np.intp]] = []
        count = 0
        for run, grid in zip(model.runs, grids, strict=True):
            joints = np.flatnonzero(run.driven)
            order, begins = [], []
            at = 0
            for stretch in grid.stretches:
                inside = np.arange(at, at + len(stretch))
                order.append((inside[None, :] * len(joints) + np.arange(len(joints))[:, None]).ravel())
                begins.append(np.arange(len(stretch)) < NOISE_LAGS)
                clusters.append(np.full(len(stretch) * len(joints), len(clusters)))
                at += len(stretch)
            samples = np.concatenate(grid.stretches) if grid.stretches else np.zeros(0, dtype=np.intp)
            first = np.concatenate(begins) if begins else np.zeros(0, dtype=bool)
            self._places.append(
                _Place(
                    run,
                    samples,
                    first,
                    self._sure(np.abs(dry * run.unsure[samples]), first),
                    joints,
                    np.concatenate(order) if order else np.zeros(0, dtype=np.intp),
                    count,
                )
            )
            count += at * len(joints)
        self.clusters = np.concatenate(clusters) if clusters else np.zeros(0, dtype=np.intp)
        self.count = count
        self.which = np.zeros(count, dtype=np.intp)  # of the joints, each row is of
        for place in self._places:
            order_joints = np.tile(place.joints, len(place.samples))[place.order]
            self.which[place.first : place.first + len(place.order)] = order_joints
        self._kept: dict[Any, Any] = {}
        self._late = self._all([run.late * dry for run in model.runs], smoothed=True)
        power = np.bincount(self.which, self._late**2, len(noises))
        # The inverse square root of 1 + u u', applied to rows: u (1 - (1 + u'u)^-½) / u'u is taken of u.
        self._taken = (1.0 - 1.0 / np.sqrt(1.0 + power)) / np.maximum(power, 1e-300)
        self.weights = np.concatenate(
            [place.sure[:, place.joints].ravel()[place.order] for place in self._places] or [np.zeros(0)]
        )

    def _sure(self, off: Array, begins: NDArray[np.bool_]) -> Array:
        """One over the standard deviation of rows beside samples that may be off by so much, (N, n), the noise's being one."""
        whole = off.copy()
        for lag in range(1, NOISE_LAGS + 1):
            whole[lag:] += np.abs(self._ahead[:, lag - 1]) * off[:-lag]
        whole /= self._innovation
        whole[begins] = off[begins] / self._std
        return np.asarray(1.0 / np.sqrt(1.0 + whole**2))

    def recorded(self, model: EffortModel) -> Whitened:
        """The same columns beside other efforts, those of a model with the same motions."""
        other = copy(self)
        other.model = model
        other._kept = {key: value for key, value in self._kept.items() if key[0] not in ("effort", "arrives")}
        return other

    def rows(self, hypothesis: Hypothesis, x: Array) -> Array:
        """Whitened residuals; x: nominal deviations [σ], then effect parameters [SI]."""
        model = self.model
        model.deadline.check()
        laws: list[Attachment] = []
        less: list[Attachment] = []
        inputs: list[Attachment] = []
        others: list[Attachment] = []
        for member, span in zip(hypothesis.members, model.spans(hypothesis), strict=True):
            own = Attachment(member.effect.name, member.site, member.effect.named(x[span]))
            if own.effect in STATED and x[span][0] < 0.0:
                less.append(own)
            elif own.effect in LAWS:
                laws.append(own)
            else:
                # A servo's gain acts on what arrives and on what the mechanism needs.
                if member.effect.input is not None:
                    inputs.append(own)
                if member.effect.input is None or member.effect.of_servo:
                    others.append(own)
        nominal = x[: len(model.nominal)]
        torque = self._torque(nominal, others)
        motion = model.motion_key(others)
        for law in laws:
            for name, share, given in law_shapes(law):
                self._add(torque, self._law(name, law.site, given, motion, others), share)
        for one in less:
            # Less than the model states, down to nothing.
            field = STATED[one.effect]
            stated = float(getattr(model.system.joint(one.site), field)) * model.factor(field, one.site, nominal)
            share = max(stated + next(iter(one.parameters.values())), 0.0) - stated
            name = next(n for n, _, _ in law_shapes(one))
            self._add(torque, self._law(name, one.site, (), motion, others), share)
        effort, slope = self._effort(inputs)
        rows = effort - torque
        return self._turning(rows if slope is None else rows / slope)

    def law_change(
        self, law: Attachment, other: Attachment, inputs: Sequence[Attachment], others: Sequence[Attachment]
    ) -> Array:
        """Whitened residuals with a law's other numbers less those with its first, (rows,).

        law, other: the same effect at the same joint. inputs, others: what acts on the efforts, and beside laws and that.
        """
        change = np.zeros(self.count)
        motion = self.model.motion_key(others)
        for one, sign in ((law, 1.0), (other, -1.0)):
            for name, share, given in law_shapes(one):
                self._add(change, self._law(name, one.site, given, motion, others), sign * share)
        _, slope = self._effort(inputs)
        return self._turning(change if slope is None else change / slope)

    def of_force(self, joint: int, forces: Sequence[Array]) -> Array:
        """What a force at a joint, (T,) of every run, adds to the rows, (rows,)."""
        signals = []
        for run, force in zip(self.model.runs, forces, strict=True):
            signal = np.zeros_like(run.q)
            signal[:, joint] = force
            signals.append(signal)
        return self._turning(self._all(signals))

    def _turning(self, rows: Array) -> Array:
        """Rows less what joints that turn late or early, every time alike, may have put into them."""
        share = np.bincount(self.which, self._late * rows, len(self._taken)) * self._taken
        return np.asarray(rows - share[self.which] * self._late)

    def _torque(self, nominal: Array, others: Sequence[Attachment]) -> Array:
        """Whitened torque that the motions need without laws of the hypothesis; the caller's to write to."""
        model = self.model
        if not others and self._products is not None:
            products, columns = self._products
            return np.asarray(columns @ products(nominal))
        key = ("torque", model.torque_key(nominal, others))
        if key not in self._kept:
            self._keep(key, self._all(model.torques(nominal, others)))
        return np.array(self._kept[key])

    @cached_property
    def _products(self) -> tuple[Callable[[Array], Array], Array] | None:
        """Factors' products of nominal deviations, and the column of each; None where that is not what torques are."""
        model = self.model
        rows = model.rows
        if rows is None or not self.count:
            return None
        terms = rows.terms()
        parts = np.empty((self.count, len(terms.rows)))
        for place, run in zip(self._places, model.runs, strict=True):
            here = slice(place.first, place.first + len(place.order))
            for first in range(0, len(terms.rows), AT_ONCE):
                several = terms.rows[first : first + AT_ONCE]
                torques = np.concatenate(
                    [rows.model.with_row(r).inverse_dynamics(run.q, run.qd, run.qdd) for r in several], axis=1
                )
                smooth = place.smooth(torques)
                for k in range(len(several)):
                    part = smooth[:, k * run.q.shape[1] : (k + 1) * run.q.shape[1]]
                    parts[here, first + k] = self._whitened(place, part[:, place.joints])
        columns = parts @ terms.weights.T
        whole = np.abs(columns).max()
        used = np.abs(columns).max(axis=0) > 1e-15 * whole
        columns = np.ascontiguousarray(columns[:, used])
        factors = terms.factors[used]
        dry = self._all([model.dry(run) for run in model.runs])
        columns = np.column_stack([columns, dry])

        def products(nominal: Array) -> Array:
            f = np.append(bent_by(model.nominal, nominal), 1.0)
            return np.append(np.prod(f[factors], axis=1), 1.0)

        tried = np.linspace(-2.0, 2.0, len(model.nominal))
        there = self._all(model.torques(tried, ()))
        close = np.abs(columns @ products(tried) - there).max() <= SAME_TORQUE * np.abs(there).max()
        return (products, columns) if close else None

    def _law(
        self, name: str, site: str, given: tuple[float, ...], motion: Any, others: Sequence[Attachment]
    ) -> list[tuple[slice | NDArray[np.intp], Array]]:
        """Rows of a joint that a law of unit size takes part in, run by run, and what it adds to them."""
        key = (name, site, given, motion)
        if key not in self._kept:
            model = self.model
            j = model.system.joint_names.index(site)
            out = []
            for place, run, moved in zip(self._places, model.runs, model.moved(others), strict=True):
                if not run.driven[j]:
                    continue
                shape = place.smooth(law_shape(name, given, moved, run, j))
                column = int(np.flatnonzero(place.joints == j)[0])
                mine = np.flatnonzero(place.order % len(place.joints) == column)
                out.append((place.first + mine, self._filtered(place, j, shape)))
            self._keep(key, out)
        return list(self._kept[key])

    @staticmethod
    def _add(rows: Array, shapes: Sequence[tuple[Any, Array]], share: float) -> None:
        for which, values in shapes:
            rows[which] += share * values

    def _effort(self, inputs: Sequence[Attachment]) -> tuple[Array, Array | None]:
        """Whitened efforts as they arrive, and where they arrive changed the slope by which residuals are divided, (rows,)."""
        model = self.model
        if ("effort",) not in self._kept:
            self._kept["effort",] = self._all([run.effort for run in model.runs], smoothed=True)
        attachments = (*model.system.attachments, *inputs)
        effort, slopes = self._kept["effort",], None
        for j, name in enumerate(model.system.joint_names):
            chain = input_chain(attachments, name)
            if not chain:
                continue
            key = ("arrives", j, tuple((e.name, tuple(a.parameters.items())) for e, a in chain))
            if key not in self._kept:
                out = []
                for place, run in zip(self._places, model.runs, strict=True):
                    if run.driven[j]:
                        values, slope = arriving(chain, run, j)
                        mine = np.flatnonzero(self.which[place.first : place.first + len(place.order)] == j)
                        out.append((place.first + mine, self._filtered(place, j, place.smooth(values)), slope))
                self._keep(key, out)
            if slopes is None:
                effort, slopes = effort.copy(), np.ones(self.count)
            for which, values, slope in self._kept[key]:
                effort[which], slopes[which] = values, slope
        return effort, slopes

    def _keep(self, key: Any, value: Any) -> None:
        while len(self._kept) >= COLUMNS:
            del self._kept[next(k for k in self._kept if k != ("effort",))]
        self._kept[key] = value

    def _all(self, values: Sequence[Array], *, smoothed: bool = False) -> Array:
        """Whitened rows of signals (T, n), one a run, smoothed first where they are not yet."""
        parts = []
        for place, one in zip(self._places, values, strict=True):
            driven = one[:, place.joints]
            parts.append(self._whitened(place, driven[place.samples] if smoothed else place.smooth(driven)))
        return np.concatenate(parts) if parts else np.zeros(0)

    def _whitened(self, place: _Place, seen: Array) -> Array:
        """Whitened rows of one run's samples (N, J)."""
        return np.asarray(self._filtered(place, place.joints, seen).ravel()[place.order])

    def _filtered(self, place: _Place, joints: NDArray[np.intp] | int, seen: Array) -> Array:
        """Samples of some joints (N, J), or of one (N,), less what those before them tell, in units of what they do not."""
        out = seen.copy()
        for lag in range(1, NOISE_LAGS + 1):
            out[lag:] -= self._ahead[joints, lag - 1] * seen[:-lag]
        out /= self._innovation[joints]
        out[place.begins] = seen[place.begins] / self._std[joints]
        return np.asarray(out * place.sure[:, joints])
