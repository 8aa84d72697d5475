"""Lanes: many copies of one mechanism advanced at once, each with its own parameters and initial state.

This is the workhorse of fitting and sweeping: a Jacobian is a few extra lanes. See ``LaneModel``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.compiling import ahead
from harness.denoc.joint_laws import laws
from harness.denoc.joint_laws.address import compiled_law
from harness.denoc.lanes.beams import beam_block_size, most_points, write_beams
from harness.denoc.lanes.closed import GROUP_NUMBERS, LOOP_NUMBERS, NEAR, TURNING
from harness.denoc.lanes.closing import GROUP_SLOTS, Beyond, beyond, marked
from harness.denoc.lanes.nodes import (
    BEAM,
    BODY,
    COLUMNS,
    COORDINATE,
    GROUP,
    JOINT,
    KIND,
    MODES,
    PRISMATIC,
    REVOLUTE,
    SECTION,
    WORK,
    beam_table_size,
    beam_work_size,
    section_table_size,
    section_work_size,
)
from harness.denoc.lanes.plane import plane_of
from harness.denoc.lanes.rows import (
    ABOVE,
    BASE_SLOTS,
    BEAM_HEAD,
    BEAM_NODE,
    BEAM_ROW,
    BEAM_SLOTS,
    INERTIA_SLOTS,
    LAW_ROW,
    LINK_COLUMNS,
    NODE,
    PER_JOINT,
    PLACEMENT_SLOTS,
    SECTION_NODE,
    SECTION_ROW,
    TIP_NODE,
)
from harness.denoc.lanes.threads import share
from harness.errors import InputError, UnsupportedError
from harness.system import Link, System
from harness.system.followers import mimics_apart, screws_apart
from harness.system.inertia import inertial_numbers
from harness.system.lowering import one_degree

Array = NDArray[np.float64]

TOLERANCE = 1e-11
"""Error allowed in one step [rad, rad/s (1 + |rad/s|)]."""
LONG = 5_000  # sample times, of groups of eight copies together, between which a long computation may be ended


@lru_cache(maxsize=2)
def step_method(order: int) -> tuple[Any, ...]:
    """A Dormand-Prince method of order 8 or 5 with its dense output, from the coefficients that scipy publishes.

    Table of the stages, the end of the step as the last row; their fractions of the step; weights of the two error
    estimates; further stages of the dense output and their fractions; weights of all slopes in the powers 1 … 7 of
    the step's fraction; exponent of the step's control. Tables are two arrays each, as from ``_sparse``.
    """
    from scipy.integrate import DOP853, RK45

    source = DOP853 if order == 8 else RK45
    stages = len(source.B)
    table = np.zeros((stages + 1, stages + 1))
    table[:stages, : source.A[:stages, :stages].shape[1]] = source.A[:stages, :stages]
    table[stages, :stages] = source.B
    fractions = np.append(np.asarray(source.C, dtype=float)[:stages], 1.0)
    if order == 5:
        weights = np.zeros((7, stages + 1))
        weights[:4] = RK45.P.T
        none = np.zeros((0, stages + 1))
        return (
            *_sparse(table), fractions, RK45.E * 1.0, np.zeros(stages + 1), *_sparse(none), np.zeros(0), *_sparse(weights),
            -1.0 / 5.0,
        )  # fmt: skip
    # Hairer's nested form y + x (F0 + (1 − x) (F1 + x (F2 + …))), each F a combination of slopes, in powers of x.
    slopes = DOP853.D.shape[1]
    rise = np.zeros(slopes)
    rise[:stages] = DOP853.B
    first, last = np.eye(slopes)[0], np.eye(slopes)[stages]
    nested = [rise, first - rise, 2.0 * rise - first - last, *DOP853.D]
    powers = np.zeros((9, slopes))
    for k, combination in enumerate(reversed(nested)):
        powers[0] += combination
        shifted = np.roll(powers, 1, axis=0)
        powers = shifted if k % 2 == 0 else powers - shifted
    return (
        *_sparse(table), fractions, DOP853.E5 * 1.0, DOP853.E3 * 1.0, *_sparse(np.asarray(DOP853.A_EXTRA, dtype=float)),
        DOP853.C_EXTRA * 1.0, *_sparse(powers[1:8]), -1.0 / 8.0,
    )  # fmt: skip


def _sparse(table: Array) -> tuple[Array, NDArray[np.int64]]:
    """What of each row is not zero, and how many and which columns that is: values (R, C), count and columns (R, C + 1)."""
    values = np.zeros((len(table), max(1, table.shape[1])))
    places = np.zeros((len(table), table.shape[1] + 1), dtype=np.int64)
    for row, (line, value, place) in enumerate(zip(table, values, places, strict=True)):
        (used,) = np.nonzero(table[row])
        value[: len(used)] = line[used]
        place[0], place[1 : len(used) + 1] = len(used), used
    return values, places


def _recursion(in_plane: bool) -> int:
    """The address of the recursion; says so once if it or the integrator has to be compiled first."""
    from harness.denoc.lanes.address import planar, spatial

    name = "planar" if in_plane else "spatial"
    _say_once(name)
    ahead.ready(name)
    return planar() if in_plane else spatial()


def _closed() -> int:
    """The address of what goes around the recursion of a mechanism that is more than a tree."""
    from harness.denoc.lanes.address import closed

    ahead.ready("closed")
    return closed()


@lru_cache(maxsize=2)
def _say_once(recursion: str) -> None:
    ahead.announce(("lanes", recursion))


class LaneModel:
    """One topology, compiled for many copies at once.

    names: generalized coordinates (joints, each followed by the modes of its link); n: their number; P: length of a row.
    slots: index of the parameters in a row by (site, name). Sites and names:

    - ``base``: gravity_x, gravity_y, gravity_z [m/s²]; excitation_amplitude [m/s²], excitation_frequency [Hz],
      excitation_phase [rad] of the base's acceleration amplitude · sin(2π frequency · time + phase) along the
      direction excitation_x, excitation_y, excitation_z (not normalised, x by default);
    - every joint, fixed ones included: x, y, z [m], origin in the parent's link frame; turn_x, turn_y, turn_z [rad], rotation
      vector that follows the rotation of the joint in the system the model was made from;
    - every movable joint: the terms of ``laws.SLOTS``;
    - every link: mass [kg], first_x … [kg·m], inertia_xx … [kg·m²], first and second moments about the
      link frame's origin (so a point mass m at r adds m, m r and m (|r|² 1 − r rᵀ)); of a flexible link, those of its
      hub, which does not bend;
    - every flexible link: payload, point mass at the tip [kg]; stiffness_factor on EI and mass_factor on the beam's mass;
      material_damping [s]; stiffening, 1 with and 0 without foreshortening; modal_damping_1 …, ratios of the modes as mounted.
      Lengths, shapes and what follows from them stand behind these without names; ``row`` fills them from the system.

    law: the user's own joint law ``(q, qd, t, p) -> generalized force`` with four parameters p, compiled on its own; it acts at
    every joint whose ``user_scale`` slot is not zero.
    planar: whether a mechanism that moves in one plane is computed as such, which is faster and the same to rounding;
    plane says that it is, and what plane.
    Loops of a system are held closed: a motion begins where ``dependent`` coordinates follow the others; a loop has the slot
    ``gap`` [m], 0 where it has no clearance, and slots of what resists how its frames turn against one another. Of gimbals, what
    acts on three joints together has slots by their name (both ``closing.GROUP_SLOTS``). Screws and joints that mimic others are
    couplings of joints with coordinates of their own (``system.followers``); balls and free joints are to be taken apart in a
    chart that suits their motion (``system.charted``).
    Raises UnsupportedError for links that bend in two planes or twist, for joints that turn in space, and for loops beside links
    that bend.
    """

    def __init__(self, system: System, *, law: Callable[..., float] | None = None, planar: bool = True) -> None:
        if not system.coordinate_names:
            raise InputError(f"{system.name}: nothing moves", mend="give at least one revolute or prismatic joint")
        system = mimics_apart(screws_apart(system))
        # Loops are this model's own; what else has none may not be joined by them.
        loops = system.loops
        system = one_degree(replace(system, loops=()), "a computation of many copies at once")
        system = replace(system, loops=loops) if loops else system
        for link in system.links:
            if link.beam is not None and (link.beam.bending2 or link.beam.torsion_modes):
                raise UnsupportedError(
                    f"link {link.name}: lanes of a link that bends in two planes or twists",
                    mend="leave one bending plane, or use Denoc.simulate",
                )
        self.system = system
        self.names = system.coordinate_names
        self.n = len(self.names)
        slots: dict[tuple[str, str], int] = {("base", name): k for k, name in enumerate(BASE_SLOTS)}
        at = len(BASE_SLOTS)
        for joint, link in zip(system.joints, system.links, strict=True):
            for name in PLACEMENT_SLOTS:
                slots[joint.name, name] = at
                at += 1
            for name in INERTIA_SLOTS:
                # A link may share its joint's name; their parameters have different ones.
                slots[link.name, name] = at
                at += 1
        for joint in system.movable_joints:
            for name in laws.SLOT_NAMES:
                slots[joint.name, name] = at
                at += 1
        for link in system.links:
            if link.beam is not None:
                names = [*BEAM_SLOTS, *[""] * (BEAM_HEAD - len(BEAM_SLOTS))]
                names += [f"modal_damping_{k + 1}" for k in range(link.beam.modes)]
                for k, name in enumerate(names):
                    if name:
                        slots[link.name, name] = at + k
                at += beam_block_size(link.beam.modes)
        for joint in system.joints:
            if joint.parent != system.base and system.link(joint.parent).flexible:
                at += section_table_size(_modes(system.link(joint.parent)))
        self._beyond: Beyond | None = beyond(system)
        numbers = at
        for group in system.gimbals:
            for k, name in enumerate(GROUP_SLOTS):
                slots[group.name, name] = at + k
            at += GROUP_NUMBERS
        if self._beyond is not None:
            for k, name in enumerate(self._beyond.loop_names):
                own = numbers + self._beyond.before_loops + LOOP_NUMBERS * k
                slots[name, "gap"] = own
                for place, law_name in enumerate(GROUP_SLOTS):
                    # A joint of the same name keeps its laws.
                    slots.setdefault((name, law_name), own + TURNING + place)
            at = numbers + self._beyond.count
        self.P = at
        self.slots = MappingProxyType(slots)
        self._joints = [(j.name, j.type, j.parent, j.child) for j in system.joints]
        stated = ("armature", "damping", "coulomb_torque", "stiffness", "rest_angle")
        self._laws = [[slots[joint.name, name] for name in stated] for joint in system.movable_joints]
        links, tree, sizes, axes, nominal, turn = _topology(system, slots)
        self._tail = int(sizes[0])
        if self._beyond is not None:
            sizes = np.array([sizes[0] + self._beyond.room, sizes[1], self._beyond.count, self._tail, numbers])
        self.tables = links, tree, sizes, axes, nominal, turn
        self._plans: dict[bool, NDArray[np.int64]] = {}
        self._held: dict[frozenset[str], tuple[NDArray[np.int64], NDArray[np.int64]]] = {}
        self.plane = plane_of(system, self.tables[0], self.tables[1]) if planar else None
        self._law = law

    @cached_property
    def user(self) -> int:
        """Address of the user's own law, 0 without one; it is compiled when first asked for."""
        if self._law is None:
            return 0
        self._alive = compiled_law(self._law)
        return int(self._alive.address)

    def slot(self, site: str, name: str) -> int:
        """Index of one parameter in a row; InputError names what there is if there is no such parameter."""
        try:
            return self.slots[site, name]
        except KeyError:
            sites = sorted({s for s, _ in self.slots})
            if site not in sites:
                raise InputError(f"no site {site!r}", mend=f"one of {', '.join(sites)}") from None
            names = sorted(k for s, k in self.slots if s == site)
            raise InputError(f"{site} has no parameter {name!r}", mend=f"one of {', '.join(names)}") from None

    def row(self, system: System | None = None) -> Array:
        """Parameter row of a system of the same topology (by default the model's own), shape (P,)."""
        system = self.system if system is None else mimics_apart(screws_apart(system))
        if [(j.name, j.type, j.parent, j.child) for j in system.joints] != self._joints:
            raise InputError(f"{system.name}: not the joints of {self.system.name}", mend="make a LaneModel of its own")
        row = np.zeros(self.P)
        row[0:3] = system.gravity
        row[self.slot("base", "excitation_x")] = 1.0
        at = len(BASE_SLOTS)
        for joint, link, nominal in zip(system.joints, system.links, self.system.joints, strict=True):
            if joint.axis is not nominal.axis and not np.allclose(joint.axis, nominal.axis, rtol=0.0, atol=1e-12):
                raise InputError(
                    f"joint {joint.name}: another axis than in the model", mend="turn the joint frame instead"
                )
            row[at : at + 3] = joint.xyz
            if joint.rotation is not nominal.rotation and not np.array_equal(joint.rotation, nominal.rotation):
                row[at + 3 : at + 6] = _rotation_vector(nominal.rotation.T @ joint.rotation)
            row[at + 6 : at + 16] = _rigid_part(link)
            at += PER_JOINT
        for joint, places in zip(system.movable_joints, self._laws, strict=True):
            row[places] = joint.armature, joint.damping, joint.friction, joint.stiffness, joint.rest_position
        write_beams(row, system, self.slots, self.tables[0])
        if self._beyond is not None:
            row[self.P - self._beyond.count :] = self._beyond.numbers(system)
        return row

    def parts(self, rows: Array) -> Iterator[tuple[tuple[Any, ...], int, NDArray[np.int64]]]:
        """The kernels' tables and recursion, and which of the rows (B, P) they are for.

        Apart, so that a copy's equations do not depend on which others run beside it.
        """
        flat = np.zeros(len(rows), dtype=bool) if self.plane is None else self.plane.holds(rows)
        if self.plane is not None and flat.any():
            yield *self._around(self.plane.tables(self.tables), True), np.flatnonzero(flat)
        if not flat.all():
            yield *self._around(self.tables, False), np.flatnonzero(~flat)

    def _around(self, tables: tuple[Any, ...], in_plane: bool) -> tuple[tuple[Any, ...], int]:
        """Tables and recursion, with loops and what turns in space around the tree's where there are any."""
        recursion = _recursion(in_plane)
        if self._beyond is None:
            return tables, recursion
        links, tree, *others = tables
        return (links, marked(tree, self._plan(in_plane, recursion)), *others), _closed()

    def _plan(self, in_plane: bool, recursion: int) -> NDArray[np.int64]:
        if in_plane not in self._plans:
            assert self._beyond is not None
            self._plans[in_plane] = self._beyond.for_recursion(recursion, self._tail)
        return self._plans[in_plane]

    @property
    def dependent(self) -> tuple[str, ...]:
        """Coordinates that follow the others by the loops."""
        return self.following(())

    def following(self, parted: Collection[str]) -> tuple[str, ...]:
        """The same where the frames of some loops go free of each other within their clearance."""
        return () if self._beyond is None else tuple(self.names[k] for k in self._kept(frozenset(parted))[1])

    def _kept(self, parted: frozenset[str]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        if parted not in self._held:
            assert self._beyond is not None
            every = np.arange(len(self._beyond.dependent)), self._beyond.dependent
            self._held[parted] = self._beyond.kept(self.system, parted) if parted else every
        return self._held[parted]

    @property
    def placed(self) -> Array:
        """Positions (n,) where the system places itself, with loops closed."""
        return np.zeros(self.n) if self._beyond is None else self._beyond.stated.copy()

    def closed(self, rows: Array, states: Array, near: float = NEAR) -> Array:
        """States (B, 2 n), positions then velocities, with loops closed: ``dependent`` coordinates as the others ask for.

        From a state that is not nearly closed, one is reached from where the system places itself; nan where there is none.
        near: how far open, of the mechanism's size or in radians, a state may be to be closed from where it is.
        """
        if self._beyond is None or not self._beyond.loops:
            return states
        from harness.denoc.lanes.closed import close_states

        out = np.array(states, dtype=np.float64)
        ahead.ready("closed")
        rows = np.require(rows, np.float64, ["C", "W"])
        names = self._beyond.loop_names
        parted = rows[:, [self.slots[name, "gap"] for name in names]] > 0.0
        for pattern in np.unique(parted, axis=0):
            places = np.flatnonzero((parted == pattern).all(axis=1))
            own = out[places]
            close_states(
                rows[places], own, self._beyond.for_recursion(0, self._tail), self.tables[2], int(self.tables[2][0]),
                self._beyond.stated, self._beyond.dependent,
                *self._kept(frozenset(name for name, apart in zip(names, pattern, strict=True) if apart)),
                self._beyond.length, near,
            )  # fmt: skip
            out[places] = own
        return out

    def simulate(
        self,
        rows: Array,
        q0: Array,
        qd0: Array,
        time: Array,
        *,
        tau: Array | None = None,
        source: NDArray[np.intp] | None = None,
        hold: str = "linear",
        method: str = "adaptive",
        step: float | None = None,
        tolerance: float = TOLERANCE,
        counts: NDArray[np.int64] | None = None,
        threads: int = 1,
        between: Callable[[], None] | None = None,
    ) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of every copy at the sample times, each of shape (B, T, n).

        rows: parameter rows, (B, P) or (P,); q0, qd0: initial positions and velocities [rad, rad/s or m, m/s], (B, n) or (n,).
        time: sample times [s], increasing, not necessarily even, (T,); the motion starts at time[0].
        tau: applied generalized forces at the sample times, (T, n) or (B, T, n); between samples they run
            straight (``hold="linear"``) or keep the earlier value (``hold="zero"``).
        source: which of the forces, then (E, T, n), act on each copy, (B,).
        method: "adaptive" locates sudden changes and keeps to ``tolerance``; "exponential" is for smooth free motion of
            flexible links at evenly spaced times, with the fixed ``step`` (1 ms by default) that the swing needs and the
            vibration does not (``harness.denoc.lanes.exponential``). Halve the step to see what is left of its error.
            "rk4" is the classical Runge-Kutta method at evenly spaced times with that same step, without dry friction and stops.
        step: longest step [s]; within it the adaptive step follows the error estimate held under ``tolerance``.
        counts: how many of the sample times every copy is followed for, the adaptive method's, (B,); beyond them it is nan.
        threads: threads to spread the copies over. A copy's result depends neither on that nor on the other copies.
        between: called between parts of a long computation; what it raises ends it.
        A copy whose motion cannot be followed (not a number, negative inertia) is nan from there on.
        Acceleration at a jump is the one after it.
        Raises InputError for arrays that do not fit.
        """
        rows = np.atleast_2d(np.asarray(rows, dtype=np.float64))
        q0 = np.atleast_2d(np.asarray(q0, dtype=np.float64))
        qd0 = np.atleast_2d(np.asarray(qd0, dtype=np.float64))
        # Copies: a read-only array would be another type to the compiler.
        time = np.array(time, dtype=np.float64)
        n = self.n
        copies = max(len(rows), len(q0), len(qd0))
        for what, array, columns in (("rows", rows, self.P), ("q0", q0, n), ("qd0", qd0, n)):
            if array.ndim != 2 or array.shape[1] != columns or len(array) not in (1, copies):
                raise InputError(f"{what} has shape {array.shape}", mend=f"expected ({copies}, {columns})")
        if time.ndim != 1 or len(time) < 1 or not np.isfinite(time[[0, -1]]).all() or not (time[1:] > time[:-1]).all():
            raise InputError("sample times do not increase", mend="sort them and drop duplicates")
        if hold not in ("linear", "zero"):
            raise InputError(f"hold={hold!r}", mend="linear or zero")
        if method not in ("adaptive", "exponential", "rk4"):
            raise InputError(f"method={method!r}", mend="adaptive, exponential or rk4")
        if counts is None:
            counts = np.full(copies, len(time), dtype=np.int64)
        elif method != "adaptive" or counts.shape != (copies,) or counts.min() < 1 or counts.max() > len(time):
            raise InputError(
                "counts of sample times do not fit", mend=f"({copies},) of 1 … {len(time)}, adaptive method"
            )
        longest = (0.25 if method == "adaptive" else 1e-3) if step is None else float(step)
        if not longest > 0.0:
            raise InputError(f"step={step!r}", mend="a positive time in seconds")
        rows = np.require(rows if len(rows) == copies else np.repeat(rows, copies, axis=0), requirements=["C", "W"])
        start = np.empty((copies, 2 * n))
        start[:, :n], start[:, n:] = q0, qd0
        if self._beyond is not None and method == "exponential":
            raise UnsupportedError("loops or balls in the exponential method", mend="leave method out")
        start = self.closed(rows, start)
        if method == "exponential":
            from harness.denoc.lanes.exponential import simulate

            if tau is not None:
                raise UnsupportedError("the exponential method is for free motion", mend="leave method out")
            return simulate(self, rows, start, time, longest)
        driven, effort, acting = 0, np.zeros((1, 1, n)), np.zeros(copies, dtype=np.int64)
        if tau is not None:
            effort, acting = _forces(tau, source, copies, len(time), n)
            driven = 1
        if method == "rk4":
            from harness.denoc.lanes import fixed_step as lanes_fixed_step

            return lanes_fixed_step.simulate(
                self, rows, start, time, longest, tau=effort[acting], hold=int(hold == "linear"), threads=threads
            )
        # The shaking of the base bounds a copy's step: the error estimate could step over whole periods.
        limits = np.full(copies, longest)
        shaken = np.flatnonzero(rows[:, self.slot("base", "excitation_amplitude")])
        if len(shaken):
            frequency = np.abs(rows[shaken, self.slot("base", "excitation_frequency")])
            limits[shaken] = np.minimum(longest, 0.125 / np.maximum(frequency, 1e-300))
        # A sampled effort cuts the motion into pieces; where a step or two of order 5 span a piece, it is the cheaper one.
        piece = np.median(np.diff(time)) if driven and len(time) > 1 else np.inf
        order = 5 if piece < 7e-3 * (tolerance / 1e-10) ** (1.0 / 6.0) else 8
        law = self.user  # compiled here, and not by several threads
        shape = (copies, len(time), n)
        position, velocity, acceleration = np.empty(shape), np.empty(shape), np.empty(shape)

        def advance(tables: tuple[Any, ...], recursion: int, which: Any) -> None:
            """Advance some of the copies by the equations that the tables stand for."""
            whole = len(which) == copies
            out = [position, velocity, acceleration]
            mine, initial, longest_steps, pushed, asked = rows, start, limits, acting, counts
            if not whole:
                out = [array[which] for array in out]
                mine, initial, longest_steps = rows[which], start[which], limits[which]
                pushed, asked = acting[which], counts[which]

            def part(first: int, last: int) -> None:
                run(
                    first, last, mine, initial, recursion, *tables, law,
                    time, asked, effort, pushed, driven, int(hold == "linear"), longest_steps, tolerance, *step_method(order),
                    *out,
                )  # fmt: skip

            groups = -(-len(mine) // 8)
            workers = min(threads, groups)
            # At once, if that is not long.
            some = groups if between is None else max(LONG // len(time), workers, 1)
            for begin in range(0, groups, some):
                if begin and between is not None:
                    between()
                end = min(begin + some, groups)
                if workers <= 1:
                    part(begin, end)
                else:
                    # Many small parts, since groups differ in how long they take.
                    edges = np.linspace(begin, end, min(end - begin, 4 * workers) + 1).astype(int).tolist()
                    share(part, list(pairwise(edges)), workers)
            if not whole:
                position[which], velocity[which], acceleration[which] = out

        ahead.ready("lanes")
        from harness.denoc.lanes.integrate import run_groups as run

        for tables, recursion, which in self.parts(rows):
            advance(tables, recursion, which)
        return position, velocity, acceleration


def _forces(
    tau: Array, source: NDArray[np.intp] | None, copies: int, samples: int, n: int
) -> tuple[Array, NDArray[np.int64]]:
    """Forces (E, T, n) as the kernels want them, and which of them act on each copy, (B,)."""
    effort = np.require(tau, np.float64, ["C", "W"])
    effort = effort[None] if effort.ndim == 2 else effort
    if source is not None:
        if (
            effort.shape[1:] != (samples, n)
            or source.shape != (copies,)
            or not 0 <= source.min() <= source.max() < len(effort)
        ):
            raise InputError(f"source does not tell forces {np.shape(tau)} of {copies} copies", mend="0 … E − 1, (B,)")
        return effort, np.asarray(source, dtype=np.int64)
    if effort.shape not in ((1, samples, n), (copies, samples, n)):
        raise InputError(f"tau has shape {np.shape(tau)}", mend=f"expected ({samples}, {n}) or ({copies}, …)")
    return effort, np.arange(copies) if len(effort) > 1 else np.zeros(copies, dtype=np.int64)


def _rotation_vector(rotation: Array) -> Array:
    """Rotation vector [rad] of a rotation matrix, shape (3,)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_rotvec())


