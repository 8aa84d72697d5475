"""Free motion of flexible copies with a fixed step that need not resolve their vibration: an exponential Adams method.

The equations of motion ẏ = f(y) are split into L y, their linearization at the start, and the rest N(y). The vibration is in L
and is carried over a step by its matrix exponential, exactly; N changes with the swing, and is extrapolated from its
last four values, so that a step costs one evaluation of the accelerations. Order 4 in what N does within a step.

Source: Nørsett, An A-stable modification of the Adams-Bashforth methods (1969); Cox and Matthews, Exponential time
differencing for stiff systems, J. Comput. Phys. 176 (2002) 430–455.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.copies import Copies
from harness.denoc.lanes.group import prepare_group
from harness.denoc.lanes.nodes import CONSTANTS, FREE, JOINT, QD, QDD, SHAKE, TAU, TIME, Q
from harness.denoc.lanes.threads import share
from harness.denoc.simd.vector import (
    address_of,
    call_recursion,
    choose,
    lane_stepper,
    load,
    magnitude,
    spread,
    store,
    vectors,
)
from harness.errors import InputError, UnsupportedError

Array = NDArray[np.float64]

ORDER = 4
# Share of a coordinate's range that the last term of a step may have; what N does is then too fast for the step.
LARGEST = 1e-2
SUDDEN = (
    "coulomb_torque", "static_torque", "mu_radius", "dahl_torque", "quadratic_drag", "stop_stiffness", "stop_damping",
)  # fmt: skip
# Of the linearization [rad, rad/s]; its error goes into N, and so into nothing.
SMALL = 1e-6


def simulate(model: Copies, rows: Array, start: Array, time: Array, step: float) -> tuple[Array, Array, Array]:
    """Position, velocity, acceleration (B, T, n) of rows (B, P) from start (B, 2n); see ``LaneModel.simulate``.

    Raises UnsupportedError where the motion has sudden changes (dry friction, stops), InputError for uneven times.
    """
    for name in SUDDEN:
        for joint in model.system.movable_joints:
            if np.any(rows[:, model.slot(joint.name, name)]):
                raise UnsupportedError(
                    f"joint {joint.name}: {name} changes the motion suddenly, the exponential method wants it smooth",
                    mend="leave method out",
                )
    interval = np.diff(time)
    if len(time) < 2 or np.abs(interval - interval[0]).max() > 1e-9 * interval[0]:
        raise InputError("the exponential method wants evenly spaced sample times", mend="leave method out")
    inner = max(1, int(np.ceil(interval[0] / step * (1.0 - 1e-9))))
    position, velocity, acceleration, worst = march(model, rows, start, time, inner, linearization(model, rows, start))
    reach = np.abs(position).max(axis=1)
    lost = ~(worst <= LARGEST * reach + 1e-12).all(axis=1)
    position[lost, 1:], velocity[lost, 1:], acceleration[lost, 1:] = np.nan, np.nan, np.nan
    return position, velocity, acceleration


def smooth(model: Copies, rows: Array) -> NDArray[np.bool_]:
    """Which rows (B, P) have no sudden changes, shape (B,)."""
    slots = [model.slot(joint.name, name) for joint in model.system.movable_joints for name in SUDDEN]
    return np.asarray(~rows[:, slots].any(axis=1), dtype=np.bool_)


def march(
    model: Copies, rows: Array, start: Array, time: Array, inner: int, linear: Array, *, tau: Array | None = None,
    threads: int = 1,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Position, velocity, acceleration (B, T, n) at even times, ``inner`` steps apart, and the last term's size (B, n).

    linear: from ``linearization``; tau: generalized forces at the times, straight between them, (B, T, n).
    The last term of a step, at its greatest, tells how far the step's order is used up.
    """
    copies, n = len(rows), model.n
    h = float(time[1] - time[0]) / inner
    begun = np.empty((copies, ORDER, 2 * n))
    early = time[0] + h * np.arange(ORDER)
    forces, known = np.zeros((copies, 1, n)), np.zeros((copies, 1, n))
    if tau is not None:
        # What the efforts do to the mechanism as it stands at the start is known over the whole step, kinks at samples and all.
        forces, known = np.ascontiguousarray(tau), np.einsum("bij,btj->bti", _mobility(model, rows, start), tau)
    first = model.simulate(
        rows, start[:, :n], start[:, n:], early, tau=None if tau is None else _between(tau, inner), tolerance=1e-9,
        threads=threads,
    )  # fmt: skip
    begun[:, :, :n], begun[:, :, n:] = first[0], first[1]
    carried, driven = _weights(linear, h)
    law = model.user  # compiled here, and not by several threads
    shape = (copies, len(time), n)
    position, velocity, acceleration = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan)
    worst = np.zeros((copies, n))

    def advance(tables: tuple[Any, ...], recursion: int, which: Any) -> None:
        """Advance some of the copies by the equations that the tables stand for."""
        given = (
            rows[which], begun[which], np.ascontiguousarray(linear[which][:, n:]), carried[which], driven[which],
            forces[which], known[which],
        )  # fmt: skip
        out = [np.full((len(which), *shape[1:]), np.nan) for _ in range(3)] + [np.zeros((len(which), n))]

        def part(first: int, last: int) -> None:
            mine, initial, *weights = (array[first:last] for array in given)
            march_groups(
                mine, initial, recursion, *tables, law, *weights, float(time[0]), h, inner,
                *(array[first:last] for array in out),
            )  # fmt: skip

        groups = -(-len(which) // 8)
        workers = min(threads, groups)
        edges = np.linspace(0, groups, workers + 1).astype(int) * 8
        share(part, list(pairwise(edges.tolist())), workers)
        position[which], velocity[which], acceleration[which], worst[which] = out

    for tables, recursion, which in model.parts(rows):
        advance(tables, recursion, which)
    return position, velocity, acceleration, worst


def _between(tau: Array, inner: int) -> Array:
    """Efforts (B, 4, n) at the first steps, ``inner`` of them between two samples (B, T, n)."""
    place = np.arange(ORDER) / inner
    k = np.minimum(place.astype(int), tau.shape[1] - 2)
    share = (place - k)[None, :, None]
    return np.asarray(tau[:, k] * (1.0 - share) + tau[:, k + 1] * share)


def _mobility(model: Copies, rows: Array, start: Array) -> Array:
    """Accelerations by unit forces at the initial positions, the inverse mass matrix (B, n, n)."""
    copies, n = len(rows), model.n
    forces = np.concatenate([np.zeros((1, n)), np.eye(n)])
    q = np.repeat(start[:, :n], n + 1, axis=0)
    tau = np.repeat(np.tile(forces, (copies, 1))[:, None], 2, axis=1)
    shortly = np.array([0.0, SMALL])
    found = model.simulate(np.repeat(rows, n + 1, axis=0), q, np.zeros_like(q), shortly, tau=tau)[2][:, 0]
    found = found.reshape(copies, n + 1, n)
    return np.swapaxes(found[:, 1:] - found[:, :1], 1, 2)


def linearization(model: Copies, rows: Array, start: Array) -> Array:
    """∂f/∂y at the initial positions (B, 2n) and rest, (B, 2n, 2n), by central differences."""
    copies, n = len(rows), model.n
    at = np.concatenate([start[:, :n], np.zeros((copies, n))], axis=1)
    moved = at[:, None, None, :] + SMALL * np.array([1.0, -1.0])[:, None, None] * np.eye(2 * n)
    flat = moved.reshape(-1, 2 * n)
    when = np.array([0.0])
    found = model.simulate(np.repeat(rows, 4 * n, axis=0), flat[:, :n], flat[:, n:], when)[2].reshape(
        copies, 2, 2 * n, n
    )
    linear = np.zeros((copies, 2 * n, 2 * n))
    linear[:, :n, n:] = np.eye(n)
    linear[:, n:] = np.transpose((found[:, 0] - found[:, 1]) / (2.0 * SMALL), (0, 2, 1))
    return linear


def _weights(linear: Array, h: float) -> tuple[Array, Array]:
    """What carries y over a step, (B, 2n, 2n), and what N and its differences add, (B, 4, 2n, n).

    With φ_k = ∫ e^((1 − s) h L) s^(k−1) / (k − 1)! ds the weights are h φ₁, h φ₂, h (φ₃ + φ₂/2), h (φ₄ + φ₃ + φ₂/3).
    """
    size = linear.shape[1]
    n = size // 2
    # Velocities times the step: then h L is no larger than the vibration's angle in a step. In longer numbers, because what is
    # rounded here, differently for every copy, adds up over all steps, and copies are compared to find their derivatives.
    unit = np.concatenate([np.ones(n), np.full(n, h)]).astype(np.longdouble)
    z = h * linear.astype(np.longdouble) * unit[None, :, None] / unit[None, None, :]
    norm = float(np.abs(z).sum(axis=2).max())
    halvings = max(0, int(np.ceil(np.log2(max(norm, 1e-300)))))
    z = z / 2**halvings
    identity = np.broadcast_to(np.eye(size, dtype=np.longdouble), z.shape)
    # φ_k = Σ zⁱ / (i + k)!, by Horner for the last one; the terms left out are below 1/22!. Then φ_(k−1) = 1/(k − 1)! + z φ_k.
    last = identity / _factorial(18 + ORDER)
    for i in range(17, -1, -1):
        last = identity / _factorial(i + ORDER) + z @ last
    phi = [last]
    for k in range(ORDER - 1, -1, -1):
        phi.insert(0, identity / _factorial(k) + z @ phi[0])
    for _ in range(halvings):
        phi = [
            (phi[0] @ phi[k] + sum((phi[j] / _factorial(k - j) for j in range(1, k + 1)), np.zeros_like(z))) / 2**k
            for k in range(ORDER + 1)
        ]
    terms = [phi[1], phi[2], phi[3] + phi[2] / 2, phi[4] + phi[3] + phi[2] / 3]
    back = unit[None, None, :] / unit[None, :, None]
    driven = np.stack([h * (term * back)[:, :, n:] for term in terms], axis=1)
    # What grows beyond all numbers in a step is infinite, and so is its run.
    with np.errstate(over="ignore", invalid="ignore"):
        return np.ascontiguousarray(phi[0] * back, dtype=np.float64), np.ascontiguousarray(driven, dtype=np.float64)


def _factorial(k: int) -> np.longdouble:
    return np.longdouble(np.prod(np.arange(1, k + 1), dtype=np.longdouble))


@lane_stepper
def march_groups(
    rows: Any, begun: Any, recursion: int, links: Any, tree: Any, sizes: Any, axes: Any, nominal: Any, plane: Any,
    user: int, linear: Any, carried: Any, driven: Any, effort: Any, known: Any, start: float, h: float, inner: int,
    position: Any, velocity: Any, acceleration: Any, worst: Any,
) -> None:  # fmt: skip
    """March all rows, eight at a time; begun: the first states, (B, 4, 2n); linear: lower half of L, (B, n, 2n).

    effort: generalized forces at the samples, straight between them, and known: the accelerations that are known to come of
    them, (B, T, n) or (B, 1, n) of zeros.

    worst: greatest size of the last term of a step in every position, (B, n), written.
    """
    n = position.shape[2]
    width = 2 * n
    copies = rows.shape[0]
    steps = (position.shape[1] - 1) * inner
    constants = vectors(tree.shape[0] * CONSTANTS)
    beams = vectors(sizes[1])
    laws = vectors(n * law.WIDTH)
    ws = vectors(sizes[0])
    state = vectors(width)
    after = vectors(width)
    differences = vectors(ORDER * n)
    slope = vectors(n * width)
    carry = vectors(width * width)
    drive = vectors(ORDER * width * n)
    uncertain = vectors(n)
    given = vectors(2 * n)
    flags = np.zeros(n, dtype=np.int64)
    present = tree.copy()
    made = np.full(8, -1)
    group = n * JOINT * 8
    shake = ws[(n * JOINT + SHAKE) * 8 :]
    nothing: Any = np.int64(0)
    for g in range((copies + 7) // 8):
        lanes = min(8, copies - 8 * g)
        shaken = prepare_group(
            rows, 8 * g, lanes, links, tree, axes, nominal, plane, constants, beams, laws, shake, flags, present, made
        )
        for lane in range(8):
            source = 8 * g + min(lane, lanes - 1)
            for i in range(n):
                ws[(i * JOINT + FREE) * 8 + lane] = 1.0
            for r in range(width):
                for c in range(width):
                    carry[(r * width + c) * 8 + lane] = carried[source, r, c]
                    if r < n:
                        slope[(r * width + c) * 8 + lane] = linear[source, r, c]
                for k in range(ORDER):
                    for c in range(n):
                        drive[((r * ORDER + k) * n + c) * 8 + lane] = driven[source, k, r, c]
        for i in range(n):
            store(uncertain, i * 8, spread(0.0))
        for s in range(steps + 1):
            if s < ORDER:
                for lane in range(8):
                    source = 8 * g + min(lane, lanes - 1)
                    for f in range(width):
                        state[f * 8 + lane] = begun[source, s, f]
            for i in range(n):
                store(ws, (i * JOINT + Q) * 8, load(state, i * 8))
                store(ws, (i * JOINT + QD) * 8, load(state, (n + i) * 8))
            store(ws, group + TIME * 8, spread(start + s * h))
            if effort.shape[1] > 1:
                sample = s // inner
                following = min(sample + 1, effort.shape[1] - 1)
                part = (s - sample * inner) / inner
                for lane in range(8):
                    source = 8 * g + min(lane, lanes - 1)
                    for i in range(n):
                        here = effort[source, sample, i]
                        ws[(i * JOINT + TAU) * 8 + lane] = here + part * (effort[source, following, i] - here)
                        here = known[source, sample, i]
                        rise = known[source, following, i] - here
                        given[i * 8 + lane] = here + part * rise
                        given[(n + i) * 8 + lane] = rise / inner
            call_recursion(
                recursion, address_of(present, 0), present.shape[0], address_of(flags, 0), address_of(constants, 0),
                address_of(beams, 0), address_of(laws, 0), address_of(ws, 0), n, user, shaken, nothing,
            )  # fmt: skip
            if s % inner == 0:
                k = s // inner
                for lane in range(lanes):
                    for i in range(n):
                        position[8 * g + lane, k, i] = state[i * 8 + lane]
                        velocity[8 * g + lane, k, i] = state[(n + i) * 8 + lane]
                        acceleration[8 * g + lane, k, i] = ws[(i * JOINT + QDD) * 8 + lane]
            for i in range(n):
                rest = load(ws, (i * JOINT + QDD) * 8) - load(given, i * 8)
                for c in range(width):
                    rest = rest - load(slope, (i * width + c) * 8) * load(state, c * 8)
                for k in range(ORDER):
                    before = load(differences, (k * n + i) * 8)
                    store(differences, (k * n + i) * 8, rest)
                    rest = rest - before
            if s + 1 < ORDER:
                continue
            for r in range(width):
                total = spread(0.0)
                for c in range(width):
                    total = total + load(carry, (r * width + c) * 8) * load(state, c * 8)
                for e in range((ORDER - 1) * n):
                    total = total + load(drive, (r * ORDER * n + e) * 8) * load(differences, e * 8)
                last = spread(0.0)
                for e in range((ORDER - 1) * n, ORDER * n):
                    last = last + load(drive, (r * ORDER * n + e) * 8) * load(differences, e * 8)
                for c in range(n):
                    total = total + load(drive, (r * ORDER * n + c) * 8) * load(given, c * 8)
                    total = total + load(drive, (r * ORDER * n + n + c) * 8) * load(given, (n + c) * 8)
                store(after, r * 8, total + last)
                if r < n:
                    most = load(uncertain, r * 8)
                    store(uncertain, r * 8, choose(most - magnitude(last), most, magnitude(last)))
            for f in range(width):
                store(state, f * 8, load(after, f * 8))
        for lane in range(lanes):
            for i in range(n):
                worst[8 * g + lane, i] = uncertain[i * 8 + lane]
