"""Friction whose level differs from recording to recording: one factor each, beside laws that they share.

Bearings warm up, grease moves, dust wanders: dry friction measured minutes apart differs by a tenth or two while its law stays
the same, and viscous damping by half. Fitted with one level, recordings disagree, and the disagreement pulls every other parameter.
Here the laws attached to a system, its nominal quantities and every recording's initial state are fitted together with a factor on
one kind of friction of every recording but the last, whose level is what the next recording is predicted with.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.denoc.lanes.model import LaneModel
from harness.diagnose.levels.constants import (
    ENOUGH_REFIT_GAIN,
    FEWEST_FREE_SAMPLES,
    FIRST_RESIDUAL,
    FIRST_STATE_TIME,
    GRADIENT_BLOCKS,
    LEVEL_FIT_DIFFERENCE,
    MOST_LEVEL_EVALUATIONS,
    MOST_REFITS,
    SHORTEST_DAHL_WAY,
    START_ERROR,
    THINNED_RATE,
)
from harness.diagnose.levels.kinds import DRY, Kind
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Candidate, bent_by, nominal_quantities, scaled
from harness.effects.attach import apply, sensor_chain
from harness.effects.catalogue import effect
from harness.effects.lanes import lane_model, lane_row
from harness.effects.room import with_room
from harness.effects.scale import references
from harness.errors import InputError, UnsupportedError
from harness.recording.recording import Recording
from harness.system import Attachment, System

Array = NDArray[np.float64]

WHOLE = ("periods",)  # parameters that are whole numbers, and stay


@dataclass(frozen=True, eq=False)
class LevelFit:
    """A system refitted, with the level of friction of each recording.

    system: with the refitted attachments and their standard deviations; its level is that of the last recording.
    levels: factor on that kind of friction of every recording, by name, the last being 1. level_std: their standard deviations.
    rmse: of every recording's free run with its own level [unit of its positions]. cost: N log(S/N) and the priors' squares.
    """

    system: System
    levels: dict[str, float]
    level_std: dict[str, float]
    rmse: dict[str, float]
    cost: float


def fit_levels(
    starts: System | Sequence[System],
    recordings: Sequence[Recording],
    *,
    kind: Kind = DRY,
    spread: float | None = None,
    anew: Sequence[Sequence[float]] = (),
    deadline: Deadline | None = None,
) -> LevelFit:
    """Fit attached laws, nominal quantities, initial states and one level of a kind of friction a recording.

    starts: the system with the effects to fit attached, their parameters being where the search starts; of several, the one whose
    fit ends best. recordings: of free motion, every joint's position measured, in the order in which they were made.
    spread: expected relative spread of the levels, None for the kind's own. anew: for every recording, the times [s] from its first
    sample at which the free run begins anew, where motion cannot be predicted for longer. deadline: after it ``TimeUp`` is raised.
    Raises InputError for recordings that are driven or lack a position, UnsupportedError for flexible systems.
    """
    systems = [starts] if isinstance(starts, System) else list(starts)
    if any(system.flexible for system in systems):
        raise UnsupportedError("levels of friction are fitted for rigid links only", mend="leave the flexible link out")
    if not recordings or not systems:
        raise InputError("no recording or no system given", mend="name at least one of each")
    best = min(
        (_Levels(system, recordings, kind, spread, anew, deadline).fit() for system in systems),
        key=lambda found: found.cost,
    )
    # Valleys of friction laws are long and flat: from where the best one ended, with steps measured there, until it stands still.
    for _ in range(MOST_REFITS):
        further = _Levels(best.system, recordings, kind, spread, anew, deadline).fit()
        gained = best.cost - further.cost
        best = further if gained > 0.0 else best
        if gained < ENOUGH_REFIT_GAIN:
            break
    return best


def free_run_error(system: System, recording: Recording, *, anew: Sequence[float] = ()) -> float:
    """Error of a system's free run over a recording in which nothing but the initial state is fitted [unit of its positions].

    anew: as in ``fit_levels``.
    Raises InputError for a recording that is driven or lacks a position.
    """
    return _Levels(system, [recording], DRY, None, [anew]).error()


def labels(recordings: Sequence[Recording]) -> list[str]:
    """Names of recordings, numbered where they are the same."""
    names = [r.name for r in recordings]
    return [f"{name} ({k + 1})" if names.count(name) > 1 else name for k, name in enumerate(names)]


@dataclass(frozen=True, eq=False)
class _Run:
    """A free run: a recording or a stretch of one; of: the recording's number."""

    of: int
    name: str
    time: Array
    position: Array
    state: Array


