"""Adaptive Runge-Kutta of order 8 with dense output, and dry friction that sticks.

The method is data: Dormand and Prince's 8(5,3) pair with its interpolant of order 7 (Hairer, Nørsett and Wanner, Solving
Ordinary Differential Equations I, II.5 and II.6), whose coefficients SciPy publishes as attributes of ``DOP853``.

Dry friction is set-valued: a joint either slides, with friction of full size against its velocity, or rests, with what
force it takes within ±limit. Between events the motion is smooth. Events are located on the dense output: a sliding
joint comes to rest, or a resting joint needs more than its limit. At an event the joints at rest are sorted into
staying and going by Murty's least-index method for the box-constrained linear complementarity problem that several
joints at rest pose together. A resting joint is locked by an armature so large that its acceleration vanishes, which
costs nothing, and what it is short of vanishing, times that armature, is the force the lock takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import DOP853

from harness.denoc.compiling.compiled import internal, stepper
from harness.denoc.motion.fixed_step import DIVERGED, copy_from, force_at
from harness.denoc.recursion.binding import RATES, SETTLE, header_at
from harness.denoc.recursion.dynamics_call import call
from harness.denoc.recursion.rows import ARMATURE

Vector = Any
Matrix = Any

STAGES = 12
A = np.zeros((16, 16))
A[:12, :12] = DOP853.A
A[12, :12] = DOP853.B
A[13:, :] = DOP853.A_EXTRA
C = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
E3, E5, DENSE = np.array(DOP853.E3), np.array(DOP853.E5), np.array(DOP853.D)

LOCK = 1e30
SLIDING_BACK, FREE, SLIDING_ON, RESTING = -1, 0, 1, 2
STEP_UNDERFLOW, UNDECIDED = -4, -5

# Places in a step where velocities and holding forces are looked at.
_PARTS = 4
_EVENTS = 1_000_000
# A joint breaks loose a little late, so that rounding does not put it back to rest at once.
_MARGIN = 1e-9


@internal
def rates(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    applied: Vector,
    force: Vector,
    dy: Vector,
) -> int:
    """dy/dt of y = (q, v): friction of sliding joints acts, resting joints do not move."""
    n = len(applied)
    nq = len(y) - n
    for i in range(n):
        force[i] = applied[i] - mode[i] * limit[i] if mode[i] != RESTING else applied[i]
    at = y.ctypes.data
    status = call(function, model, at, at + 8 * nq, force.ctypes.data, dy.ctypes.data + 8 * nq)
    positions = header_at(model)[RATES]
    if positions != 0:
        # Positions on a manifold have rates of their own; a resting joint's velocity is zero.
        call(positions, model, at, at + 8 * nq, 0, dy.ctypes.data)
    else:
        for i in range(n):
            dy[i] = y[nq + i] if mode[i] != RESTING else 0.0
    return status


@internal
def needed(mode: Vector, dy: Vector, i: int) -> float:
    """Force that a resting joint would move with, and that friction has to balance."""
    return dy[len(dy) - len(mode) + i] * LOCK


@internal
def hold(rows: Matrix, row_of: Vector, armature: Vector, mode: Vector, i: int, new: int) -> None:
    """Set the state of joint i, and with it the lock."""
    mode[i] = new
    rows[row_of[i], ARMATURE] = LOCK if new == RESTING else armature[i]


@internal
def sort_resting(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    armature: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    applied: Vector,
    force: Vector,
    dy: Vector,
) -> int:
    """Decide for every joint with friction and velocity zero whether it rests, slides on or slides back."""
    n = len(mode)
    nq = len(y) - n
    for i in range(n):
        if limit[i] > 0.0 and y[nq + i] == 0.0:
            hold(rows, row_of, armature, mode, i, RESTING)
    for _ in range(100 * (n + 1)):
        status = rates(function, model, rows, row_of, mode, limit, y, applied, force, dy)
        if status != 0:
            return status
        settled = True
        for i in range(n):
            if not (limit[i] > 0.0 and y[nq + i] == 0.0):
                continue
            if mode[i] == RESTING:
                short = needed(mode, dy, i)
                if abs(short) > limit[i]:
                    hold(rows, row_of, armature, mode, i, SLIDING_ON if short > 0.0 else SLIDING_BACK)
                    settled = False
                    break
            elif dy[nq + i] * mode[i] < 0.0:
                hold(rows, row_of, armature, mode, i, RESTING)
                settled = False
                break
        if settled:
            return 0
    return UNDECIDED


@internal
def interpolate(dense: Matrix, y0: Vector, x: float, out: Vector) -> None:
    """State at share x of the step."""
    for i in range(len(out)):
        out[i] = number_at(dense, y0, x, i)


@internal
def number_at(dense: Matrix, y0: Vector, x: float, i: int) -> float:
    """Number i of the state at share x of the step."""
    value = 0.0
    for r in range(7):
        value += dense[6 - r, i]
        value *= x if r % 2 == 0 else 1.0 - x
    return value + y0[i]


@stepper
def dormand_prince8(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    armature: Vector,
    limit: Vector,
    time: Vector,
    tau: Matrix,
    linear: bool,
    rtol: float,
    atol: float,
    longest: float,
    position: Matrix,
    velocity: Matrix,
    acceleration: Matrix,
    counts: Vector,
) -> int:
    """Integrate from position[0], velocity[0] over ``time``; forces given at samples are never stepped across.

    position (T, nq), velocity (T, n).
    row_of, armature, limit (n,): row and armature of each joint coordinate, and its dry friction (0: none).
    acceleration (T, n): with friction, as it is then; without, left alone. counts: steps, rejected steps, events.
    """
    nq, n = position.shape[1], velocity.shape[1]
    n2 = nq + n
    settle = header_at(model)[SETTLE]
    y, new, probe = np.zeros(n2), np.zeros(n2), np.zeros(n2)
    stages = np.zeros((16, n2))
    dense = np.zeros((7, n2))
    applied, force, scratch = np.zeros(n), np.zeros(n), np.zeros(n2)
    mode = np.zeros(n, dtype=np.int64)
    friction = False
    copy_from(position[0], 0, y[:nq])
    copy_from(velocity[0], 0, y[nq:])
    for i in range(n):
        if limit[i] > 0.0:
            friction = True
            if y[nq + i] != 0.0:
                mode[i] = SLIDING_ON if y[nq + i] > 0.0 else SLIDING_BACK
    driven = len(tau) > 0
    force_at(tau, linear, 0, 0.0, applied)
    status = 0
    if friction:
        status = sort_resting(function, model, rows, row_of, armature, mode, limit, y, applied, force, scratch)
    sample = 1
    last_sample = len(time) - 1
    now = time[0]
    if friction:
        copy_from(scratch, nq, acceleration[0])
    h = 0.0
    known = False
    while sample <= last_sample and status == 0:
        end = time[sample] if driven else time[last_sample]
        interval = sample - 1
        width = time[sample] - time[interval]
        if not known:
            share = (now - time[interval]) / width
            force_at(tau, linear, interval, share, applied)
            status = rates(function, model, rows, row_of, mode, limit, y, applied, force, stages[0])
            if status != 0:
                break
            known = True
        if friction and _stalled(mode, y, stages):
            counts[2] += 1
            status = sort_resting(function, model, rows, row_of, armature, mode, limit, y, applied, force, stages[0])
            if status != 0:
                break
        if h == 0.0:
            h = _first_step(function, model, rows, row_of, mode, limit, y, applied, force, stages, new, rtol, atol)
        floor = 1e-15 * max(abs(now), abs(end))
        h = min(h, longest)
        step = h
        lands = False
        if now + step >= end - floor or now + 1.01 * step >= end:
            step, lands = end - now, True
        # Twelve stages and the first of the next step.
        for s in range(1, STAGES + 1):
            status = _stage(
                function, model, rows, row_of, mode, limit, y, tau, linear, interval,
                now, step, time[interval], width, applied, force, s, new, stages,
            )  # fmt: skip
            if status != 0:
                break
        if status != 0:
            break
        error5, error3 = 0.0, 0.0
        for i in range(n2):
            scale = atol + rtol * max(abs(y[i]), abs(new[i]))
            five, three = 0.0, 0.0
            for r in range(STAGES + 1):
                five += E5[r] * stages[r, i]
                three += E3[r] * stages[r, i]
            error5 += (five / scale) ** 2
            error3 += (three / scale) ** 2
        error = 0.0
        if error5 > 0.0 or error3 > 0.0:
            error = step * error5 / np.sqrt((error5 + 0.01 * error3) * n2)
        if not error <= 1.0:
            counts[1] += 1
            shrink = 0.2 if not np.isfinite(error) else max(0.2, 0.9 * error ** (-1.0 / 8.0))
            h = step * shrink
            if h < 16.0 * floor or counts[1] > 1000 * (counts[0] + 100):
                return STEP_UNDERFLOW
            continue
        counts[0] += 1
        grow = 10.0 if error == 0.0 else min(10.0, max(0.2, 0.9 * error ** (-1.0 / 8.0)))
        after = now + step if not lands else end
        # Dense output only where someone asks for it: samples inside the step, or friction's events.
        wanted = friction or (sample <= last_sample and time[sample] < after)
        if wanted:
            for s in range(STAGES + 1, 16):
                status = _stage(
                    function, model, rows, row_of, mode, limit, y, tau, linear, interval,
                    now, step, time[interval], width, applied, force, s, probe, stages,
                )  # fmt: skip
                if status != 0:
                    break
            if status != 0:
                break
            for i in range(n2):
                delta = new[i] - y[i]
                dense[0, i] = delta
                dense[1, i] = step * stages[0, i] - delta
                dense[2, i] = 2.0 * delta - step * (stages[12, i] + stages[0, i])
                for r in range(4):
                    value = 0.0
                    for s in range(16):
                        value += DENSE[r, s] * stages[s, i]
                    dense[3 + r, i] = step * value
        share = 1.0
        happened = -1
        if friction:
            share, happened, status = _first_event(
                function, model, rows, row_of, mode, limit, y, new, dense, tau, linear, interval,
                now - time[interval], step, width, applied, force, probe, scratch, atol,
            )  # fmt: skip
            if status != 0:
                break
            if happened >= 0:
                after = now + share * step
                lands = lands and share == 1.0
        while sample <= last_sample and (time[sample] < after or (happened < 0 and lands and time[sample] <= after)):
            if time[sample] < after:
                interpolate(dense, y, (time[sample] - now) / step, probe)
            else:
                copy_from(new, 0, probe)
            if settle != 0:
                status = call(settle, model, probe.ctypes.data, probe.ctypes.data + 8 * nq, 0, 0)
            copy_from(probe, 0, position[sample])
            copy_from(probe, nq, velocity[sample])
            if friction:
                force_at(tau, linear, interval, (time[sample] - time[interval]) / width, applied)
                status = rates(function, model, rows, row_of, mode, limit, probe, applied, force, scratch)
                copy_from(scratch, nq, acceleration[sample])
            sample += 1
        if happened >= 0:
            counts[2] += 1
            if counts[2] > _EVENTS:
                status = UNDECIDED
                break
            if share < 1.0:
                interpolate(dense, y, share, new)
            for i in range(n):
                if mode[i] == RESTING or i == happened:
                    new[nq + i] = 0.0
            copy_from(new, 0, y)
            now = after
            share = (now - time[interval]) / width
            force_at(tau, linear, interval, min(share, 1.0), applied)
            status = sort_resting(function, model, rows, row_of, armature, mode, limit, y, applied, force, scratch)
            known = False
            h = max(0.1 * step, 1e-6 * h)
            while sample <= last_sample and time[sample] <= now:
                copy_from(y, 0, position[sample])
                copy_from(y, nq, velocity[sample])
                copy_from(scratch, nq, acceleration[sample])
                sample += 1
            continue
        copy_from(new, 0, y)
        if settle != 0:
            status = call(settle, model, y.ctypes.data, y.ctypes.data + 8 * nq, 0, 0)
        now = after
        h = step * grow if not lands else max(h, step * grow)
        if driven and lands:
            # Forces may jump at a sample, and with them the acceleration, and who rests.
            known = False
            if friction and sample <= last_sample:
                force_at(tau, linear, sample - 1, 0.0, applied)
                status = sort_resting(function, model, rows, row_of, armature, mode, limit, y, applied, force, scratch)
                copy_from(scratch, nq, acceleration[sample - 1])
        else:
            copy_from(stages[STAGES], 0, stages[0])
        finite = 0.0
        for i in range(n2):
            finite += 0.0 * y[i]
        if not np.isfinite(finite):
            status = DIVERGED
    for i in range(n):
        if limit[i] > 0.0:
            rows[row_of[i], ARMATURE] = armature[i]
    return status


@internal
def _stage(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    tau: Matrix,
    linear: bool,
    interval: int,
    now: float,
    step: float,
    begin: float,
    width: float,
    applied: Vector,
    force: Vector,
    s: int,
    at: Vector,
    stages: Matrix,
) -> int:
    """Rates of stage s, to ``stages``, at the state that those before it lead to, which is left in ``at``."""
    for i in range(len(y)):
        value = 0.0
        for r in range(s):
            value += A[s, r] * stages[r, i]
        at[i] = y[i] + step * value
    force_at(tau, linear, interval, (now + C[s] * step - begin) / width, applied)
    return rates(function, model, rows, row_of, mode, limit, at, applied, force, stages[s])


@internal
def _stalled(mode: Vector, y: Vector, stages: Matrix) -> bool:
    """Bring to rest the joints that have come to a stop within rounding and are still slowing down."""
    n = len(mode)
    nq = len(y) - n
    found = False
    for i in range(n):
        sliding = mode[i] == SLIDING_ON or mode[i] == SLIDING_BACK
        if sliding and y[nq + i] * mode[i] <= 0.0 and stages[0, nq + i] * mode[i] < 0.0:
            y[nq + i] = 0.0
            found = True
    return found


@internal
def _first_step(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    applied: Vector,
    force: Vector,
    stages: Matrix,
    trial: Vector,
    rtol: float,
    atol: float,
) -> float:
    """First step by the recipe of Hairer, Nørsett and Wanner, II.4."""
    n2 = len(y)
    d0, d1, d2 = 0.0, 0.0, 0.0
    for i in range(n2):
        scale = atol + rtol * abs(y[i])
        d0 += (y[i] / scale) ** 2
        d1 += (stages[0, i] / scale) ** 2
    d0, d1 = np.sqrt(d0 / n2), np.sqrt(d1 / n2)
    h0 = 1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
    for i in range(n2):
        trial[i] = y[i] + h0 * stages[0, i]
    if rates(function, model, rows, row_of, mode, limit, trial, applied, force, stages[1]) != 0:
        return h0
    for i in range(n2):
        scale = atol + rtol * abs(y[i])
        d2 += ((stages[1, i] - stages[0, i]) / scale) ** 2
    d2 = np.sqrt(d2 / n2) / h0
    h1 = max(1e-6, h0 * 1e-3) if max(d1, d2) <= 1e-15 else (0.01 / max(d1, d2)) ** (1.0 / 8.0)
    return min(100.0 * h0, h1)


@internal
def _first_event(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    new: Vector,
    dense: Matrix,
    tau: Matrix,
    linear: bool,
    interval: int,
    begin: float,
    step: float,
    width: float,
    applied: Vector,
    force: Vector,
    probe: Vector,
    scratch: Vector,
    slack: float,
) -> tuple[float, int, int]:
    """Share of the step at which the first joint comes to rest or breaks loose, that joint (-1: none), and a status."""
    n = len(mode)
    nq = len(y) - n
    first, who = 1.0, -1
    for i in range(n):
        direction = mode[i]
        if direction != SLIDING_ON and direction != SLIDING_BACK:
            continue
        low = -1.0
        for k in range(_PARTS + 1):
            here = k / _PARTS
            v = y[nq + i] if k == 0 else new[nq + i] if k == _PARTS else number_at(dense, y, here, nq + i)
            if v * direction > 0.0:
                low = here
            elif low >= 0.0:
                high = here
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    if number_at(dense, y, middle, nq + i) * direction > 0.0:
                        low = middle
                    else:
                        high = middle
                    if high - low < 1e-15:
                        break
                if high < first or who < 0:
                    first, who = high, i
                break
            elif k > 0 and v * direction < -slack:
                # Set going, it went the other way: sort it out here.
                if here < first or who < 0:
                    first, who = here, i
                break
    for i in range(n):
        if mode[i] != RESTING:
            continue
        previous = 0.0
        for k in range(1, _PARTS + 1):
            right = min(first, k / _PARTS)
            over, status = _excess(
                function, model, rows, row_of, mode, limit, y, dense, tau, linear, interval, begin, step, width,
                applied, force, probe, scratch, right, i,
            )  # fmt: skip
            if status != 0:
                return first, who, status
            if over > 0.0:
                low, high = previous, right
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    over, status = _excess(
                        function, model, rows, row_of, mode, limit, y, dense, tau, linear, interval, begin, step, width,
                        applied, force, probe, scratch, middle, i,
                    )  # fmt: skip
                    if over > 0.0:
                        high = middle
                    else:
                        low = middle
                    if high - low < 1e-15:
                        break
                if high < first or who < 0:
                    first, who = high, i
                break
            previous = right
            if right >= first:
                break
    return first, who, 0


@internal
def _excess(
    function: int,
    model: int,
    rows: Matrix,
    row_of: Vector,
    mode: Vector,
    limit: Vector,
    y: Vector,
    dense: Matrix,
    tau: Matrix,
    linear: bool,
    interval: int,
    begin: float,
    step: float,
    width: float,
    applied: Vector,
    force: Vector,
    probe: Vector,
    scratch: Vector,
    share: float,
    i: int,
) -> tuple[float, int]:
    """By how much a resting joint needs more than its limit at a share of the step."""
    interpolate(dense, y, share, probe)
    force_at(tau, linear, interval, (begin + share * step) / width, applied)
    status = rates(function, model, rows, row_of, mode, limit, probe, applied, force, scratch)
    return abs(needed(mode, scratch, i)) - limit[i] * (1.0 + _MARGIN), status
