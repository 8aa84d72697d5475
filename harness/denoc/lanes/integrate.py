"""Eight copies in time: a Dormand-Prince method of order 8 or 5 with a step of its own in every lane, and events located in time.

A lane's step is cut where its motion changes its kind: a joint with dry friction comes to rest (it then sticks if
friction can hold it, else slides the other way), a held joint breaks loose, a stop is met or left. The instant is found on
the method's dense output, and the lane goes on from there; lanes wait for nobody, and the result of a
lane does not depend on which others run beside it.

Method: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, DOP853, and DOPRI5 where a
sampled effort cuts the motion into short pieces anyway (coefficients as scipy publishes them).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.joint_laws import laws as law
from harness.denoc.lanes.group import copy_numbers, prepare_group
from harness.denoc.lanes.nodes import (
    ANCHOR,
    CONSTANTS,
    CONTACT,
    DIRECTION,
    FREE,
    GRIP,
    HOLD,
    JOINT,
    LIMIT,
    QD,
    QDD,
    REACTION,
    REACTION_START,
    RESTS,
    SHAKE,
    SLIPS,
    SLIPS_END,
    SLIPS_START,
    TAU,
    TAU_SLOPE,
    TAU_TIME,
    TIME,
    Q,
)
from harness.denoc.simd.vector import (
    address_of,
    call_recursion,
    choose,
    inner,
    lane_stepper,
    load,
    magnitude,
    spread,
    square_root,
    store,
    vectors,
)

KEPT = 16  # slopes kept at most: the stages, the one at the end, those for the dense output
DEGREE = 7  # of the dense output
LOOKS = 8  # places in a step where signs are checked
# Steps after which a lane is given up: so many, and so many more for every sample asked for.
LONGEST, PER_SAMPLE = 50_000, 60
# Steps after which it is asked how far a lane has come, and how many it may need for the rest at that pace: where joints stick and
# slide by turns without end it stands still, and would take a thousand times longer than a lane that moves.
ASKED, HOPELESS = 500, 1e9

# Per-lane bookkeeping, in vectors of eight lanes.
CLOCK, STEP, USED, STALL, DIRTY, ALIVE, ERROR_5, ERROR_3, UNTIL, CUT, GRIPPED, SUSPECT, LOADED, MAY, WANTS = range(15)
# How far a step is taken, where in it a mode changes (fraction), of which joint and how; what is being sampled; a growth.
REACH, CHANGES, WHICH, WHAT, SAMPLED, GROWTH = range(15, 21)
KINK = 21  # 1 where dry friction turns round within the step, as what creeps or gives way does within little time
MARK = 22  # where a lane was when it was last asked how far it has come
LEDGER = 23

# Friction that is soft or creeps turns round within a ten thousandth of a second, which no stage may fall into. The estimate of
# such a step's error is too small, by fifty times as a rule and by ten thousand at worst, and counts this many times.
UNSEEN = 1e3


@inner
def _slopes(
    recursion: int, tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, width: int,
    user: int, shaken: int, loaded: int, dry: int, state: Any, slopes: Any, at: int, ledger: Any,
) -> None:  # fmt: skip
    """Time derivative of ``state`` (positions, velocities) at the workspace's time, to ``slopes[at:]``."""
    for i in range(n):
        j = i * JOINT * 8
        store(ws, j + Q * 8, load(state, i * 8))
        store(ws, j + QD * 8, load(state, (n + i) * 8))
    call_recursion(
        recursion, address_of(tree, 0), tree.shape[0], address_of(flags, 0), address_of(constants, 0),
        address_of(beams, 0), address_of(laws, 0), address_of(ws, 0), n, user, shaken, loaded,
    )  # fmt: skip
    for i in range(n):
        j = i * JOINT * 8
        store(slopes, at + i * 8, load(ws, j + QD * 8))
        store(slopes, at + (n + i) * 8, load(ws, j + QDD * 8))
    if dry:
        for i in range(n):
            if flags[i] & law.HAS_DRY:
                j = i * JOINT * 8
                for lane in range(8):
                    if ws[j + FREE * 8 + lane] == 0.0:
                        limit = ws[j + LIMIT * 8 + lane]
                        if abs(ws[j + HOLD * 8 + lane]) > limit * (1.0 + law.ALMOST):
                            ledger[SUSPECT * 8 + lane] = 1.0


@inner
def _note_kinks(ws: Any, flags: Any, laws: Any, n: int, state: Any, stage: Any, ledger: Any) -> None:
    """Mark the lanes where soft friction slips otherwise at a stage than where the step began, or friction that creeps turns round.

    How soft friction slips is kept: after the last stage, that is where the step ends.
    """
    for i in range(n):
        j = i * JOINT * 8
        kink = load(ledger, KINK * 8)
        if flags[i] & law.HAS_SOFT:
            slips = load(ws, j + SLIPS * 8)
            store(ws, j + SLIPS_END * 8, slips)
            kink = choose(magnitude(slips - load(ws, j + SLIPS_START * 8)), spread(1.0), kink)
        if flags[i] & law.HAS_CREEP:
            turned = choose(-(load(state, (n + i) * 8) * load(stage, (n + i) * 8)), spread(1.0), kink)
            kink = choose(load(laws, (i * law.WIDTH + law.CREEP) * 8), turned, kink)
        store(ledger, KINK * 8, kink)


