"""Checks of the paper's printed equations: right once mended, and each misprint found by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import cast

import numpy as np

from harness.cases.case import Array, Bench, Row, Series, thin
from harness.cases.checks import Measured
from harness.cases.checks.states import random_states
from harness.compare import quantities
from harness.compare.attribution import attribute
from harness.engines.as_printed import AsPrinted, PrintedModel
from harness.engines.printed_terms import Slip, slips
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import UnsupportedError
from harness.system import Trajectory

PRINTED = "as_printed"
PAPER = "the paper's equations (7) and (10), docs/paper.md"

# The part of the equation of motion that mends of each misprint belong to, by the words of `compare.attribution`.
PARTS = {
    "inertia_factor_twice": ("mass_matrix", "armature"),
    "gravity_doubled": ("gravity",),
    "payload_inertia_times_density": ("mass_matrix", "armature"),
    "hub_inertia_times_density": ("armature",),
    "coupling_without_density": ("mass_matrix",),
    "payload_coupling_times_density": ("mass_matrix",),
    "modal_inertia_without_density": ("armature",),
    "coriolis_without_density": ("coriolis",),
    "payload_coriolis_without_mass": ("coriolis",),
    "centrifugal_without_density": ("coriolis",),
    "centrifugal_doubled": ("coriolis",),
    "elastic_stiffness_missing": ("stiffness",),
    "gravity_on_mode_missing": ("gravity",),
    "gravity_on_deflection_missing": ("gravity",),
}


def with_slips(bench: Bench, equation: int, left: Sequence[str]) -> PrintedModel:
    """The case's pendulum by the printed equation with the named misprints left in and all others mended."""
    mended = tuple(slip.name for slip in slips(equation) if slip.name not in left)
    return AsPrinted(mended).build(bench.system)


def mended_agrees(equation: int, allowed: float, why: str, elastic: float = 1e-3) -> Measured:
    """Accelerations of the equation with every misprint mended against every engine."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        mended = with_slips(bench, equation, ())
        # Accelerations of the size that gravity gives, so that no small one is left of large forces that cancel.
        states = random_states(bench, 8, 1.0, 30.0, elastic)
        for name, model in bench.models.items():
            try:
                mass = np.array([model.mass_matrix(q) for q in states.q])
                theirs = _each(model.forward_dynamics, states.q, states.qd, states.tau)
            except UnsupportedError as reason:
                yield bench.skipped("mended", (PRINTED, name), str(reason))
                continue
            ours = _each(mended.forward_dynamics, states.q, states.qd, states.tau)
            yield bench.row(
                "mended",
                (PRINTED, name),
                float(quantities.accelerations(mass, ours, theirs).max()),
                allowed,
                why=why,
                note=f"equation ({equation}) with {len(slips(equation))} misprints mended",
            )

    return Measured("mended", run)


def accounted_for(equation: int, allowed: float, elastic: float = 1e-3) -> Measured:
    """What the printed equation lacks of the force that another engine asks for, less the sum of the named mends."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        printed = AsPrinted().build(bench.system)
        every = with_slips(bench, equation, ())
        states = random_states(bench, 8, 1.0, 1.0, elastic)
        shares = [every.mends(*at) for at in zip(states.q, states.qd, states.qdd, strict=True)]
        sums = np.array([sum(share.values(), np.zeros(len(every.names))) for share in shares])
        lacking = _each(printed.inverse_dynamics, states.q, states.qd, states.qdd)
        sizes = {name: max(float(np.abs(share[name]).max()) for share in shares) for name in shares[0]}
        told = ", ".join(
            f"{name} {size:.2g}" for name, size in sorted(sizes.items(), key=lambda item: -item[1]) if size
        )
        for name, model in bench.models.items():
            try:
                theirs = _each(model.inverse_dynamics, states.q, states.qd, states.qdd)
            except UnsupportedError as reason:
                yield bench.skipped("accounted_for", (PRINTED, name), str(reason))
                continue
            left = np.abs(theirs - lacking - sums)
            scale = np.maximum(np.abs(theirs), np.abs(sums)).max(axis=0)
            yield bench.row(
                "accounted_for",
                (PRINTED, name),
                float((left / scale).max()),
                allowed,
                why="the printed equation and its mends add up exactly; rounding",
                note=f"largest force by misprint [N·m; N in the row of b]: {told}",
            )

    return Measured("accounted_for", run)


