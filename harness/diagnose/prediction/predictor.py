"""What a hypothesis says the sensors should have read: batched free runs, then the measurement chain.

A sensor with a memory is a state whose value nobody knows where a window begins in motion. It is taken to follow as it would a
wave of the frequency seen there; what that is wrong by dies out along a known course, of which as much is added as the record
shows. What starts from rest with the recording was held before, and the filter has settled on it. Zeros of a recording's own, and
the phase of a hum, which mains know no beginning of, are taken in the same way as the record shows them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.model import LaneModel
from harness.denoc.lanes.rows import INERTIA_SLOTS
from harness.denoc.motion.hold import kept
from harness.diagnose.prediction.assembly import Assembly
from harness.diagnose.prediction.constants import CLOCK_MARGIN, FINEST_STEP, MOST_WITHIN_A_BLOCK, RUN_TOLERANCE
from harness.diagnose.prediction.mechanisms import Mechanism, Mechanisms
from harness.diagnose.prediction.recorded_efforts import RecordedEfforts
from harness.diagnose.prediction.stiff_runs import StiffRuns
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.grid import Grid, hermite, make_grid
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.effects.attach import sensor_chain
from harness.effects.effect import Sensor
from harness.effects.measurement import within
from harness.parallel import threads_allowed
from harness.recording.sensors import observe
from harness.system import System

Array = NDArray[np.float64]

ABREAST = 8  # lanes that run at the price of one
UNEQUAL = 4  # times as long as another may a lane be that runs beside it: room is kept for the longest


@dataclass(frozen=True, eq=False)
class Request:
    """Lanes of one hypothesis to be predicted; see ``Predictor.predict``."""

    hypothesis: Hypothesis
    x: Array
    lanes: Sequence[tuple[int, Window, Array]]
    extra: Array | None = None
    tolerance: float = 0.0  # error of one step, if it may be larger than the predictor's own


@dataclass(frozen=True, eq=False)
class Push:
    """Further forces along a window, the same whatever is predicted: times [s] from its first sample (G,), and forces
    [N·m or N] by joint (G,)."""

    time: Array
    forces: Mapping[str, Array]

    def on(self, names: Sequence[str], time: Array) -> Array:
        """The same on another grid and for the coordinates of a mechanism, (G, n)."""
        still = np.zeros(len(time))
        own = (self.forces.get(name) for name in names)
        return np.array([still if f is None else np.interp(time, self.time, f) for f in own]).T


@dataclass(frozen=True, eq=False)
class Prepared:
    """What lanes of a request need before they run: rows (K, P) of the mechanism and the systems that they stand for, how far
    beyond their windows, and whether something in them knows the date."""

    mechanism: Mechanism
    rows: Array
    systems: tuple[System, ...]
    margin: float
    dated: bool


def taken(array: Array, places: Sequence[int]) -> Array:
    """Some of the leading entries; a view where they follow one another."""
    first = places[0]
    if list(places) == list(range(first, first + len(places))):
        return array[first : first + len(places)]
    return array[places]


class Predictor(Mechanisms):
    """Predictions of hypotheses for windows of a problem's runs; compiled systems and grids are kept.

    deadline: after which nothing further is predicted; its ``TimeUp`` is raised instead.
    """

    def __init__(self, problem: Problem, *, finest_step: float = FINEST_STEP, deadline: Deadline | None = None) -> None:
        super().__init__(problem.system)
        self.problem = problem
        self.deadline = deadline or Deadline()
        self.runs = problem.runs
        self.finest_step = finest_step
        self.tolerance = RUN_TOLERANCE
        # Where windows begin, by run and first sample; see ``estimation.assemblies``.
        self.assemblies: dict[tuple[int, int], Assembly] = {}
        self._grids: dict[tuple[Window, float], Grid] = {}
        self._recorded = RecordedEfforts(problem, self)
        self.threads = threads_allowed()
        self.lanes_run = 0
        # Of candidates by key, where it is another one than usual; see ``search_ends``.
        self.reach: dict[str, float] = {}
        self._stiff: StiffRuns | None = None
        self._carrying = any(run.payload for run in problem.runs)
        self._pushes: Mapping[Window, Push] = {}
        self._payloads: dict[tuple[int, int], Array] = {}

    @property
    def hold(self) -> str:
        """How forces on the grid act between its points; see ``LaneModel.simulate``."""
        return "zero" if self.problem.held else "linear"

    def shorten(self, noise: Array) -> None:
        """From now on run elastic mechanisms in longer steps where the difference cannot be seen behind noise (C,) [std]."""
        self._stiff = StiffRuns(self.problem.channels, noise)

    def taking(self, problem: Problem) -> Predictor:
        """The same for a problem that takes the efforts of the same runs otherwise; what else is kept is shared."""
        other = copy(self)
        other.problem, other.runs, other._recorded = problem, problem.runs, RecordedEfforts(problem, other)
        return other

    def pushed(self, pushes: Mapping[Window, Push]) -> Predictor:
        """The same with further forces along some windows; what else is kept is shared."""
        other = copy(self)
        other._pushes = pushes
        return other

    def payload(self, mechanism: Mechanism, run: int) -> Array:
        """What is added to a mechanism's rows (P,) for what links carry in a run."""
        key = (id(mechanism), run)
        if key not in self._payloads:
            added = np.zeros(mechanism.model.P)
            for link, change in self.runs[run].payload.items():
                added[[mechanism.model.slot(link, name) for name in INERTIA_SLOTS]] = change
            self._payloads[key] = added
        return self._payloads[key]

    def row_in(self, hypothesis: Hypothesis, x: Array, run: int) -> Array:
        """Parameter row of one lane of a run, what its links carry included."""
        return self.row(hypothesis, x) + self.payload(self.mechanism(hypothesis), run)

    def shortened(self, hypothesis: Hypothesis) -> bool:
        """Whether runs of the hypothesis may be in such steps: those of what has coordinates besides its joints."""
        return self._stiff is not None and len(self.mechanism(hypothesis).names) > len(self.system.movable_joints)

    def margin(self, hypothesis: Hypothesis) -> float:
        """Share of a window that has to be simulated beyond its end."""
        return CLOCK_MARGIN if any(m.effect.sensor and m.effect.sensor.clock for m in hypothesis.members) else 0.0

    def grid(self, window: Window, margin: float = 0.0) -> Grid:
        """Times at which lanes hand over states for the window, carried on by a share ``margin`` of its length."""
        key = (window, margin)
        if key not in self._grids:
            self._grids[key] = make_grid(self.runs[window.run], window, self.finest_step, margin)
        return self._grids[key]

    def predict(
        self,
        hypothesis: Hypothesis,
        x: Array,
        lanes: Sequence[tuple[int, Window, Array]],
        *,
        extra: Array | None = None,
    ) -> list[Array]:
        """Channels for lanes of (index into ``x``, window, initial state): one array (C, T) a lane.

        x: parameter vectors, shape (K, size). extra: further generalized forces on the grid [N·m or N], shape (B, G, n),
        for lanes of one window. Lanes of windows with equal grids run together.
        """
        return self.predict_all([Request(hypothesis, x, lanes, extra)])[0]

    def predict_all(self, requests: Sequence[Request]) -> list[list[Array]]:
        """The same for several requests at once: lanes of one mechanism run together, whatever is asked of them."""
        asked = [self._prepare(request) for request in requests]
        out: list[list[Array]] = [[np.empty(0)] * len(request.lanes) for request in requests]
        groups: dict[tuple[int, int, float, bool, float, float], list[tuple[int, int, int]]] = {}
        for k, (request, ready) in enumerate(zip(requests, asked, strict=True)):
            before: Window | None = None
            length, members = 0, list[tuple[int, int, int]]()
            for lane, (_, window, _) in enumerate(request.lanes):
                if window is not before:
                    before, grid, run = window, self.grid(window, ready.margin), self.runs[window.run]
                    # A law that knows the time needs the time of the recording, not of the window.
                    start = run.date(window.first) if ready.dated else 0.0
                    length = len(grid.time)
                    # Further forces come on the grid of their window.
                    own = 0 if request.extra is None and not self._pushes else length
                    key = (id(ready.mechanism), own, grid.step, run.effort is None, start, request.tolerance)
                    members = groups.setdefault(key, [])
                members.append((k, lane, length))
        for (_, _, _, free, start, _), left in groups.items():
            while left:
                longest = max(length for _, _, length in left)
                together = [member for member in left if UNEQUAL * member[2] >= longest]
                self._run(requests, asked, together, free, start, out)
                left = [member for member in left if UNEQUAL * member[2] < longest]
        return out

    def _prepare(self, request: Request) -> Prepared:
        """What lanes of a request need before they run."""
        hypothesis = request.hypothesis
        rows, systems = self.made(hypothesis, request.x)
        dated = bool(self.system.attachments) or any(m.effect.user is not None for m in hypothesis.members)
        return Prepared(self.mechanism(hypothesis), rows, systems, self.margin(hypothesis), dated)

    def _run(
        self,
        requests: Sequence[Request],
        asked: Sequence[Prepared],
        members: Sequence[tuple[int, int, int]],
        free: bool,
        start: float,
        out: list[list[Array]],
    ) -> None:
        """Run lanes (request, lane, points of the grid) of one mechanism and equal steps together and hand their channels to
        ``out``."""
        mechanism = asked[members[0][0]].mechanism
        by_request: dict[int, list[int]] = {}
        for k, lane, _ in members:
            by_request.setdefault(k, []).append(lane)
        asking, _, counts = np.array(members).T
        k, lane, _ = members[int(np.argmax(counts))]
        grid_time = self.grid(requests[k].lanes[lane][1], asked[k].margin).time
        rows, states = [], []
        lanes_of = {k: [requests[k].lanes[i] for i in own] for k, own in by_request.items()}
        for k, lanes in lanes_of.items():
            mine = asked[k].rows[[row for row, _, _ in lanes]]
            if self._carrying:
                mine += np.array([self.payload(mechanism, window.run) for _, window, _ in lanes])
            if start == 0.0:
                self._shift_shaking(mechanism.model, mine, [window for _, window, _ in lanes])
            rows.append(mine)
            states.append(np.array([state for _, _, state in lanes]))
        every_row, every_state = np.concatenate(rows), np.concatenate(states)
        tau, source = None, np.zeros(len(members), dtype=np.intp)
        if not free:
            needed = [(requests[k].hypothesis, requests[k].x, lanes) for k, lanes in lanes_of.items()]
            tau, source = self._recorded.on(mechanism.names, grid_time, needed)
        extra = [np.asarray(requests[k].extra)[own] for k, own in by_request.items() if requests[k].extra is not None]
        if extra:
            pushed = np.concatenate(extra)
            pushed = kept(pushed) if self.problem.held else pushed
            tau, source = pushed if tau is None else tau[source] + pushed, np.arange(len(members))
        if self._pushes:
            windows = [window for lanes in lanes_of.values() for _, window, _ in lanes]
            tau, source = self._with_pushes(mechanism.names, grid_time, windows, tau, source)
        # Sensors share a motion.
        shared = len(requests) > 1 or any(m.effect.sensor is not None for m in requests[0].hypothesis.members)
        first, again = _distinct(every_row, every_state, source, counts, shared)
        self.lanes_run += len(first)
        alone = np.array_equal(first, np.arange(len(members)))
        q, qd, qdd = self.motions(
            mechanism, every_row[first], every_state[first], grid_time + start, tau, asking[first],
            requests[members[0][0]].tolerance, counts[first], source[first],
        )  # fmt: skip
        place = 0
        for k, own in by_request.items():
            request, ready = requests[k], asked[k]
            alike: dict[object, list[int]] = {}
            same: list[int] = []
            before: Window | None = None
            for j, i in enumerate(own):
                window = request.lanes[i][1]
                if window is not before:
                    before = window
                    same = alike.setdefault(self._sampling(request.hypothesis, window, ready.margin), [])
                same.append(j)
            for places in alike.values():
                window = request.lanes[own[places[0]]][1]
                where = [place + j for j in places] if alone else again[[place + j for j in places]].tolist()
                sampled = hermite(self.grid(window, ready.margin), *(taken(array, where) for array in (q, qd, qdd)))
                which = [request.lanes[own[j]][0] for j in places]
                channels = self._observe(
                    request.hypothesis,
                    request.x[which],
                    ready.rows[which],
                    [ready.systems[i] for i in which],
                    mechanism,
                    self.runs[window.run],
                    window,
                    sampled,
                    ready.margin,
                )
                for j, channel in zip(places, channels, strict=True):
                    out[k][own[j]] = channel
            place += len(own)

    def _with_pushes(
        self, names: Sequence[str], time: Array, windows: Sequence[Window], tau: Array | None, source: NDArray[np.intp]
    ) -> tuple[Array, NDArray[np.intp]]:
        """Efforts (E, G, n), and which of them acts on each lane, with what pushes along the lanes' windows."""
        known: dict[tuple[Window, int], int] = {}
        forces, which = list[Array](), np.empty(len(windows), dtype=np.intp)
        for lane, (window, own) in enumerate(zip(windows, source.tolist(), strict=True)):
            place = known.setdefault((window, own), len(forces))
            if place == len(forces):
                push = self._pushes.get(window)
                added = np.zeros((len(time), len(names))) if push is None else push.on(names, time)
                added = kept(added[None])[0] if self.problem.held else added
                forces.append(added if tau is None else tau[own] + added)
            which[lane] = place
        return np.array(forces), which

    def motions(
        self, mechanism: Mechanism, rows: Array, states: Array, time: Array, tau: Array | None, requests: Array,
        tolerance: float = 0.0, counts: NDArray[np.int64] | None = None, source: NDArray[np.intp] | None = None,
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        """Position, velocity, acceleration (B, T, n) of rows (B, P) from states (B, 2n) under efforts (E, T, n).

        requests: what belongs together, (B,), and so is run by one method. tolerance: error of one step, if it may be larger than
        the predictor's own. counts: of the times that each is asked for, (B,), by default all. source: which of the efforts acts
        on each, (B,), by default each its own.
        """
        self.deadline.check()
        model, n = mechanism.model, len(mechanism.names)
        tolerance = max(self.tolerance, tolerance)
        if self._stiff is not None and n > len(self.system.movable_joints):
            own = tau if tau is None or source is None else tau[source]
            return self._stiff.run(
                model,
                rows,
                states,
                time,
                own,
                requests,
                tolerance,
                self.hold,
                self.threads,
                counts,
                self.deadline.check,
            )
        q, qd = np.ascontiguousarray(states[:, :n]), np.ascontiguousarray(states[:, n:])
        return model.simulate(
            rows, q, qd, time, tau=tau, source=source, hold=self.hold, tolerance=tolerance, counts=counts,
            threads=self.threads, between=self.deadline.check,
        )  # fmt: skip

    def _sampling(self, hypothesis: Hypothesis, window: Window, margin: float) -> object:
        """What lanes must have in common to be read by the sensors together: the window itself where sensors know the time."""
        grid, run = self.grid(window, margin), self.runs[window.run]
        sensing = any(m.effect.sensor is not None for m in hypothesis.members) or self.system.attachments
        if sensing or grid.stride == 0:
            return window
        return window.size, grid.stride, run.interval, run.averaged

    def _shift_shaking(self, model: LaneModel, rows: Array, windows: Sequence[Window]) -> None:
        """Let the shaking of the base begin at the windows' places in their recordings, in place."""
        for lane in np.flatnonzero(rows[:, model.slot("base", "excitation_amplitude")]).tolist():
            start = self.runs[windows[lane].run].date(windows[lane].first)
            frequency = rows[lane, model.slot("base", "excitation_frequency")]
            rows[lane, model.slot("base", "excitation_phase")] += 2.0 * np.pi * frequency * start

    def acting(
        self,
        hypothesis: Hypothesis,
        x: Array,
        mechanism: Mechanism,
        lanes: Sequence[tuple[int, Window, Array]],
        grid_time: Array,
    ) -> Array | None:
        """Generalized forces on the grid for lanes of one run, (B, G, n), after the effects of the input side and with what pushes
        along their windows; None where nothing acts."""
        forces, source = None, np.zeros(len(lanes), dtype=np.intp)
        if self.runs[lanes[0][1].run].effort is not None:
            forces, source = self._recorded.on(mechanism.names, grid_time, [(hypothesis, x, lanes)])
        if self._pushes:
            windows = [window for _, window, _ in lanes]
            forces, source = self._with_pushes(mechanism.names, grid_time, windows, forces, source)
        return None if forces is None else np.asarray(forces[source])

    def _observe(
        self,
        hypothesis: Hypothesis,
        x: Array,
        rows: Array,
        systems: Sequence[System],
        mechanism: Mechanism,
        run: Run,
        window: Window,
        sampled: tuple[Array, Array, Array],
        margin: float,
    ) -> Array:
        """Channels (B, C, T) of the window from the states at its samples."""
        local = self.grid(window, margin).stamps
        stamps = local + run.date(window.first)
        out = np.empty((len(x), len(self.problem.channels), window.size))
        for c, channel in enumerate(self.problem.channels):
            signal = observe(mechanism.model, rows, channel.site, channel.quantity, sampled, systems).copy()
            acting = self._sensing(hypothesis, x, channel.name)
            if not acting:
                out[:, c] = _averaged(signal, run, channel, mechanism, sampled)[:, : window.size]
                continue
            if run.averaged > 1 and channel.quantity == "position":
                column = mechanism.names.index(channel.site)
                rate, bend = sampled[1][:, :, column], sampled[2][:, :, column]
                parts = [
                    _sensed(signal + shift * rate + 0.5 * shift**2 * bend, local + shift, stamps + shift, acting)
                    for shift in _within_a_block(run)
                ]
                out[:, c] = sum(parts[1:], parts[0])[:, : window.size] / len(parts)
            else:
                averaged = _averaged(signal, run, channel, mechanism, sampled)
                out[:, c] = _sensed(averaged, local, stamps, acting)[:, : window.size]
            out[:, c] += _remembered(out[:, c], signal, stamps, acting, run, window, c)
            out[:, c] += _of_its_own(out[:, c], stamps, acting, run, window, c)
        return out

    def _sensing(self, hypothesis: Hypothesis, x: Array, channel: str) -> list[tuple[Sensor, Array]]:
        """What acts on a channel between motion and record, in its order, with parameters (B, k)."""
        acting = [
            (m.effect.sensor, self.effect_values(hypothesis, k, x))
            for k, m in enumerate(hypothesis.members)
            if m.effect.sensor is not None and (m.site == channel or m.effect.sensor.every_channel)
        ]
        for effect, attachment in sensor_chain(self.system.attachments, channel):
            assert effect.sensor is not None
            acting.append((effect.sensor, np.tile(effect.values(attachment.parameters), (len(x), 1))))
        return sorted(acting, key=lambda item: item[0].stage)


def _sensed(signal: Array, local: Array, stamps: Array, acting: Sequence[tuple[Sensor, Array]]) -> Array:
    """A signal (B, T) after its sensors. local, stamps: times from the window's and the recording's first sample [s]."""
    inside = within(stamps)
    for sensor, values in acting:
        if sensor.courses is not None or (sensor.at_first and inside):
            continue
        # What stretches time does so from the window's first sample: the state there is free.
        when = local if sensor.every_channel else stamps
        signal = sensor.apply(np.ascontiguousarray(signal), when, values)
    return signal


def _remembered(
    reading: Array,
    signal: Array,
    stamps: Array,
    acting: Sequence[tuple[Sensor, Array]],
    run: Run,
    window: Window,
    c: int,
) -> Array:
    """What sensors still know of the time before a window: as much of its course as the record there shows, (B, T).

    Filters that begin in motion stand somewhere, and that is nothing to the other windows, like the state of the mechanism.
    """
    record = run.values[c, window.first : window.last]
    seen = np.isfinite(record)
    known = [sensor.memory(signal, stamps, values) for sensor, values in acting if sensor.memory is not None]
    if not known or not seen.any():
        return np.zeros_like(reading)
    # Of several filters all at once: the quick one would take for its own what the slow one still knows.
    courses = np.array([size[:, None] * course[:, : window.size] for course, size in known])
    own = courses[:, :, seen]
    gram = np.einsum("ibt,jbt->bij", own, own)
    noise = run.roughness[c] ** 2 + 1e-12 * np.trace(gram, axis1=1, axis2=2) + 1e-300
    along = np.einsum("ibt,bt->bi", own, (record - reading)[:, seen])
    amount = np.linalg.solve(gram + noise[:, None, None] * np.eye(len(known)), along[:, :, None])
    return np.asarray(np.einsum("bi,ibt->bt", amount[:, :, 0], courses))


def _of_its_own(
    reading: Array, stamps: Array, acting: Sequence[tuple[Sensor, Array]], run: Run, window: Window, c: int
) -> Array:
    """What sensors add that is every window's own, (B, T), as the record there shows it: a zero, waves in a phase."""
    total = np.zeros_like(reading)
    if not any(sensor.own_zero or sensor.courses is not None for sensor, _ in acting):
        return total
    record = run.values[c, window.first : window.last]
    seen = np.isfinite(record)
    if seen.any() and any(sensor.own_zero for sensor, _ in acting):
        total += np.mean((record - reading)[:, seen], axis=1, keepdims=True)
    # Towards the ends of a window little counts, lest what else is wrong there looked like a wave.
    weights = np.hanning(window.size + 2)[1:-1][seen]
    for sensor, values in acting:
        if sensor.courses is None or not seen.any():
            continue
        courses = sensor.courses(stamps[: window.size], values, _within_a_block(run, run.averaged))
        own = courses[:, :, seen]
        left = (record - reading - total)[:, seen]
        gram = np.einsum("ibt,jbt,t->bij", own, own, weights)
        along = np.einsum("ibt,bt,t->bi", own, left, weights)
        scale = np.trace(gram, axis1=1, axis2=2)[:, None, None] + 1e-300
        mixed = np.linalg.solve(gram / scale + 1e-9 * np.eye(2), along[:, :, None] / scale)[:, :, 0]
        size = np.hypot(mixed[:, 0], mixed[:, 1])
        phase = np.where(size[:, None] > 0.0, mixed / np.where(size > 0.0, size, 1.0)[:, None], [1.0, 0.0])
        total += np.einsum("bi,ibt->bt", phase, courses)
    return total


def _averaged(
    signal: Array, run: Run, channel: ChannelInfo, mechanism: Mechanism, sampled: tuple[Array, Array, Array]
) -> Array:
    """A smooth signal (B, T) at the middle of blocks of samples as the blocks' average, to second order."""
    if run.averaged == 1:
        return signal
    spread = 0.5 * float(np.mean(_within_a_block(run) ** 2))
    if channel.quantity == "position":
        return np.asarray(signal + spread * sampled[2][:, :, mechanism.names.index(channel.site)])
    return np.asarray(signal + spread * np.gradient(np.gradient(signal, run.interval, axis=1), run.interval, axis=1))


def _within_a_block(run: Run, most: int = MOST_WITHIN_A_BLOCK) -> Array:
    """Times around the middle of a block [s] that stand for its samples: at most so many, spread as widely as they are."""
    count = min(run.averaged, most)
    if count == 1:
        return np.zeros(1)
    spacing = run.interval / run.averaged * np.sqrt((run.averaged**2 - 1.0) / (count**2 - 1.0))
    return np.asarray(spacing * (np.arange(count) - 0.5 * (count - 1)))


def _distinct(
    rows: Array, states: Array, source: NDArray[np.intp], counts: NDArray[np.int64], shared: bool
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Lanes that differ from all others, if some may not, and for every lane which of those it equals.

    Of more than run abreast the longest come first, so that those that do take equally long.
    """
    first = again = np.arange(len(rows))
    if shared:
        seen: dict[tuple[int, int, bytes], int] = {}
        keys = zip(counts.tolist(), source.tolist(), rows, states, strict=True)
        places = [seen.setdefault((n, e, r.tobytes() + s.tobytes()), len(seen)) for n, e, r, s in keys]
        _, first = np.unique(places, return_index=True)
        again = np.array(places)
    if len(first) <= ABREAST:
        return first, again
    order = np.argsort(-counts[first], kind="stable")
    return first[order], np.argsort(order)[again]