def _modes(link: Link) -> int:
    return 0 if link.beam is None else link.beam.modes


def _rigid_part(link: Link) -> Array:
    """Ten inertial parameters about the link's origin of what does not bend: mass, first and second moments, (10,)."""
    own = inertial_numbers(link)
    beam = link.beam
    if beam is None:
        return own
    l, f = beam.length, beam.direction
    second = beam.mass * l * l / 3.0 * (np.eye(3) - np.outer(f, f)) + beam.payload_inertia
    second = second + beam.payload * l * l * (np.eye(3) - np.outer(f, f))
    first = (beam.mass / 2.0 + beam.payload) * l * f
    taken = np.concatenate([[beam.mass + beam.payload], first, second[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]])
    left = own - taken
    # Differences of rounding are no hub.
    size = np.repeat([abs(own[0]), np.abs(own[1:4]).max(), np.abs(own[4:]).max()], [1, 3, 6])
    left[np.abs(left) < 1e-12 * size] = 0.0
    return left


def _topology(system: System, slots: Mapping[tuple[str, str], int]) -> tuple[Any, ...]:
    """What the kernels read of the topology: table of links, table of nodes, sizes, joint axes, nominal rotations."""
    carrier = {joint.child: k for k, joint in enumerate(system.joints)}
    links = np.full((len(system.joints), LINK_COLUMNS), -1, dtype=np.int64)
    nodes: list[list[int]] = []
    mothers: set[int] = set()
    coordinate = 0
    table = work = 0
    flexible = [link for link in system.links if link.beam is not None]
    section_row = 0
    if flexible:
        section_row = slots[flexible[-1].name, BEAM_SLOTS[0]] + beam_block_size(_modes(flexible[-1]))

    def add(parent: int, kind: int, own: int, m: int = 0, points: int = 0, row: int = 0, head: int = 0) -> int:
        nonlocal table, work
        # Only a joint's body chooses its axes so that its first child needs no turn about z.
        free = parent < 0 or nodes[parent][KIND] > PRISMATIC or parent in mothers
        mothers.add(parent)
        prefix = int(free and kind != SECTION)
        nodes.append([parent, kind, prefix, own, m, table, points, work, row, head, 0, 0])
        if kind == BEAM:
            table += beam_table_size(m, points)
            work += beam_work_size(m)
        elif kind == SECTION:
            table += section_table_size(m)
            work += section_work_size(m)
        return len(nodes) - 1

    for k, (joint, link) in enumerate(zip(system.joints, system.links, strict=True)):
        up = carrier.get(joint.parent, -1)
        links[k, ABOVE] = up
        here = -1 if up < 0 else int(links[up, NODE])
        if up >= 0 and links[up, BEAM_NODE] >= 0:
            beam = int(links[up, BEAM_NODE])
            m = nodes[beam][MODES]
            here = add(beam, SECTION, nodes[beam][COORDINATE], m, row=section_row, head=int(links[up, BEAM_ROW]))
            links[k, SECTION_NODE], links[k, SECTION_ROW] = here, section_row
            section_row += section_table_size(m)
        if joint.movable:
            here = add(here, PRISMATIC if joint.prismatic else REVOLUTE, coordinate)
            coordinate += 1
            links[k, LAW_ROW] = slots[joint.name, laws.SLOT_NAMES[0]]
        links[k, NODE] = here
        if link.beam is not None:
            m = link.beam.modes
            beam = add(here, BEAM, coordinate, m, most_points(m))
            links[k, BEAM_NODE] = beam
            links[k, BEAM_ROW] = head = slots[link.name, BEAM_SLOTS[0]]
            tip = head + beam_block_size(m) - section_table_size(m)
            links[k, TIP_NODE] = add(beam, SECTION, coordinate, m, row=tip, head=head)
            coordinate += m
    tree = np.array(nodes, dtype=np.int64).reshape(-1, COLUMNS)
    tree[:, WORK] += coordinate * JOINT + GROUP + len(nodes) * BODY
    # Without ``lanes.closed``, no numbers of a row are copied anywhere.
    sizes = np.array([coordinate * JOINT + GROUP + len(nodes) * BODY + work, table, 0, 0, 0], dtype=np.int64)
    axes = np.array([joint.axis for joint in system.joints], dtype=np.float64)
    nominal = np.array([joint.rotation for joint in system.joints], dtype=np.float64)
    return links, tree, sizes, axes, nominal, np.eye(3)