@inner
def _polynomials(state: Any, slopes: Any, dense: Any, ledger: Any, width: int, weights: Any, weighed: Any) -> None:
    """Coefficients of the dense output in powers of the step's fraction, to ``dense[(power · width + row) · 8]``.

    weights: of the slopes in every power, shape (DEGREE, most), those that are not zero, and weighed: which slopes they are for.
    """
    h = load(ledger, USED * 8)
    for f in range(width):
        store(dense, f * 8, load(state, f * 8))
        for power in range(DEGREE):
            total = spread(0.0)
            for s in range(weighed[power, 0]):
                total = total + weights[power, s] * load(slopes, (weighed[power, s + 1] * width + f) * 8)
            store(dense, ((power + 1) * width + f) * 8, h * total)


@inner
def _at(dense: Any, width: int, row: int, lane: int, x: float) -> float:
    """One row of the dense output in one lane, at the fraction x of the step."""
    value = dense[(DEGREE * width + row) * 8 + lane]
    for power in range(DEGREE - 1, -1, -1):
        value = value * x + dense[(power * width + row) * 8 + lane]
    return value


@inner
def _slope_at(dense: Any, width: int, row: int, lane: int, x: float) -> float:
    """Derivative of one row of the dense output in one lane by the fraction x of the step."""
    slope = DEGREE * dense[(DEGREE * width + row) * 8 + lane]
    for power in range(DEGREE - 1, 0, -1):
        slope = slope * x + power * dense[(power * width + row) * 8 + lane]
    return slope


@inner
def _watched(
    dense: Any, laws: Any, n: int, width: int, i: int, lane: int, h: float, kind: int, sense: float, x: float
) -> float:
    """A function that is positive while a joint's mode holds: kind 0 its velocity along the sliding direction, kind 1 the stop."""
    if kind == 0:
        return sense * _at(dense, width, n + i, lane, x)
    q = _at(dense, width, i, lane, x)
    v = _at(dense, width, n + i, lane, x)
    vdot = _slope_at(dense, width, n + i, lane, x) / h
    return sense * law.stop_gap(laws, i * law.WIDTH * 8, lane, q, v, vdot)


@inner
def _root(
    dense: Any,
    laws: Any,
    n: int,
    width: int,
    i: int,
    lane: int,
    h: float,
    kind: int,
    sense: float,
    low: float,
    high: float,
) -> float:
    """Where a watched function turns negative within low … high (bisection, then the Illinois rule)."""
    f_low = _watched(dense, laws, n, width, i, lane, h, kind, sense, low)
    f_high = _watched(dense, laws, n, width, i, lane, h, kind, sense, high)
    side = 0
    for _ in range(80):
        if high - low < 1e-15:
            break
        middle = 0.5 * (low + high)
        if f_high != f_low:
            guess = (low * f_high - high * f_low) / (f_high - f_low)
            if low < guess < high:
                middle = guess
        f = _watched(dense, laws, n, width, i, lane, h, kind, sense, middle)
        if f < 0.0:
            high = middle
            f_high = f
            if side == -1:
                f_low *= 0.5
            side = -1
        elif f > 0.0:
            low = middle
            f_low = f
            if side == 1:
                f_high *= 0.5
            side = 1
        else:
            return middle
    return high


@inner
def _may_change(
    state: Any,
    after: Any,
    slopes: Any,
    laws: Any,
    ws: Any,
    flags: Any,
    n: int,
    width: int,
    stages: int,
    lane: int,
    h: float,
) -> bool:
    """Whether one lane's step might change a mode: a stop is there, or a velocity could reach zero twice over within it."""
    for i in range(n):
        j = i * JOINT * 8 + lane
        if flags[i] & law.HAS_STOP:
            start = i * law.WIDTH * 8 + lane
            if laws[start + law.STOP_STIFFNESS * 8] != 0.0 or laws[start + law.STOP_DAMPING * 8] != 0.0:
                return True
        if flags[i] & law.HAS_SIGN and ws[j + FREE * 8] != 0.0 and ws[j + DIRECTION * 8] != 0.0:
            row = (n + i) * 8 + lane
            steepest = max(abs(slopes[row]), abs(slopes[stages * width * 8 + row]))
            sense = ws[j + DIRECTION * 8]
            if not min(sense * state[row], sense * after[row]) > 2.0 * h * steepest:
                return True
    return False


