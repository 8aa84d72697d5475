"""Figures 6 and 7 of the paper: what its sensors would have shown, and its frequencies beside ours."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from harness.cases.beams import PAPER_MASS, PRINTED_MASS, PRINTED_THICKNESS, flexible_pendulum, strip
from harness.cases.case import NATIVE, Array, Series, thin
from harness.cases.paper.beside import accelerometer, best_scale, swings, vibrations, wrong_by
from harness.cases.paper.rig import Run, flexible, release_flexible, release_rigid, rigid
from harness.cases.paper.study import Study
from harness.cases.pendulums import LENGTH, paper_inertia, paper_small_frequency
from harness.compare.decay import estimate
from harness.compare.decay.bands import bands
from harness.compare.spectrum import Swing, swing
from harness.engines import registry
from harness.recording.instruments import ChargeAmplifier, StrainBridge
from harness.system import System

HORIZONTAL, SMALL = math.pi / 2.0, math.radians(7.0)


@dataclass(frozen=True)
class Fact:
    """A published figure beside ours: where it stands, published and ours with unit, and a word why they differ."""

    what: str
    where: str
    published: str
    ours: str
    note: str = ""


def figures() -> Study:
    """Figures 6(a), 6(b), 7(a), 7(b) and every published frequency and damping beside ours."""
    wide, small = release_rigid(rigid(), -HORIZONTAL), release_rigid(rigid(), math.radians(-7.0), duration=20.0)
    bent = release_flexible(flexible(), -HORIZONTAL)
    numbers: dict[str, float] = {}
    facts = [*_rigid_facts(wide, small, numbers), *_flexible_facts(bent, numbers)]
    series = (
        *_angles("6(a)", "released from the horizontal", wide, ("potentiometer",)),
        *_angles("6(b)", "released 7° from the vertical", small, ("accelerometer",), scaled=numbers["accelerometer_scale_7"]),
        *_angles("6(b) from 90°", "the accelerometer, released from the horizontal", wide, ("accelerometer",),
                 scaled=numbers["accelerometer_scale_7"]),
        *_tips(bent),
        *swings(wide, bent, numbers["xi_decrement_90"]),
        *vibrations(bent),
        *accelerometer(numbers),
    )  # fmt: skip
    heads = ("what", "where", "published", "ours", "why")
    rows = [(fact.what, fact.where, fact.published, fact.ours, fact.note) for fact in facts]
    return Study({"facts": (heads, rows)}, series, numbers)


def _rigid_facts(wide: Run, small: Run, numbers: dict[str, float]) -> list[Fact]:
    pot = swing(wide.time, wide.read["potentiometer"])
    numbers["rigid_first"] = float(pot.frequency[0])
    numbers["rigid_mean_10s"] = _mean(pot, 10.0)
    numbers["rigid_last"] = float(pot.frequency[pot.time < 10.0][-1])
    undamped = swing(wide.time, release_rigid(rigid(damping=0.0), -HORIZONTAL).angle)
    numbers["rigid_undamped_90"] = float(undamped.frequency[0])
    read = estimate(wide.time, wide.read["potentiometer"], sine=True)
    little = estimate(small.time, small.angle, sine=True)
    inertia = paper_inertia()
    numbers["xi_decrement_90"] = read.decrement.viscous * inertia
    numbers["xi_decrement_7"] = little.decrement.viscous * inertia
    numbers["xi_likelihood"] = read.linear.coefficients[0] * inertia
    numbers["xi_printed"] = read.decrement.printed * inertia
    # What the charge amplifier makes of an angle: best scale and what is left, released from 7° and from 90°.
    for name, run in (("7", small), ("90", wide)):
        scale, left = best_scale(run)
        numbers[f"accelerometer_scale_{name}"], numbers[f"accelerometer_left_{name}"] = scale, left
    numbers["accelerometer_wrong_90"] = wrong_by(wide, numbers["accelerometer_scale_7"])
    amplifier = ChargeAmplifier()
    numbers["amplifier_gain"] = abs(amplifier.gain(paper_small_frequency()))
    numbers["felt_share"] = 1.0 - 9.81 / ((2.0 * math.pi * paper_small_frequency()) ** 2 * LENGTH)
    return [
        Fact("swing of the rigid pendulum, potentiometer", "section 5.1, figure 6(a)", "0.9 Hz",
             f"{numbers['rigid_first']:.3f} Hz in the first half-swing to {numbers['rigid_last']:.3f} Hz after 10 s",
             "the frequency goes with the amplitude, so one number depends on the window"),
        Fact("the same, theory", "section 5.1", "0.88 Hz", f"{numbers['rigid_undamped_90']:.3f} Hz at 90°, "
             f"{paper_small_frequency():.3f} Hz small", "equation (7) as printed gives no such number"),
        Fact("joint damping ξ", "section 5.1", "1.9e-3 N·m·s", f"decrement {numbers['xi_decrement_90']:.3g} from 90° and "
             f"{numbers['xi_decrement_7']:.3g} from 7°, every sample {numbers['xi_likelihood']:.3g}, printed rule "
             f"{numbers['xi_printed']:.3g} N·m·s", "of a simulated recording whose ξ is 1.9e-3"),
        Fact("accelerometer from 7°", "section 5.1, figure 6(b)", "right",
             f"{numbers['accelerometer_scale_7']:.3f} of the angle, "
             f"{100.0 * numbers['accelerometer_left_7']:.1f} % left by that scale",
             f"gravity leaves {100.0 * numbers['felt_share']:.0f} % of the acceleration, the 2 Hz cut-off "
             f"{100.0 * numbers['amplifier_gain']:.0f} % of the displacement at 1.07 Hz"),
        Fact("accelerometer from 90°", "section 5.1", "not correct",
             f"{100.0 * numbers['accelerometer_left_90']:.0f} % left by its own best scale, "
             f"{100.0 * numbers['accelerometer_wrong_90']:.0f} % by that of 7°",
             "the sine's curvature, a swing slower where the filter cuts more, and what acts along the link"),
    ]  # fmt: skip


def _flexible_facts(bent: Run, numbers: dict[str, float]) -> list[Fact]:
    pot = swing(bent.time, bent.read["potentiometer"])
    numbers["flexible_first"], numbers["flexible_last"] = float(pot.frequency[0]), float(pot.frequency[-1])
    numbers["flexible_small"] = _frequencies(flexible(damping=0.0))[0]
    _, vibration = bands(bent.time, bent.true["tip"])
    numbers["vibration_swinging"] = vibration.line or math.nan
    numbers["vibration_ratio"] = vibration.damping_ratio[0]
    numbers["vibration_printed"] = _frequencies(_weightless(PRINTED_MASS, PRINTED_THICKNESS))[0]
    numbers["vibration_hammer"] = _frequencies(_weightless(PAPER_MASS, 0.001))[0]
    half = 0.5 * float(np.ptp(bent.true["strain"]))
    numbers["strain_peak"] = half
    numbers["tip_peak"] = 0.5 * float(np.ptp(bent.true["tip"]))
    numbers["gauge_share"] = StrainBridge(LENGTH, 0.0005).line * half / numbers["tip_peak"]
    return [
        Fact("swing of the flexible pendulum", "section 5.2, figures 7(a), 7(b)", "1.1 Hz, 1.1 Hz",
             f"{numbers['flexible_first']:.3f} Hz at first, {numbers['flexible_small']:.3f} Hz small",
             "1.1 Hz is the frequency of small swings"),
        Fact("tip vibration, measured and by simulation", "section 5.2, figures 7(a), 7(b)", "35 Hz, 35.5 Hz",
             f"{numbers['vibration_printed']:.2f} Hz of the table as printed, {numbers['vibration_swinging']:.2f} Hz of 1 mm and "
             "0.060 kg while it swings", "the printed table is 40 000 kg/m³"),
        Fact("tip vibration, formula", "section 5.2", "35 Hz", f"{numbers['vibration_printed']:.2f} Hz pinned with the hub",
             "of the printed mass and thickness"),
        Fact("tip vibration after a blow", "section 5.2", "37 Hz", f"{numbers['vibration_hammer']:.2f} Hz",
             "of 1 mm and 0.060 kg"),
        Fact("gauges at the root", "section 4.1, figure 7(a)", "a straight calibration line",
             f"{1e6 * numbers['strain_peak']:.2g} µε for {1e3 * numbers['tip_peak']:.2g} mm; the clamped line says "
             f"{100.0 * numbers['gauge_share']:.0f} % of it",
             "a link that turns freely has no bending moment at its root but its hub's"),
    ]  # fmt: skip


def _weightless(mass: float, thickness: float) -> System:
    return flexible_pendulum(strip(mass=mass, thickness=thickness, modes=3), gravity=0.0)


def _frequencies(system: System) -> list[float]:
    found = registry.engine(NATIVE).build(system).frequencies(np.zeros(len(system.coordinate_names)))
    return [float(f) for f in found if f > 1e-3]


def _mean(found: Swing, until: float) -> float:
    inside = found.time < until
    return float(np.count_nonzero(inside) / np.sum(1.0 / found.frequency[inside]))


def _angles(figure: str, what: str, run: Run, sensors: tuple[str, ...], scaled: float = 1.0) -> list[Series]:
    lines = []
    for name in sensors:
        label = name if scaled == 1.0 else f"{name} over {scaled:.3f}"
        lines.append(_line(figure, what, label, run.time, np.degrees(run.read[name]) / scaled))
    # The theory last, so that it is seen on top of a reading that agrees with it.
    return [*lines, _line(figure, what, "theory, the angle itself", run.time, np.degrees(run.angle), dashed=True)]


def _tips(run: Run) -> list[Series]:
    what = "the flexible pendulum, released from the horizontal"
    return [
        _line(
            "7(a)",
            what,
            "gauges at the root, by the clamped calibration",
            run.time,
            1e3 * run.read["gauges"],
            unit="mm",
        ),
        _line("7(b)", what, "tip deflection, simulated", run.time, 1e3 * run.true["tip"], unit="mm"),
    ]


def _line(
    figure: str, what: str, label: str, time: Array, values: Array, *, unit: str = "°", dashed: bool = False
) -> Series:
    return Series(
        "paper",
        f"figure {figure}",
        label,
        thin(time, 3000),
        thin(values, 3000),
        "time [s]",
        f"{'angle' if unit == '°' else 'deflection'} [{unit}]",
        title=f"Figure {figure}: {what}",
        style="dashed" if dashed else "line",
    )
