"""Four ways to read damping off a decay, on concealed truth: where they differ, and by how much.

Viscous, dry and quadratic damping and all their mixtures, so strong together that the first swings from 90° lose what the paper's ξ
takes, act on the paper's rigid pendulum; its angle gets white noise. Each decay is read without the answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.integrate import solve_ivp

from harness.cases.case import Array, Series
from harness.cases.paper.study import Progress, Study, silent
from harness.cases.pendulums import paper_inertia, paper_restoring, paper_small_frequency
from harness.cases.rigid_pendulum_damped import DAMPING
from harness.cases.solver_event import Event
from harness.compare.decay import Decay, estimate
from harness.compare.decay.oscillator import LAWS, losses
from harness.parallel import parallel_map

MIXTURES = tuple(laws for size in (1, 2, 3) for laws in combinations(LAWS, size))
RELEASES = (90.0, 45.0)
NOISE, RATE, DURATION = 1e-3, 200.0, 15.0
# What each reading says of viscous damping, in the order of the table.
WAYS = ("ratio as printed", "decrement", "envelope", "every sample")


@dataclass(frozen=True)
class Trial:
    """One concealed decay: coefficients of ``LAWS`` in N·m·s, N·m, N·m·s², released at [°], seed of its noise."""

    coefficients: tuple[float, float, float]
    release: float
    seed: int

    @property
    def laws(self) -> tuple[str, ...]:
        """Which act."""
        return tuple(law for law, value in zip(LAWS, self.coefficients, strict=True) if value)


@dataclass(frozen=True)
class Read:
    """What the readings say of a trial, over its inertia already: N·m·s, N·m, N·m·s².

    printed, decrement: viscous damping. envelope, sample: all three, std: of ``sample``. laws: that ``sample`` chose.
    """

    trial: Trial
    printed: float
    decrement: float
    envelope: tuple[float, ...]
    sample: tuple[float, ...]
    std: tuple[float, ...]
    laws: tuple[str, ...]

    @property
    def viscous(self) -> tuple[float, ...]:
        """By ``WAYS``."""
        return self.printed, self.decrement, self.envelope[0], self.sample[0]


def trials(seed: int) -> tuple[Trial, ...]:
    """Every mixture from every release."""
    rng = np.random.default_rng(seed)
    one = losses(np.array([1.3]), 2.0 * math.pi * paper_small_frequency(), sine=True)[:, 0]
    made = []
    for laws in MIXTURES:
        inside = np.array([law in laws for law in LAWS])
        # No member of a mixture takes less than a fifth of the loss: what does nothing cannot be found.
        shares = np.zeros(3)
        shares[inside] = 0.2 + (1.0 - 0.2 * inside.sum()) * rng.dirichlet(np.ones(int(inside.sum())))
        viscous, dry, quadratic = (float(c) for c in shares * DAMPING * one[0] / one)
        truth = (viscous, dry, quadratic)
        made += [Trial(truth, release, int(rng.integers(2**31))) for release in RELEASES]
    return tuple(made)


def recorded(trial: Trial) -> tuple[Array, Array]:
    """Time [s] and measured angle [rad] of the trial, (T,)."""
    time = np.arange(int(DURATION * RATE) + 1) / RATE
    angle = motion(trial.coefficients, -math.radians(trial.release), time)
    return time, angle + NOISE * np.random.default_rng(trial.seed).standard_normal(len(time))


def motion(coefficients: Sequence[float], start: float, time: Array) -> Array:
    """Angle [rad] (T,) of the paper's rigid pendulum let go at ``start`` [rad] with damping of ``LAWS`` [N·m·s, N·m, N·m·s²].

    From turning point to turning point, where dry friction has one sign and the motion is smooth; it rests where gravity cannot
    overcome dry friction any more.
    """
    viscous, dry, quadratic = (c / paper_inertia() for c in coefficients)
    square = paper_restoring() / paper_inertia()
    angle, at, q = np.full(len(time), start), float(time[0]), start

    turns = Event(lambda _, state: float(state[1]))
    while at < time[-1] and square * abs(math.sin(q)) > dry:
        sense = -math.copysign(1.0, math.sin(q))
        turns.direction = -sense

        def slope(_: float, state: Array, sense: float = sense) -> list[float]:
            drag = viscous * state[1] + sense * (dry + quadratic * state[1] ** 2)
            return [state[1], -square * math.sin(state[0]) - drag]

        # A first step away from rest, so that the turning point left is not found again: q'' is constant over a microsecond.
        first = 1e-6
        push = slope(0.0, np.array([q, 0.0]))[1]
        begin = [q + 0.5 * push * first**2, push * first]
        run = solve_ivp(
            slope, (at + first, float(time[-1]) + 1.0), begin, "DOP853", events=turns, dense_output=True,
            rtol=1e-11, atol=1e-12,
        )  # fmt: skip
        end = float(run.t[-1])
        inside = (time > at + first) & (time <= end)
        angle[inside] = run.sol(time[inside])[0]
        at, q = end, float(run.y[0, -1])
        angle[time > end] = q
    return angle


def read(trial: Trial) -> Read:
    """All readings of a trial."""
    found: Decay = estimate(*recorded(trial), sine=True)
    inertia = paper_inertia()
    return Read(
        trial,
        found.decrement.printed * inertia,
        found.decrement.viscous * inertia,
        tuple(float(c) * inertia for c in found.envelope.coefficients),
        tuple(float(c) * inertia for c in found.likelihood.coefficients),
        tuple(float(c) * inertia for c in found.likelihood.std),
        found.likelihood.laws,
    )


def readings(seed: int, *, workers: int | None = None, progress: Progress = silent) -> Study:
    """Every mixture from every release read in every way."""
    asking = trials(seed)
    count = 0

    def done(index: int, answer: Read) -> None:
        nonlocal count
        count += 1
        progress(count, len(asking), " + ".join(asking[index].laws))

    return told(parallel_map(read, asking, workers=workers, done=done))


def told(answers: Sequence[Read]) -> Study:
    """Tables, the picture and the numbers of all readings."""
    heads = (
        "concealed",
        "from",
        "viscous, dry, quadratic [10⁻³ N·m·s, N·m, N·m·s²]",
        *WAYS[:2],
        WAYS[2],
        f"{WAYS[3]}: laws",
        WAYS[3],
    )
    rows = [
        (
            " + ".join(a.trial.laws),
            f"{a.trial.release:g}°",
            _three(a.trial.coefficients),
            _milli(a.printed),
            _milli(a.decrement),
            _three(a.envelope),
            " + ".join(a.laws) or "nothing",
            _three(a.sample),
        )
        for a in answers
    ]
    numbers: dict[str, float] = {}
    summary = []
    scale = _scale()
    for place, way in enumerate(WAYS):
        alone = [a for a in answers if a.trial.laws == ("viscous",)]
        off_alone = [abs(a.viscous[place] / a.trial.coefficients[0] - 1.0) for a in alone]
        off = [abs(a.viscous[place] - a.trial.coefficients[0]) / scale[0] for a in answers if a not in alone]
        cells = [
            _percent(max(off_alone)),
            _percent(float(np.median(off))),
            _percent(max(off)),
        ]
        numbers[f"{way}, viscous alone"], numbers[f"{way}, mixtures"] = max(off_alone), float(np.median(off))
        if place >= 2:
            others = [
                abs(x - true) / one
                for a in answers
                for x, true, one in zip(
                    (a.envelope, a.sample)[place - 2][1:], a.trial.coefficients[1:], scale[1:], strict=True
                )
            ]
            cells.append(f"{_percent(float(np.median(others)))}, {_percent(max(others))}")
        else:
            cells.append("not told")
        summary.append((way, *cells))
    named = sum(a.laws == a.trial.laws for a in answers)
    held = [
        abs(x - true) <= 1.96 * std
        for a in answers
        for x, true, std in zip(a.sample, a.trial.coefficients, a.std, strict=True)
        if std
    ]
    numbers |= {"laws named": named, "of": len(answers), "intervals that hold": float(np.mean(held))}
    series = [
        Series(
            "paper",
            "viscous damping by four readings",
            way,
            tuple(float(k + 1) for k in range(len(answers))),
            tuple(_drawn(a.viscous[place]) for a in answers),
            "decay, in the order of the table",
            "viscous damping read, over the paper's ξ",
            style="points",
            log="y",
        )
        for place, way in enumerate(WAYS)
    ]
    true = replace(
        series[0],
        label="concealed",
        y=tuple(_drawn(a.trial.coefficients[0]) for a in answers),
        style="dashed",
    )
    return Study(
        {
            "readings": (heads, rows),
            "errors": (
                (
                    "reading",
                    "viscous alone: largest error",
                    "mixtures: median error of viscous, of ξ",
                    "largest",
                    "dry and quadratic: median, largest, of what alone takes the loss",
                ),
                summary,
            ),
            "laws": (
                ("laws named", "intervals of 95 % that hold"),
                [(f"{named} of {len(answers)}", f"{100.0 * float(np.mean(held)):.0f} % of {len(held)}")],
            ),
        },
        (true, *series),
        numbers,
    )


def _scale() -> Array:
    """Coefficient of each law that alone takes what ξ takes of the first swings, (3,)."""
    one = losses(np.array([1.3]), 2.0 * math.pi * paper_small_frequency(), sine=True)[:, 0]
    return np.asarray(DAMPING * one[0] / one)


def _drawn(viscous: float) -> float:
    """Over the paper's ξ; next to none has no place on a logarithmic axis."""
    return viscous / DAMPING if viscous > 0.01 * DAMPING else math.nan


def _milli(value: float) -> str:
    return f"{1e3 * value:.3g}"


def _three(values: Sequence[float]) -> str:
    """All three laws; what would take less than 10⁻⁵ of the loss is nothing."""
    return ", ".join(_milli(v) if v > 1e-5 * one else "0" for v, one in zip(values, _scale(), strict=True))


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"