@inner
def _first_event(
    dense: Any, laws: Any, ws: Any, flags: Any, n: int, width: int, lane: int, h: float
) -> tuple[float, int, int]:
    """Earliest change of mode in one lane's step of length h: (fraction, joint, kind); fraction 2 if there is none.

    A fraction of 0 means that the mode is already contradicted where the step began.
    """
    best = 2.0
    which = -1
    what = -1
    for i in range(n):
        j = i * JOINT * 8 + lane
        for kind in range(2):
            if kind == 0:
                if flags[i] & law.HAS_SIGN == 0 or ws[j + FREE * 8] == 0.0 or ws[j + DIRECTION * 8] == 0.0:
                    continue
                sense = ws[j + DIRECTION * 8]
            else:
                start = i * law.WIDTH * 8 + lane
                if flags[i] & law.HAS_STOP == 0 or (
                    laws[start + law.STOP_STIFFNESS * 8] == 0.0 and laws[start + law.STOP_DAMPING * 8] == 0.0
                ):
                    continue
                sense = 1.0 if ws[j + CONTACT * 8] > 0.0 else -1.0
            looks = LOOKS if kind == 0 else 2 * LOOKS
            low = 0.0
            began = _watched(dense, laws, n, width, i, lane, h, kind, sense, 0.0) > 0.0
            for look in range(1, looks + 1):
                # Up to the earliest change known, and not only up to the last look before it.
                x = min(look / looks, best)
                if x <= low:
                    break
                if _watched(dense, laws, n, width, i, lane, h, kind, sense, x) < 0.0:
                    where = 0.0
                    if look > 1 or began:
                        where = _root(dense, laws, n, width, i, lane, h, kind, sense, low, x)
                    if where < best:
                        best = where
                        which = i
                        what = kind
                    break
                low = x
    return best, which, what