class _Levels:
    def __init__(
        self,
        system: System,
        recordings: Sequence[Recording],
        kind: Kind,
        spread: float | None,
        anew: Sequence[Sequence[float]],
        deadline: Deadline | None = None,
    ) -> None:
        self.deadline = deadline or Deadline()
        self.bare = replace(system, attachments=())
        self.attachments = system.attachments
        self.kind = kind
        self.spread = kind.spread if spread is None else spread
        self.names = system.joint_names
        breaks = anew or [()] * len(recordings)
        self.count = len(recordings)
        self.labels = labels(recordings)
        self.runs = [run for k, r in enumerate(recordings) for run in self._runs(k, r, breaks[k])]
        self.nominal = nominal_quantities(self.bare)
        self.members = []
        for attachment in self.attachments:
            law = with_room(effect(attachment.effect), self.bare, attachment.site)
            self.members.append(Candidate(law, attachment.site, references(self.bare, attachment.site, recordings[0])))
        values = self._told_values(self.attachments)
        scales, low, high = [], [], []
        for member in self.members:
            for k, parameter in enumerate(member.effect.parameters):
                if parameter.name in WHOLE:
                    continue
                scales.append(float(member.scales[k]))
                low.append(parameter.lower)
                high.append(parameter.upper)
        self.low, self.high = np.array(low), np.array(high)
        # Steps are measured by where the search starts, if it starts anywhere.
        start = self._inner(values)
        self.scale = np.where(start != 0.0, START_ERROR * np.abs(start), START_ERROR * self._inner(np.array(scales)))
        self.scale = np.maximum(np.abs(self.scale), 1e-12)
        self.start = start
        self.model: LaneModel = lane_model(self._shaped(np.zeros(len(self.nominal)), values))

    def _runs(self, of: int, recording: Recording, anew: Sequence[float]) -> list[_Run]:
        if any(np.any(e.values != 0.0) for e in recording.efforts):
            raise InputError("the recording is driven", mend="give recordings of free motion", source=recording.source)
        columns = []
        for name in self.names:
            channel = next((c for c in recording.channels if c.site == name and c.quantity == "position"), None)
            if channel is None:
                raise InputError(
                    f"{name}.position is not measured", mend="record every joint's position", source=recording.source
                )
            good = np.isfinite(channel.values)
            columns.append(np.interp(recording.time, recording.time[good], channel.values[good]))
        position, time = np.stack(columns, axis=1), recording.time - recording.time[0]
        edges = np.searchsorted(time, [-np.inf, *anew, np.inf])
        pieces = [slice(int(a), int(b)) for a, b in pairwise(edges) if b - a >= FEWEST_FREE_SAMPLES]
        return [self._run(of, recording, time[piece], position[piece]) for piece in pieces]

    def _run(self, of: int, recording: Recording, time: Array, position: Array) -> _Run:
        time = time - time[0]
        every = max(1, int(1.0 / (THINNED_RATE * recording.interval) + 1e-9))
        count = max(10, int(np.searchsorted(time, FIRST_STATE_TIME)))
        fits = [np.polynomial.polynomial.polyfit(time[:count], p[:count], 4) for p in position.T]
        state = np.array([f[0] for f in fits] + [f[1] for f in fits])
        return _Run(of, recording.name, time[::every], position[::every], state)

    # -- what a parameter vector says -----------------------------------------------------------------------------------

    def _told_values(self, attachments: Sequence[Attachment]) -> Array:
        """All parameters that are fitted, in SI."""
        return np.array(
            [
                float(attachment.parameters[parameter.name])
                for member, attachment in zip(self.members, attachments, strict=True)
                for parameter in member.effect.parameters
                if parameter.name not in WHOLE
            ]
        )

    def _places(self, name: str) -> list[int]:
        """Where the fitted parameters of the members of that name begin."""
        out, at = [], 0
        for member in self.members:
            if member.effect.name == name:
                out.append(at)
            at += sum(p.name not in WHOLE for p in member.effect.parameters)
        return out

    def _inner(self, values: Array) -> Array:
        """Coordinates in which the misfit is nearly quadratic: Dahl's sliding way for his stiffness, a wave's two parts."""
        out = values.copy()
        for at in self._places("dahl_friction"):
            out[at + 1] = values[at] / max(values[at + 1], 1e-12)
        for at in self._places("encoder_interpolation"):
            out[at], out[at + 1] = values[at] * np.cos(values[at + 1]), values[at] * np.sin(values[at + 1])
        return out

    def _outer(self, inner: Array) -> Array:
        """The inverse of ``_inner``, inside the bounds (differences may step a hair over one)."""
        out = inner.copy()
        for at in self._places("dahl_friction"):
            out[at + 1] = max(inner[at], 0.0) / max(inner[at + 1], SHORTEST_DAHL_WAY)
        for at in self._places("encoder_interpolation"):
            out[at], out[at + 1] = np.hypot(inner[at], inner[at + 1]), np.arctan2(inner[at + 1], inner[at])
        return np.asarray(np.clip(out, self.low, self.high))

    def _with(self, values: Array) -> tuple[Attachment, ...]:
        out, at = [], 0
        for member, attachment in zip(self.members, self.attachments, strict=True):
            parameters = dict(attachment.parameters)
            for parameter in member.effect.parameters:
                if parameter.name not in WHOLE:
                    parameters[parameter.name] = float(values[at])
                    at += 1
            out.append(replace(attachment, parameters=parameters))
        return tuple(out)

    def _shaped(self, z: Array, values: Array) -> System:
        system = scaled(self.bare, self.nominal, list(bent_by(self.nominal, z)))
        for attachment in self._with(values):
            system = apply(system, attachment)
        return system

    def _row(self, z: Array, values: Array) -> Array:
        return lane_row(self.model, self._shaped(z, values))

    def _level(self, row: Array, level: float) -> Array:
        out = row.copy()
        for name in self.names:
            for slot in self.kind.slots:
                out[self.model.slot(name, slot)] *= level
        return out

    def _read(self, run: _Run, values: Array, q: Array) -> Array:
        """What the sensors read of positions (T, n)."""
        attached = self._with(values)
        out = q
        for j, name in enumerate(self.names):
            for law, attachment in sensor_chain(attached, f"{name}.position"):
                assert law.sensor is not None
                out = out.copy() if out is q else out
                out[:, j] = law.sensor.apply(out[None, :, j].copy(), run.time, law.values(attachment.parameters)[None])[
                    0
                ]
        return out

    def _split(self, x: Array) -> tuple[Array, Array, Array, Array]:
        a = len(self.nominal)
        b = a + len(self.start)
        c = b + self.count - 1
        # Differences may step a hair over a bound.
        return x[:a], self._outer(x[a:b] * self.scale), np.append(x[b:c], 0.0), x[c:].reshape(len(self.runs), -1)

    def _residuals(self, xs: Array, k: int) -> Array:
        """Residuals of recording k for many parameter vectors (B, X), shape (B, T·n)."""
        self.deadline.check()
        run = self.runs[k]
        n = len(self.names)
        rows, states, values = [], [], []
        for x in xs:
            z, v, levels, state = self._split(x)
            rows.append(self._level(self._row(z, v), float(np.exp(levels[run.of]))))
            states.append(state[k] + run.state)
            values.append(v)
        start = np.array(states)
        q, _, _ = self.model.simulate(np.array(rows), start[:, :n], start[:, n:], run.time)
        read = [self._read(run, v, q[b]) for b, v in enumerate(values)]
        return np.nan_to_num(np.array(read) - run.position, nan=1e3).reshape(len(xs), -1)

    # -- the fit --------------------------------------------------------------------------------------------------------

    def fit(self) -> LevelFit:
        a, b = len(self.nominal), len(self.nominal) + len(self.start)
        c = b + self.count - 1
        n = len(self.names)
        total = c + 2 * n * len(self.runs)
        x = np.zeros(total)
        x[a:b] = self.start / self.scale
        low = np.full(total, -np.inf)
        high = np.full(total, np.inf)
        low[a:b], high[a:b] = self._bounds()
        unit = np.ones(total)
        unit[b:c] = 0.1
        unit[c:] = np.tile(np.concatenate([np.full(n, 1e-3), np.full(n, 1e-2)]), len(self.runs))
        sigma = FIRST_RESIDUAL * max(float(np.abs(run.position).max()) for run in self.runs)
        pairs: dict[bytes, tuple[Array, Array]] = {}

        def both(x: Array) -> tuple[Array, Array]:
            key = x.tobytes()
            if key not in pairs:
                pairs.clear()
                pairs[key] = self._linear(x, unit, sigma, a, b, c)
            return pairs[key]

        for _ in range(2):
            pairs.clear()
            x[a:b] = np.clip(x[a:b], low[a:b] + 1e-9, high[a:b] - 1e-9)
            found = least_squares(
                lambda x: both(x)[0],
                x,
                jac=lambda x: both(x)[1],
                bounds=(low, high),
                x_scale=unit,
                max_nfev=MOST_LEVEL_EVALUATIONS,
            )
            x = found.x
            raw = [self._residuals(x[None], k)[0] for k in range(len(self.runs))]
            sigma = max(float(np.sqrt(np.mean(np.concatenate(raw) ** 2))), 1e-12)
        pairs.clear()
        rest, jacobian = both(x)
        spread = self._spread(rest, jacobian, c, (x <= low + 1e-6) | (x >= high - 1e-6))
        return self._told(x, spread, raw, a, b, c)

    def _pooled(self, raw: Sequence[Array], of: int) -> float:
        """Root mean square of the residuals of one recording's runs."""
        own = np.concatenate([r for r, run in zip(raw, self.runs, strict=True) if run.of == of])
        return float(np.sqrt(np.mean(own**2)))

    def error(self) -> float:
        """Root mean square over the first recording with nothing but initial states fitted."""
        raw = []
        for k in range(len(self.runs)):
            found = least_squares(
                lambda state, k=k: self._from(state[None], k)[0],
                np.zeros(2 * len(self.names)),
                jac=lambda state, k=k: self._slope(state, k),
                x_scale="jac",
            )
            raw.append(found.fun)
        return self._pooled(raw, 0)

    def _from(self, states: Array, k: int) -> Array:
        """Residuals of run k (B, T·n) from initial states (B, 2n) relative to those read off, all else where it starts."""
        fixed = np.concatenate([np.zeros(len(self.nominal)), self.start / self.scale, np.zeros(self.count - 1)])
        every = np.zeros((len(states), len(self.runs), states.shape[1]))
        every[:, k] = states
        return self._residuals(np.hstack([np.tile(fixed, (len(states), 1)), every.reshape(len(states), -1)]), k)

    def _slope(self, state: Array, k: int) -> Array:
        both = self._from(np.vstack([state, state + LEVEL_FIT_DIFFERENCE * np.eye(len(state))]), k)
        return (both[1:] - both[0]).T / LEVEL_FIT_DIFFERENCE

    def _bounds(self) -> tuple[Array, Array]:
        low, high = self.low / self.scale, self.high / self.scale
        for at in self._places("dahl_friction"):
            low[at + 1], high[at + 1] = SHORTEST_DAHL_WAY / self.scale[at + 1], np.inf
        for at in self._places("encoder_interpolation"):
            low[at : at + 2], high[at : at + 2] = -np.inf, np.inf
        return low, high

    def _linear(self, x: Array, unit: Array, sigma: float, a: int, b: int, c: int) -> tuple[Array, Array]:
        """Whitened residuals with the priors below them, and their Jacobian by lanes."""
        n = 2 * len(self.names)
        parts, matrices = [], []
        for k in range(len(self.runs)):
            of = self.runs[k].of
            shared = [*range(b), *([b + of] if of < self.count - 1 else []), *range(c + n * k, c + n * (k + 1))]
            lanes = np.tile(x, (1 + len(shared), 1))
            for row, p in enumerate(shared):
                lanes[1 + row, p] += LEVEL_FIT_DIFFERENCE * unit[p] * (100.0 if a <= p < b else 1.0)
            r = self._residuals(lanes, k) / sigma
            matrix = np.zeros((r.shape[1], len(x)))
            for row, p in enumerate(shared):
                matrix[:, p] = (r[1 + row] - r[0]) / (lanes[1 + row, p] - x[p])
            parts.append(r[0])
            matrices.append(matrix)
        priors = np.zeros((a + c - b, len(x)))
        priors[:a, :a] = np.eye(a)
        priors[a:, b:c] = np.eye(c - b) / self.spread
        rest = np.concatenate([*parts, x[:a], x[b:c] / self.spread])
        return rest, np.vstack([*matrices, priors])

    def _spread(self, rest: Array, jacobian: Array, c: int, bound: NDArray[np.bool_]) -> Array:
        """Standard deviations of all parameters from the gradient's scatter between blocks of recordings; nan at bounds."""
        free = np.flatnonzero(~bound)
        matrix = jacobian[:, free]
        size = np.linalg.norm(matrix, axis=0)
        free, matrix, size = free[size > 0.0], matrix[:, size > 0.0], size[size > 0.0]
        inverse = np.linalg.pinv((matrix / size).T @ (matrix / size), rcond=1e-12) / np.outer(size, size)
        rows = sum(r.position.size for r in self.runs)
        gradients = np.array(
            [matrix[i].T @ rest[i] for i in np.array_split(np.arange(rows), GRADIENT_BLOCKS * self.count)]
        )
        robust = inverse @ (gradients.T @ gradients) @ inverse
        out = np.full(jacobian.shape[1], np.nan)
        out[free] = np.sqrt(np.maximum(np.diag(robust), np.diag(inverse)))
        return out

    def _told(self, x: Array, spread: Array, raw: list[Array], a: int, b: int, c: int) -> LevelFit:
        z, values, levels, _ = self._split(x)
        # Spreads of the coordinates become those of the parameters through the Jacobian of the change between them.
        inner = x[a:b] * self.scale
        deviation = np.nan_to_num(spread[a:b] * self.scale)
        known = np.isfinite(spread[a:b])
        change = np.zeros((b - a, b - a))
        for k in range(b - a):
            step = 1e-4 * max(abs(inner[k]), self.scale[k])
            ahead = inner.copy()
            ahead[k] += step
            change[:, k] = (self._outer(ahead) - values) / step
        width = np.sqrt((change**2) @ deviation**2)
        touched = (np.abs(change) > 0.0) @ (~known)
        attachments, at = [], 0
        for attachment, member in zip(self._with(values), self.members, strict=True):
            deviations = {}
            for parameter in member.effect.parameters:
                if parameter.name in WHOLE:
                    continue
                if not touched[at]:
                    deviations[parameter.name] = float(width[at])
                at += 1
            attachments.append(replace(attachment, std=deviations))
        system = scaled(self.bare, self.nominal, list(bent_by(self.nominal, z)))
        names = self.labels
        pooled = np.concatenate(raw)
        cost = len(pooled) * float(np.log(np.mean(pooled**2))) + float(z @ z + levels @ levels / self.spread**2)
        factors = np.exp(levels)
        widths = np.append(spread[b:c], 0.0) * factors
        return LevelFit(
            replace(system, attachments=tuple(attachments)),
            dict(zip(names, map(float, factors), strict=True)),
            dict(zip(names, map(float, widths), strict=True)),
            {name: self._pooled(raw, k) for k, name in enumerate(names)},
            cost,
        )
