"""Eight copies in time by the classical Runge-Kutta method with a fixed step, for comparison with engines that march so.

Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.1.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.copies import Copies
from harness.denoc.lanes.group import copy_numbers, prepare_group
from harness.denoc.lanes.nodes import CONSTANTS, FREE, JOINT, QD, QDD, SHAKE, TAU, TIME, Q
from harness.denoc.lanes.threads import share
from harness.denoc.simd.vector import address_of, call_recursion, lane_stepper, load, spread, store, vectors
from harness.errors import InputError, UnsupportedError

Array = NDArray[np.float64]

# What holds a joint or hits it: the method does not look for the instant.
LOCATED = ("coulomb_torque", "static_torque", "mu_radius", "dahl_torque", "stop_stiffness", "stop_damping")


def simulate(
    model: Copies, rows: Array, start: Array, time: Array, step: float, *, tau: Array, hold: int, threads: int = 1
) -> tuple[Array, Array, Array]:
    """Position, velocity, acceleration (B, T, n) of rows (B, P) from start (B, 2n); see ``LaneModel.simulate``.

    tau: generalized forces at the times, (1 or B, T, n), or of shape (1, 1, n) and zero; hold: 1 straight between them, 0 constant.
    Raises UnsupportedError where the motion has sudden changes (dry friction, stops), InputError for uneven times.
    """
    for joint in model.system.movable_joints:
        for name in LOCATED:
            if np.any(rows[:, model.slot(joint.name, name)]):
                raise UnsupportedError(
                    f"joint {joint.name}: {name} changes the motion suddenly, and steps of a fixed size pass over that",
                    mend="leave method out",
                )
    interval = np.diff(time)
    if len(time) > 1 and np.abs(interval - interval[0]).max() > 1e-9 * interval[0]:
        raise InputError("steps of a fixed size want evenly spaced sample times", mend="leave method out")
    between = float(interval[0]) if len(time) > 1 else step
    inner = max(1, int(np.ceil(between / step * (1.0 - 1e-9))))
    law = model.user  # compiled here, and not by several threads
    shape = (len(rows), len(time), model.n)
    position, velocity, acceleration = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan)

    def advance(tables: tuple[Any, ...], recursion: int, which: Any) -> None:
        """Advance some of the copies by the equations that the tables stand for."""
        mine, initial = rows[which], start[which]
        forces = tau[which] if len(tau) > 1 else tau
        out = [np.full((len(which), *shape[1:]), np.nan) for _ in range(3)]

        def part(first: int, last: int) -> None:
            march_groups(
                first, last, mine, initial, recursion, *tables, law, forces, hold,
                float(time[0]), between / inner, inner, *out,
            )  # fmt: skip

        groups = -(-len(which) // 8)
        edges = np.linspace(0, groups, min(threads, groups) + 1).astype(int)
        share(part, list(pairwise(edges.tolist())), min(threads, groups))
        position[which], velocity[which], acceleration[which] = out

    for tables, recursion, which in model.parts(rows):
        advance(tables, recursion, which)
    return position, velocity, acceleration


@lane_stepper
def march_groups(
    first: int, last: int, rows: Any, begun: Any, recursion: int, links: Any, tree: Any, sizes: Any, axes: Any,
    nominal: Any, plane: Any, user: int, effort: Any, hold: int, start: float, h: float, inner: int,
    position: Any, velocity: Any, acceleration: Any,
) -> None:  # fmt: skip
    """March the groups first … last − 1 of eight rows each; begun: positions then velocities, (B, 2n).

    effort: generalized forces at the samples, (1 or B, T, n), none if T = 1. inner: steps of length h between two samples.
    """
    n = position.shape[2]
    width = 2 * n
    copies = rows.shape[0]
    samples = position.shape[1]
    constants = vectors(tree.shape[0] * CONSTANTS)
    beams = vectors(sizes[1])
    laws = vectors(n * law.WIDTH)
    ws = vectors(sizes[0])
    state = vectors(width)
    at = vectors(width)
    total = vectors(width)
    flags = np.zeros(n, dtype=np.int64)
    present = tree.copy()
    made = np.full(8, -1)
    group = n * JOINT * 8
    shake = ws[(n * JOINT + SHAKE) * 8 :]
    nothing: Any = np.int64(0)
    for g in range(first, last):
        lanes = min(8, copies - 8 * g)
        shaken = prepare_group(
            rows, 8 * g, lanes, links, tree, axes, nominal, plane, constants, beams, laws, shake, flags, present, made
        )
        copy_numbers(rows, 8 * g, lanes, sizes, ws)
        for lane in range(8):
            source = 8 * g + min(lane, lanes - 1)
            for i in range(n):
                ws[(i * JOINT + FREE) * 8 + lane] = 1.0
                ws[(i * JOINT + TAU) * 8 + lane] = 0.0
                state[i * 8 + lane] = begun[source, i]
                state[(n + i) * 8 + lane] = begun[source, n + i]
        for s in range((samples - 1) * inner + 1):
            for f in range(width):
                store(at, f * 8, load(state, f * 8))
            for stage in range(4):
                reach = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
                for i in range(n):
                    store(ws, (i * JOINT + Q) * 8, load(at, i * 8))
                    store(ws, (i * JOINT + QD) * 8, load(at, (n + i) * 8))
                store(ws, group + TIME * 8, spread(start + (s + reach) * h))
                if effort.shape[1] > 1:
                    place = s // inner
                    part = (s - place * inner + reach) / inner * hold
                    following = min(place + 1, samples - 1)
                    for lane in range(8):
                        source = min(8 * g + min(lane, lanes - 1), effort.shape[0] - 1)
                        for i in range(n):
                            here = effort[source, place, i]
                            ws[(i * JOINT + TAU) * 8 + lane] = here + part * (effort[source, following, i] - here)
                call_recursion(
                    recursion, address_of(present, 0), present.shape[0], address_of(flags, 0), address_of(constants, 0),
                    address_of(beams, 0), address_of(laws, 0), address_of(ws, 0), n, user, shaken, nothing,
                )  # fmt: skip
                if stage == 0 and s % inner == 0:
                    k = s // inner
                    for lane in range(lanes):
                        for i in range(n):
                            position[8 * g + lane, k, i] = state[i * 8 + lane]
                            velocity[8 * g + lane, k, i] = state[(n + i) * 8 + lane]
                            acceleration[8 * g + lane, k, i] = ws[(i * JOINT + QDD) * 8 + lane]
                    if k == samples - 1:
                        break
                weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
                ahead = h if stage == 2 else 0.5 * h
                for i in range(n):
                    speed = load(at, (n + i) * 8)
                    push = load(ws, (i * JOINT + QDD) * 8)
                    before, rate = (load(state, i * 8), load(state, (n + i) * 8))
                    if stage == 0:
                        store(total, i * 8, before + weight * speed)
                        store(total, (n + i) * 8, rate + weight * push)
                    else:
                        store(total, i * 8, load(total, i * 8) + weight * speed)
                        store(total, (n + i) * 8, load(total, (n + i) * 8) + weight * push)
                    store(at, i * 8, before + ahead * speed)
                    store(at, (n + i) * 8, rate + ahead * push)
            for f in range(width):
                store(state, f * 8, load(total, f * 8))