def each_is_named(equation: int, against: str, elastic: float = 1e-3) -> Measured:
    """Misprints, one at a time, whose term of the equation of motion is not the one that the attribution blames."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        reference = bench.models.get(against)
        if reference is None:
            return
        states = random_states(bench, 8, 3.0, 1.0, elastic)
        said, wrong, tried = [], [], 0
        for slip in slips(equation):
            if slip.name not in PARTS or not _matters(bench, slip, states.q, states.qd, states.qdd):
                continue
            tried += 1
            found = attribute(
                reference,
                cast(EngineModel, with_slips(bench, equation, (slip.name,))),
                states.q,
                states.qd,
                states.tau,
                allowed=1e-9,
            )
            blamed = found.culprit.term if found.culprit else "nothing"
            if blamed not in PARTS[slip.name]:
                wrong.append(f"{slip.name}: {blamed}")
            said.append(f"{slip.name}: {found.sentence()}")
        yield bench.row(
            "named",
            (PRINTED, against),
            float(len(wrong)),
            0.0,
            why="each misprint alone must be blamed on its own term",
            note=f"{tried - len(wrong)} of {tried}; " + "; ".join(wrong or said),
        )

    return Measured("named", run)


def mending(
    bench: Bench, equation: int, truth: Trajectory, column: str, start: Array
) -> list[tuple[str, float, Array]]:
    """The motion as each further misprint is mended: its name, RMS distance from ``truth`` over its peak, and the signal (T,).

    column: a joint's name, or a channel of the truth. The first entry is as printed; nan from where an equation ends or
    its motion has left the truth by three times its peak, and the distance is infinite then.
    """
    stages: list[tuple[str, float, Array]] = []
    known = [slip.name for slip in slips(equation)]
    true = _signal(truth, column)
    for count in range(len(known) + 1):
        model = AsPrinted(tuple(known[:count])).build(bench.system)
        signal = as_far_as_it_goes(model, start, truth.time, column, 3.0 * float(np.abs(true).max()))
        good = np.isfinite(signal)
        share = float(np.sqrt(np.mean((signal - true)[good] ** 2)) / np.abs(true).max())
        stages.append((known[count - 1] if count else "as printed", share if good.all() else np.inf, signal))
    return stages


def as_far_as_it_goes(model: PrintedModel, start: Array, time: Array, column: str, bound: float) -> Array:
    """A signal (T,) of the motion from rest, nan from where the equation has no solution or the signal is beyond a bound."""
    out = np.full(len(time), np.nan)
    q, qd = start, np.zeros_like(start)
    block = max(2, len(time) // 80)
    for first in range(0, len(time) - 1, block):
        part = time[first : first + block + 1]
        try:
            run = model.simulate(q, qd, part)
        except EngineError:
            break
        signal = _signal(run, column)
        within = np.logical_and.accumulate(np.abs(signal) <= bound)
        out[first : first + len(part)] = np.where(within, signal, np.nan)
        if not within.all():
            break
        q, qd = run.position[-1], run.velocity[-1]
    return out


def line(bench: Bench, label: str, time: Array, values: Array, y_label: str, *, dashed: bool = False) -> Series:
    """One line of the picture of misprints."""
    return Series(
        bench.case.name,
        "misprints",
        label,
        thin(time, 600),
        thin(values, 600),
        "time [s]",
        y_label,
        title=bench.case.title,
        style="dashed" if dashed else "line",
    )


def _signal(run: Trajectory, column: str) -> Array:
    if column in run.channels:
        return np.asarray(run.channels[column])
    return np.asarray(run.position[:, run.names.index(column)])


def _each(function: object, *columns: Array) -> Array:
    assert callable(function)
    return np.array([function(*at) for at in zip(*columns, strict=True)])


def _matters(bench: Bench, slip: Slip, q: Array, qd: Array, qdd: Array) -> bool:
    """Whether a misprint changes anything on this pendulum: those of a payload do not where there is none."""
    model = AsPrinted((slip.name,)).build(bench.system)
    return any(np.any(model.mends(*at)[slip.name]) for at in zip(q, qd, qdd, strict=True))