@inner
def run_group(
    recursion: int, tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, width: int,
    user: int, shaken: int, loaded: int,
    time: Any, counts: Any, effort: Any, acting: Any, driven: int, hold: int, longest: Any, tolerance: float,
    table: Any, tabled: Any, fractions: Any, errors_5: Any, errors_3: Any, extra: Any, extras: Any, extra_fractions: Any,
    weights: Any, weighed: Any, exponent: float,
    state: Any, after: Any, slopes: Any, dense: Any, ledger: Any, next_sample: Any,
    lanes: int, first_lane: int, position: Any, velocity: Any, acceleration: Any,
) -> None:  # fmt: skip
    """Advance a group of up to eight lanes over the times asked of each, the first ``counts`` (B,), and write the samples.

    state: initial state, lane-contiguous, rows positions, velocities; effort: (E, T, n), if ``driven``; acting: which of them
    on each lane, (B,); hold: 1 linear between samples, 0 held.
    """
    group = n * JOINT * 8
    stages = table.shape[0] - 1
    dry: Any = np.int64(0)
    no: Any = np.int64(0)
    signed: Any = np.int64(0)
    stops: Any = np.int64(0)
    kinked: Any = np.int64(0)
    for i in range(n):
        if flags[i] & (law.HAS_SOFT | law.HAS_CREEP):
            kinked = 1
        if flags[i] & law.HAS_DRY:
            dry = 1
        if flags[i] & law.HAS_SIGN:
            signed = 1
        if flags[i] & law.HAS_STOP:
            stops = 1
    eventful = signed or stops
    for lane in range(8):
        source = first_lane + min(lane, lanes - 1)
        ledger[CLOCK * 8 + lane] = time[0]
        ledger[MARK * 8 + lane] = time[0]
        ledger[STEP * 8 + lane] = min(longest[source], 2e-3)
        ledger[STALL * 8 + lane] = 0.0
        ledger[DIRTY * 8 + lane] = 1.0
        ledger[ALIVE * 8 + lane] = 1.0 if lane < lanes else 0.0
        ledger[UNTIL * 8 + lane] = time[counts[source] - 1]
        ledger[LOADED * 8 + lane] = 0.0
        next_sample[lane] = 0
        for i in range(n):
            j = i * JOINT * 8 + lane
            start = i * law.WIDTH * 8
            ws[j + FREE * 8] = 1.0
            ws[j + DIRECTION * 8] = 0.0
            ws[j + CONTACT * 8] = 0.0
            ws[j + ANCHOR * 8] = state[i * 8 + lane]
            ws[j + GRIP * 8] = 0.0
            ws[j + REACTION_START * 8] = 0.0
            ws[j + REACTION * 8] = 0.0
            ws[j + SLIPS * 8] = 0.0
            ws[j + TAU * 8] = 0.0
            ws[j + TAU_SLOPE * 8] = 0.0
            used = law.terms_in_use(laws, start + lane, 8)
            v = state[(n + i) * 8 + lane]
            if used & law.HAS_LOAD:
                ledger[LOADED * 8 + lane] = 1.0
            if used & law.HAS_SIGN:
                ws[j + DIRECTION * 8] = -1.0 if v < 0.0 else 1.0
                if v == 0.0 and used & law.HAS_DRY:
                    ws[j + FREE * 8] = 0.0
                    ws[j + DIRECTION * 8] = 0.0
            if used & law.HAS_STOP and law.stop_gap(laws, start, lane, state[i * 8 + lane], v, 0.0) > 0.0:
                ws[j + CONTACT * 8] = 1.0
    for f in range(width):
        store(slopes, f * 8, spread(0.0))
    for taken in range(LONGEST + PER_SAMPLE * time.shape[0]):
        if taken > 0 and taken % ASKED == 0:
            for lane in range(lanes):
                t = ledger[CLOCK * 8 + lane]
                left = time[max(counts[first_lane + lane] - 1, 0)] - t
                if left * ASKED > HOPELESS * (t - ledger[MARK * 8 + lane]):
                    # Its samples stay what they were (nan).
                    ledger[ALIVE * 8 + lane] = 0.0
                ledger[MARK * 8 + lane] = t
        # Where a lane stands on a break of the effort, the next segment begins.
        anyone = 0
        dirty = 0
        for lane in range(lanes):
            if ledger[ALIVE * 8 + lane] == 0.0:
                continue
            t = ledger[CLOCK * 8 + lane]
            k = next_sample[lane]
            if (
                driven
                and k < counts[first_lane + lane] - 1
                and t >= time[k]
                and (k == 0 or ledger[UNTIL * 8 + lane] <= t)
            ):
                source = acting[first_lane + lane]
                ws[group + TAU_TIME * 8 + lane] = time[k]
                ledger[UNTIL * 8 + lane] = time[k + 1]
                for i in range(n):
                    j = i * JOINT * 8 + lane
                    ws[j + TAU * 8] = effort[source, k, i]
                    if hold:
                        ws[j + TAU_SLOPE * 8] = (effort[source, k + 1, i] - effort[source, k, i]) / (
                            time[k + 1] - time[k]
                        )
                if k == 0 or hold == 0:
                    ledger[DIRTY * 8 + lane] = 1.0
            if ledger[DIRTY * 8 + lane] != 0.0:
                dirty = 1
            anyone = 1
        if anyone == 0:
            break
        if dirty:
            # Settle the modes at this instant: who sticks, who slides which way.
            for lane in range(lanes):
                ledger[GRIPPED * 8 + lane] = 0.0
            for _ in range(4 * n + 4):
                store(ws, group + TIME * 8, load(ledger, CLOCK * 8))
                _slopes(
                    recursion, tree, flags, constants, beams, laws, ws, n, width, user, shaken, loaded, no,
                    state, slopes, width * 8 * KEPT, ledger,
                )  # fmt: skip
                changed = 0
                if dry:
                    for lane in range(lanes):
                        if ledger[DIRTY * 8 + lane] == 0.0:
                            continue
                        worst = 0.0
                        loose = -1
                        for i in range(n):
                            j = i * JOINT * 8 + lane
                            if ws[j + FREE * 8] == 0.0:
                                limit = ws[j + LIMIT * 8] * (1.0 + 2.0 * law.ALMOST)
                                over = abs(ws[j + HOLD * 8]) - limit
                                if over > worst:
                                    worst = over
                                    loose = i
                        if loose >= 0:
                            j = loose * JOINT * 8 + lane
                            ws[j + FREE * 8] = 1.0
                            ws[j + DIRECTION * 8] = -1.0 if ws[j + HOLD * 8] > 0.0 else 1.0
                            changed = 1
                        elif ledger[GRIPPED * 8 + lane] < 2.0 * n:
                            # Letting another joint go may turn round one that was let go before.
                            for i in range(n):
                                j = i * JOINT * 8 + lane
                                if (
                                    flags[i] & law.HAS_DRY
                                    and ws[j + FREE * 8] != 0.0
                                    and ws[j + DIRECTION * 8] != 0.0
                                    and state[(n + i) * 8 + lane] == 0.0
                                    and ws[j + LIMIT * 8] > 0.0
                                    and ws[j + DIRECTION * 8] * ws[j + QDD * 8] < -1e-9 * abs(ws[j + LIMIT * 8])
                                ):
                                    ws[j + FREE * 8] = 0.0
                                    ws[j + DIRECTION * 8] = 0.0
                                    ledger[GRIPPED * 8 + lane] += 1.0
                                    changed = 1
                                    break
                        # What cannot move beside joints that stick, as a mechanism is closed, comes to rest with them.
                        for i in range(n):
                            j = i * JOINT * 8 + lane
                            if flags[i] & law.HAS_DRY and ws[j + FREE * 8] != 0.0 and ws[j + HOLD * 8] == RESTS:
                                ws[j + FREE * 8] = 0.0
                                ws[j + DIRECTION * 8] = 0.0
                                state[(n + i) * 8 + lane] = 0.0
                                changed = 1
                if changed == 0:
                    break
            if kinked:
                for i in range(n):
                    j = i * JOINT * 8
                    store(ws, j + SLIPS_START * 8, load(ws, j + SLIPS * 8))
            for lane in range(lanes):
                if ledger[DIRTY * 8 + lane] != 0.0:
                    ledger[DIRTY * 8 + lane] = 0.0
                    for f in range(width):
                        slopes[f * 8 + lane] = slopes[(KEPT * width + f) * 8 + lane]
                    for i in range(n):
                        j = i * JOINT * 8 + lane
                        ws[j + REACTION_START * 8] = ws[j + REACTION * 8]
        # Samples that lie just where a lane stands; steps.
        anyone = 0
        for lane in range(8):
            ledger[USED * 8 + lane] = 0.0
            ledger[CUT * 8 + lane] = 0.0
            ledger[SUSPECT * 8 + lane] = 0.0
            if ledger[ALIVE * 8 + lane] == 0.0:
                continue
            t = ledger[CLOCK * 8 + lane]
            while next_sample[lane] < counts[first_lane + lane] and time[next_sample[lane]] <= t:
                k = next_sample[lane]
                for i in range(n):
                    position[first_lane + lane, k, i] = state[i * 8 + lane]
                    velocity[first_lane + lane, k, i] = state[(n + i) * 8 + lane]
                    acceleration[first_lane + lane, k, i] = slopes[(n + i) * 8 + lane]
                next_sample[lane] = k + 1
            if next_sample[lane] >= counts[first_lane + lane]:
                ledger[ALIVE * 8 + lane] = 0.0
                continue
            h = min(ledger[STEP * 8 + lane], longest[first_lane + lane])
            left = ledger[UNTIL * 8 + lane] - t
            if h >= left * (1.0 - 1e-9):
                h = left
                ledger[CUT * 8 + lane] = 1.0
            elif 2.0 * h > left:
                h = 0.5 * left
            ledger[USED * 8 + lane] = h
            anyone = 1
        if anyone == 0:
            continue
        # The stages.
        clock = load(ledger, CLOCK * 8)
        steps = load(ledger, USED * 8)
        if kinked:
            store(ledger, KINK * 8, spread(0.0))
        for s in range(1, stages + 1):
            for f in range(width):
                total = spread(0.0)
                for e in range(tabled[s, 0]):
                    total = total + table[s, e] * load(slopes, (tabled[s, e + 1] * width + f) * 8)
                store(after, f * 8, load(state, f * 8) + steps * total)
            store(ws, group + TIME * 8, clock + fractions[s] * steps)
            _slopes(
                recursion, tree, flags, constants, beams, laws, ws, n, width, user, shaken, loaded, dry,
                after, slopes, s * width * 8, ledger,
            )  # fmt: skip
            if kinked:
                _note_kinks(ws, flags, laws, n, state, after, ledger)
        sum_5 = spread(0.0)
        sum_3 = spread(0.0)
        for f in range(width):
            error_5 = spread(0.0)
            error_3 = spread(0.0)
            for s in range(stages + 1):
                k = load(slopes, (s * width + f) * 8)
                error_5 = error_5 + errors_5[s] * k
                error_3 = error_3 + errors_3[s] * k
            scale = spread(1.0 / tolerance)
            if n <= f < 2 * n:
                scale = scale / (1.0 + magnitude(load(state, f * 8)))
            error_5 = error_5 * scale
            error_3 = error_3 * scale
            sum_5 = sum_5 + error_5 * error_5
            sum_3 = sum_3 + error_3 * error_3
        store(ledger, ERROR_5 * 8, sum_5)
        # The estimate of the step's error in units of the tolerance; where both sums are zero it is not a number.
        error_3 = steps * sum_5 / square_root((sum_5 + 0.01 * sum_3) * (2.0 * n))
        if kinked:
            error_3 = error_3 * (1.0 + (UNSEEN - 1.0) * load(ledger, KINK * 8))
        store(ledger, ERROR_3 * 8, error_3)
        store(ledger, GROWTH * 8, 0.9 / square_root(square_root(square_root(error_3))))
        wanted = 0
        for lane in range(lanes):
            if ledger[ALIVE * 8 + lane] == 0.0:
                continue
            error = 0.0
            if ledger[ERROR_5 * 8 + lane] != 0.0:
                error = ledger[ERROR_3 * 8 + lane]
            growth = ledger[GROWTH * 8 + lane]
            h = ledger[USED * 8 + lane]
            if error < 1.0:
                ledger[ERROR_5 * 8 + lane] = 1.0
                if ledger[CUT * 8 + lane] == 0.0 or error < 1e-2:
                    # A step that was cut short tells little about how long the next may be.
                    cut = ledger[CUT * 8 + lane] != 0.0
                    factor = 2.0
                    if not cut:
                        if exponent != -0.125 and error >= 1e-9:
                            growth = 0.9 * error**exponent
                        factor = 6.0 if error < 1e-9 else min(6.0, growth)
                    if not cut or factor * h > ledger[STEP * 8 + lane]:
                        ledger[STEP * 8 + lane] = factor * h
            else:
                ledger[ERROR_5 * 8 + lane] = 0.0
                factor = 0.2
                if error < 1e30:
                    if exponent != -0.125:
                        growth = 0.9 * error**exponent
                    factor = max(0.2, growth)
                ledger[STEP * 8 + lane] = factor * h
                if not (factor * h > 1e-13 * (1.0 + abs(ledger[CLOCK * 8 + lane]))):
                    # Not a number, or stiffer than any step: given up, its samples stay what they were (nan).
                    ledger[ALIVE * 8 + lane] = 0.0
                    ledger[ERROR_5 * 8 + lane] = 0.0
            ledger[MAY * 8 + lane] = 0.0
            if eventful and _may_change(state, after, slopes, laws, ws, flags, n, width, stages, lane, h):
                ledger[MAY * 8 + lane] = 1.0
            ledger[WANTS * 8 + lane] = 0.0
            ends = ledger[UNTIL * 8 + lane]
            if ledger[CUT * 8 + lane] == 0.0:
                ends = ledger[CLOCK * 8 + lane] + h
            if ledger[ERROR_5 * 8 + lane] != 0.0 and (
                ledger[MAY * 8 + lane] != 0.0
                or time[next_sample[lane]] < ends
                or ledger[SUSPECT * 8 + lane] != 0.0
                or (dry and ledger[CUT * 8 + lane] == 0.0)
            ):
                ledger[WANTS * 8 + lane] = 1.0
                wanted = 1
        if wanted:
            for e in range(extra.shape[0]):
                s = stages + 1 + e
                # ``after`` keeps the end of the step; the extra stages borrow the rows behind it.
                for f in range(width):
                    total = spread(0.0)
                    for m in range(extras[e, 0]):
                        total = total + extra[e, m] * load(slopes, (extras[e, m + 1] * width + f) * 8)
                    store(after, (width + f) * 8, load(state, f * 8) + steps * total)
                store(ws, group + TIME * 8, clock + extra_fractions[e] * steps)
                _slopes(
                    recursion, tree, flags, constants, beams, laws, ws, n, width, user, shaken, loaded, dry,
                    after[width * 8 :], slopes, s * width * 8, ledger,
                )  # fmt: skip
            _polynomials(state, slopes, dense, ledger, width, weights, weighed)
            for lane in range(lanes):
                # What only another lane's need brought to light does not count.
                if ledger[WANTS * 8 + lane] == 0.0:
                    ledger[SUSPECT * 8 + lane] = 0.0
        # Held joints that may break loose: look along the step with the forces themselves.
        broken = 0
        if dry:
            for lane in range(lanes):
                if ledger[ALIVE * 8 + lane] != 0.0 and ledger[ERROR_5 * 8 + lane] != 0.0 and ledger[SUSPECT * 8 + lane]:
                    broken = 1
                else:
                    ledger[SUSPECT * 8 + lane] = 0.0
        if broken:
            _break_loose(
                recursion, tree, flags, constants, beams, laws, ws, n, width, user, shaken, loaded,
                after, slopes, dense, ledger, lanes,
            )  # fmt: skip
        # How far each lane goes.
        for lane in range(8):
            ledger[WHAT * 8 + lane] = -2.0
            if ledger[ALIVE * 8 + lane] == 0.0 or ledger[ERROR_5 * 8 + lane] == 0.0:
                continue
            h_lane = ledger[USED * 8 + lane]
            t = ledger[CLOCK * 8 + lane]
            until = 2.0
            which = -1
            what = -1
            if ledger[MAY * 8 + lane] != 0.0 and (ledger[STALL * 8 + lane] < 4.0 or h_lane > 1e-7):
                until, which, what = _first_event(dense, laws, ws, flags, n, width, lane, h_lane)
            breaks = ledger[SUSPECT * 8 + lane]
            if broken and 0.0 < breaks <= 1.0 and breaks < until:
                until = breaks
                which = int(ledger[GRIPPED * 8 + lane])
                what = 2
            if what >= 0 and until * h_lane <= 1e-14 * (1.0 + abs(t)) and what != 2:
                # Contradicted at once: settle the modes again, and if that does not help go in small steps.
                ledger[STALL * 8 + lane] += 1.0
                if ledger[STALL * 8 + lane] > 2.0:
                    ledger[STEP * 8 + lane] = h_lane / 16.0
                until = 0.0
            elif what < 0 or until > 1e-3:
                ledger[STALL * 8 + lane] = 0.0
            reach = t + h_lane
            if ledger[CUT * 8 + lane] != 0.0:
                reach = ledger[UNTIL * 8 + lane]
            if what >= 0:
                reach = t + until * h_lane
            ledger[REACH * 8 + lane] = reach
            ledger[CHANGES * 8 + lane] = until
            ledger[WHICH * 8 + lane] = which
            ledger[WHAT * 8 + lane] = what
        # Samples on the way, one of every lane at a time.
        scratch = after[width * 8 :]
        while True:
            due = 0
            for lane in range(8):
                ledger[SAMPLED * 8 + lane] = -1.0
                k = next_sample[lane]
                if ledger[WHAT * 8 + lane] == -2.0 or k >= counts[first_lane + lane]:
                    continue
                if time[k] < ledger[REACH * 8 + lane]:
                    ledger[SAMPLED * 8 + lane] = (time[k] - ledger[CLOCK * 8 + lane]) / ledger[USED * 8 + lane]
                    due = 1
            if due == 0:
                break
            x = load(ledger, SAMPLED * 8)
            for i in range(n):
                value = load(dense, (DEGREE * width + i) * 8)
                speed = load(dense, (DEGREE * width + n + i) * 8)
                slope = DEGREE * speed
                for power in range(DEGREE - 1, -1, -1):
                    value = value * x + load(dense, (power * width + i) * 8)
                    c = load(dense, (power * width + n + i) * 8)
                    speed = speed * x + c
                    if power > 0:
                        slope = slope * x + float(power) * c
                store(scratch, i * 8, value)
                store(scratch, (n + i) * 8, speed)
                store(scratch, (2 * n + i) * 8, slope / steps)
            for lane in range(8):
                if ledger[SAMPLED * 8 + lane] >= 0.0:
                    k = next_sample[lane]
                    next_sample[lane] = k + 1
                    for i in range(n):
                        position[first_lane + lane, k, i] = scratch[i * 8 + lane]
                        velocity[first_lane + lane, k, i] = scratch[(n + i) * 8 + lane]
                        acceleration[first_lane + lane, k, i] = scratch[(2 * n + i) * 8 + lane]
        # The plain ends of steps; then changes of mode, lane by lane.
        plain = 0.5 - magnitude(load(ledger, WHAT * 8) + 1.0)
        for f in range(width):
            store(state, f * 8, choose(plain, load(after, f * 8), load(state, f * 8)))
            store(slopes, f * 8, choose(plain, load(slopes, (stages * width + f) * 8), load(slopes, f * 8)))
        if kinked:
            for i in range(n):
                j = i * JOINT * 8
                store(
                    ws, j + SLIPS_START * 8, choose(plain, load(ws, j + SLIPS_END * 8), load(ws, j + SLIPS_START * 8))
                )
        for lane in range(8):
            if ledger[WHAT * 8 + lane] < -1.0:
                continue
            ledger[CLOCK * 8 + lane] = ledger[REACH * 8 + lane]
            what = int(ledger[WHAT * 8 + lane])
            if what < 0:
                if ledger[LOADED * 8 + lane] != 0.0:
                    ledger[DIRTY * 8 + lane] = 1.0
                continue
            which = int(ledger[WHICH * 8 + lane])
            until = ledger[CHANGES * 8 + lane]
            for f in range(width):
                state[f * 8 + lane] = _at(dense, width, f, lane, until)
            ledger[DIRTY * 8 + lane] = 1.0
            for i in range(n):
                if ws[i * JOINT * 8 + FREE * 8 + lane] == 0.0:
                    state[(n + i) * 8 + lane] = 0.0
            j = which * JOINT * 8 + lane
            if what == 0:
                used = law.terms_in_use(laws, which * law.WIDTH * 8 + lane, 8)
                state[(n + which) * 8 + lane] = 0.0
                if used & law.HAS_DAHL:
                    q = state[which * 8 + lane]
                    ws[j + GRIP * 8] = law.dahl_friction(
                        laws,
                        which * law.WIDTH * 8,
                        lane,
                        q,
                        ws[j + DIRECTION * 8],
                        ws[j + ANCHOR * 8],
                        ws[j + GRIP * 8],
                    )
                    ws[j + ANCHOR * 8] = q
                if used & law.HAS_DRY:
                    ws[j + FREE * 8] = 0.0
                    ws[j + DIRECTION * 8] = 0.0
                else:
                    ws[j + DIRECTION * 8] = -ws[j + DIRECTION * 8]
            elif what == 1:
                ws[j + CONTACT * 8] = 1.0 - ws[j + CONTACT * 8]
            else:
                ws[j + FREE * 8] = 1.0
                ws[j + DIRECTION * 8] = -1.0 if ws[j + HOLD * 8] > 0.0 else 1.0


