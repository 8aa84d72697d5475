"""Equation (10) of the paper as printed, against the native engine and finite elements: what each of its misprints does."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from harness.cases.beams import PAPER_MASS, flexible_pendulum, strip
from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.misprints import PRINTED, accounted_for, each_is_named, line, mended_agrees, mending
from harness.engines.as_printed import AsPrinted
from harness.engines.exudyn_ancf import Ancf
from harness.errors import EngineUnavailableError
from harness.system import System, Trajectory

ANCF, TIP = "exudyn_ancf", "rod.tip_deflection"
# The paper's link bears nothing; a few grams let the misprints of the payload's terms show.
PAYLOAD, DAMPING, RATIO = 0.004, 4e-4, 0.005


def system(*, stiffening: bool = False, damping: float = DAMPING) -> System:
    made = flexible_pendulum(strip(mass=PAPER_MASS, payload=PAYLOAD, stiffening=stiffening))
    link = made.links[0]
    assert link.beam is not None
    made = replace(made, links=(replace(link, beam=replace(link.beam, modal_damping=(RATIO,) if damping else ())),))
    return made.replace_joint(replace(made.joint("pivot"), damping=damping))


def cannot_vibrate(bench: Bench) -> Iterable[Row | Series]:
    """Vibrations about hanging at rest of the equation as printed, and with its misprints mended."""
    zero = np.zeros(2)
    printed, mended = (AsPrinted(names).build(system(damping=0.0)).frequencies(zero) for names in ((), ("all",)))
    yield bench.row(
        "vibrations_as_printed",
        (PRINTED, "analytic"),
        float(max(len(printed) - 1, 0)),
        0.0,
        why="without a restoring force on b the small motion has one frequency, the swing's",
        note=f"as printed {_list(printed)}, mended {_list(mended)}",
    )
    if NATIVE in bench.models:
        ours = bench.build(NATIVE, system(damping=0.0)).frequencies(zero)
        yield bench.row(
            "vibrations_mended",
            (PRINTED, NATIVE),
            float(np.abs(mended / ours - 1.0).max()),
            1e-6,
            why="central differences in the linearization",
            note=f"{_list(mended)}",
        )


def _list(frequencies: np.ndarray) -> str:
    return ", ".join(f"{f:.3f} Hz" for f in frequencies) or "none"


def motion(bench: Bench) -> Iterable[Row | Series]:
    """Release from the horizontal: distance from a finite-element run as the misprints are mended one after the other."""
    time = np.linspace(0.0, 0.4, 401)
    start = np.array([-math.pi / 2.0, 0.0])
    free, stiffened = system(damping=0.0), system(stiffening=True, damping=0.0)
    undamped = Bench(bench.case, free, bench.models)
    ours = bench.build(NATIVE, free).simulate(start, np.zeros(2), time)
    mended = AsPrinted(("all",)).build(free)
    own = mended.simulate(start, np.zeros(2), time)
    yield bench.row(
        "motion_mended",
        (PRINTED, NATIVE),
        float(np.abs(own.position[:, 1] - ours.position[:, 1]).max() * abs(mended.pendulum.S3)),
        1e-8,
        unit="m",
        why="two adaptive integrations of the same equations",
        note="the deflection in the mode",
    )
    try:
        Ancf().version()
        truth = Ancf(elements=8).build(stiffened).simulate(start, np.zeros(2), time, step=4e-5)
    except EngineUnavailableError as reason:
        yield bench.skipped("tip_mended", (PRINTED, ANCF), str(reason))
        return
    stages = mending(undamped, 10, truth, TIP, start)
    full = _deflection(bench.build(NATIVE, stiffened).simulate(start, np.zeros(2), time))
    last = float(np.sqrt(np.mean((full - _deflection(truth)) ** 2)) / np.abs(_deflection(truth)).max())
    told = [
        f"{name if k == 0 else name + ' mended'}: {f'{share:.2g}' if math.isfinite(share) else 'out of bounds'}"
        for k, (name, share, _) in enumerate(stages)
    ]
    yield bench.row(
        "tip_mended",
        (PRINTED, ANCF),
        last,
        0.03,
        why="one mode with foreshortening, which equation (10) has not, and the slow bending that the mode leaves out",
        note="; ".join(["RMS over 0.4 s as a share of the peak", *told, f"foreshortening added: {last:.2g}"]),
    )
    for name in ("as printed", "centrifugal_doubled", "elastic_stiffness_missing", "gravity_on_deflection_missing"):
        signal = next(signal for stage, _, signal in stages if stage == name)
        label = name if name == "as printed" else f"… up to {name.replace('_', ' ')} mended"
        yield line(bench, label, time, signal, "tip deflection [m]")
    yield line(bench, "… foreshortening added", time, full, "tip deflection [m]")
    yield line(bench, ANCF, time, _deflection(truth), "tip deflection [m]", dashed=True)


def _deflection(run: Trajectory) -> np.ndarray:
    return np.asarray(run.channels[TIP])


CASE = Case(
    name="paper_flexible",
    title="Equation (10) of the paper as printed: the flexible pendulum, misprint by misprint",
    source="equation (10) and Table 1 of the paper with 1 mm and 0.060 kg; docs/paper.md",
    system=system,
    checks=(
        mended_agrees(10, 1e-12, "rounding"),
        accounted_for(10, 1e-12),
        each_is_named(10, NATIVE),
        Measured("vibrations", cannot_vibrate),
        Measured("motion", motion),
    ),
    group="flexible",
    engines=(NATIVE,),
    cost=6.0,
)