@inner
def _excess(ws: Any, n: int, lane: int) -> tuple[float, int]:
    """How far the most strained held joint of a lane is beyond its limit (negative within), and which it is."""
    worst = -1e300
    which = 0
    for i in range(n):
        j = i * JOINT * 8 + lane
        if ws[j + FREE * 8] == 0.0:
            over = abs(ws[j + HOLD * 8]) - ws[j + LIMIT * 8] * (1.0 + law.ALMOST)
            if over > worst:
                worst = over
                which = i
    return worst, which


@inner
def _break_loose(
    recursion: int, tree: Any, flags: Any, constants: Any, beams: Any, laws: Any, ws: Any, n: int, width: int,
    user: int, shaken: int, loaded: int, after: Any, slopes: Any, dense: Any, ledger: Any, lanes: int,
) -> None:  # fmt: skip
    """Find when held joints break loose within the step.

    On return SUSPECT holds the fraction of the step (2 if the joints hold), GRIPPED the joint, and the workspace's HOLD
    of that joint the force at that instant.
    """
    group = n * JOINT * 8
    trial = after[2 * width * 8 :]
    # SUSPECT: 1 searching … ; low, high and values lie in the trial rows behind the state.
    low = after[3 * width * 8 :]
    for lane in range(8):
        low[lane] = 0.0  # lower end
        low[8 + lane] = 1.0 / LOOKS  # place looked at
        low[16 + lane] = 3.0  # upper end, 3: not yet found
        low[24 + lane] = 0.0  # force there
        low[32 + lane] = 0.0  # excess at the lower end
        low[40 + lane] = 0.0  # excess at the upper end
        low[48 + lane] = 0.0 if ledger[SUSPECT * 8 + lane] > 0.0 else 1.0  # finished
        ledger[GRIPPED * 8 + lane] = 0.0
        if low[48 + lane] != 0.0:
            ledger[SUSPECT * 8 + lane] = 2.0
    for round_ in range(LOOKS + 60):
        going = 0
        for lane in range(8):
            x = low[8 + lane]
            for f in range(width):
                trial[f * 8 + lane] = _at(dense, width, f, lane, x)
            ws[group + TIME * 8 + lane] = ledger[CLOCK * 8 + lane] + x * ledger[USED * 8 + lane]
        _slopes(
            recursion, tree, flags, constants, beams, laws, ws, n, width, user, shaken, loaded, np.int64(0),
            trial, slopes, width * 8 * KEPT, ledger,
        )  # fmt: skip
        for lane in range(lanes):
            if low[48 + lane] != 0.0:
                continue
            x = low[8 + lane]
            over, which = _excess(ws, n, lane)
            if over > 0.0:
                low[16 + lane] = x
                low[40 + lane] = over
                low[24 + lane] = ws[which * JOINT * 8 + HOLD * 8 + lane]
                ledger[GRIPPED * 8 + lane] = which
            else:
                low[lane] = x
                low[32 + lane] = over
            if low[16 + lane] > 2.0:
                if x >= 1.0:
                    low[48 + lane] = 1.0
                    ledger[SUSPECT * 8 + lane] = 2.0
                    continue
                low[8 + lane] = min(1.0, x + 1.0 / LOOKS)
            else:
                a = low[lane]
                b = low[16 + lane]
                if b - a < 1e-13 or (over >= 0.0 and over < 1e-12 * abs(low[24 + lane])):
                    low[48 + lane] = 1.0
                    ledger[SUSPECT * 8 + lane] = b
                    continue
                middle = 0.5 * (a + b)
                fa = low[32 + lane]
                fb = low[40 + lane]
                if round_ % 3 != 0 and fa < 0.0:
                    middle = (a * fb - b * fa) / (fb - fa)
                    # Lean to the far side, so that both ends close in.
                    middle = min(max(middle + 1e-3 * (b - a) * (1.0 if round_ % 3 == 1 else -1.0), a), b)
                low[8 + lane] = middle
            going = 1
        if going == 0:
            break
    for lane in range(lanes):
        if low[48 + lane] == 0.0:
            ledger[SUSPECT * 8 + lane] = low[16 + lane] if low[16 + lane] <= 1.0 else 2.0
        if ledger[SUSPECT * 8 + lane] <= 1.0:
            which = int(ledger[GRIPPED * 8 + lane])
            ws[which * JOINT * 8 + HOLD * 8 + lane] = low[24 + lane]


@lane_stepper
def run_groups(
    first: int, last: int, rows: Any, start: Any,
    recursion: int, links: Any, tree: Any, sizes: Any, axes: Any, nominal: Any, plane: Any,
    user: int, time: Any, counts: Any, effort: Any, acting: Any, driven: int, hold: int, longest: Any, tolerance: float,
    table: Any, tabled: Any, fractions: Any, errors_5: Any, errors_3: Any, extra: Any, extras: Any, extra_fractions: Any,
    weights: Any, weighed: Any, exponent: float,
    position: Any, velocity: Any, acceleration: Any,
) -> None:  # fmt: skip
    """Advance the groups first … last − 1 of eight rows each; ``start``: positions then velocities, (B, 2 n).

    counts: how many of the times are asked of each row, (B,).
    recursion: address of the one for these tables (``lanes.address``).
    sizes: vectors of eight lanes in the workspace and in the beams' tables.
    """
    n = position.shape[2]
    copies = rows.shape[0]
    most = 2 * n
    constants = vectors(tree.shape[0] * CONSTANTS)
    beams = vectors(sizes[1])
    laws = vectors(n * law.WIDTH)
    ws = vectors(sizes[0])
    state = vectors(most)
    after = vectors(3 * most + 8)
    slopes = vectors((KEPT + 1) * most)
    dense = vectors((DEGREE + 1) * most)
    ledger = vectors(LEDGER)
    next_sample = np.zeros(8, dtype=np.int64)
    flags = np.zeros(n, dtype=np.int64)
    shake = ws[(n * JOINT + SHAKE) * 8 :]
    present = tree.copy()
    made = np.full(8, -1)
    for g in range(first, last):
        lanes = min(8, copies - 8 * g)
        shaken = prepare_group(
            rows, 8 * g, lanes, links, tree, axes, nominal, plane, constants, beams, laws, shake, flags, present, made
        )
        copy_numbers(rows, 8 * g, lanes, sizes, ws)
        for lane in range(8):
            source = 8 * g + min(lane, lanes - 1)
            for i in range(2 * n):
                state[i * 8 + lane] = start[source, i]
        width = 2 * n
        loaded: Any = np.int64(0)
        for i in range(n):
            if flags[i] & (law.HAS_LOAD | law.HAS_SOFT):
                loaded = 1
        run_group(
            recursion, present, flags, constants, beams, laws, ws, n, width, user, shaken, loaded,
            time, counts, effort, acting, driven, hold, longest, tolerance,
            table, tabled, fractions, errors_5, errors_3, extra, extras, extra_fractions, weights, weighed, exponent,
            state, after, slopes, dense, ledger, next_sample,
            lanes, 8 * g, position, velocity, acceleration,
        )  # fmt: skip
        # What could not be followed, and what nobody asked for.
        for lane in range(lanes):
            for k in range(next_sample[lane], len(time)):
                for i in range(n):
                    position[8 * g + lane, k, i] = np.nan
                    velocity[8 * g + lane, k, i] = np.nan
                    acceleration[8 * g + lane, k, i] = np.nan
