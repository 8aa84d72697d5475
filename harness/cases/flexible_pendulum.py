"""The paper's flexible pendulum: as it must have been, as printed, and without geometric stiffening."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from harness.cases.beams import (
    LENGTH,
    PAPER_MASS,
    PRINTED_MASS,
    PRINTED_THICKNESS,
    closed_form,
    flexible_pendulum,
    strip,
)
from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks import EnergyKept, Measured
from harness.cases.checks.beam_blame import afloat, by_frequencies
from harness.cases.checks.beam_frequency import BeamFrequencyTruth
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.cases.checks.period import CITES, period_ratio
from harness.cases.pendulums import HUB
from harness.compare.spectrum import match_modes, parted, swing
from harness.errors import UnsupportedError
from harness.system import Link, System

HORIZONTAL = (("pivot", -math.pi / 2.0),)
ANCF = "exudyn_ancf"

# What the discretization of the peers leaves: 16 cables converge as the fourth power of their length, a thin brick's
# shear as the second.
ANCF_LEAVES = (ANCF, 1e-4, "sixteen cables: 2e-6 in the first mode, 6e-5 in the third")
FFRF_LEAVES = ("exudyn_ffrf", 5e-4, "ninety-six bricks: their shear leaves 1e-6 in the first mode, 3e-4 in the third")


def pinned_with_hub(hub: float, count: int) -> list[float]:
    """Roots β l of a beam pinned with hub inertia: cos z sinh z - sin z cosh z = h z³ (1 + cos z cosh z).

    hub: h = I_h / (ρ l³). The equation is divided by cosh z.
    """

    def condition(z: float) -> float:
        return math.cos(z) * math.tanh(z) - math.sin(z) - hub * z**3 * (1.0 / math.cosh(z) + math.cos(z))

    grid = np.linspace(0.5, math.pi * (count + 2), 200 * (count + 2))
    values = [condition(z) for z in grid]
    brackets = [i for i in range(len(grid) - 1) if values[i] * values[i + 1] < 0.0]
    return [float(brentq(condition, grid[i], grid[i + 1], xtol=1e-14)) for i in brackets[:count]]


def _closed_forms(link: Link, count: int) -> tuple[float, ...]:
    ratio = HUB / (link.mass * LENGTH**2)
    return tuple(closed_form(root, link) for root in pinned_with_hub(ratio, count))


def weightless(check: BeamFrequencyTruth, system: System) -> Measured:
    """The check on the system without gravity, where the closed form holds."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        models = {name: bench.build(name, system) for name in bench.models}
        yield from check.run(Bench(bench.case, system, models))

    return Measured(check.quantity, run)


def _weightless(bench: Bench, modes: int) -> dict[float, float]:
    """Ratios of ANCF's bending frequencies without gravity to the native ones, by those [Hz]."""
    floating = afloat(bench.system)
    zero = np.zeros(len(bench.system.coordinate_names))
    ours, theirs = (np.asarray(bench.build(name, floating).frequencies(zero)) for name in (NATIVE, ANCF))
    # What swings does not without weight.
    ours, theirs = ours[ours > 1e-3], theirs[theirs > 1e-3]
    return {float(ours[i]): float(theirs[j] / ours[i]) for i, j in match_modes(ours[:modes], theirs)}


def hanging_frequencies(allowed: float, modes: int, why: str) -> Measured:
    """Swing and vibration of the hanging pendulum, gravity's tension included, native against ANCF."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        if NATIVE not in bench.models or ANCF not in bench.models:
            return
        zero = np.zeros(len(bench.system.coordinate_names))
        try:
            ours, theirs = (np.asarray(bench.models[name].frequencies(zero)) for name in (NATIVE, ANCF))
        except UnsupportedError as reason:
            yield bench.skipped("hanging_frequency", (NATIVE, ANCF), str(reason))
            return
        pairs = match_modes(ours[:modes], theirs)
        said: tuple[str, dict[str, object] | None] = ("", None)
        if any(not abs(ours[i] - theirs[j]) <= allowed for i, j in pairs):
            ratios = {i: theirs[j] / ours[i] for i, j in pairs}
            said = by_frequencies(bench.system, ANCF, ours[:modes], ratios, weightless=_weightless(bench, modes))
        for i, j in pairs:
            far = not abs(ours[i] - theirs[j]) <= allowed
            yield bench.row(
                f"hanging_frequency_{i + 1}",
                (NATIVE, ANCF),
                abs(ours[i] - theirs[j]),
                allowed,
                unit="Hz",
                why=why,
                note="; ".join(filter(None, [f"{ours[i]:.5f} Hz against {theirs[j]:.5f} Hz", said[0] if far else ""])),
                first_divergence={"mode": i + 1} | (said[1] or {}) if far else None,
            )
        if len(pairs) < modes:
            yield bench.row(
                "hanging_frequency", (NATIVE, ANCF), np.nan, allowed, unit="Hz", why=why, note="a mode has no match"
            )

    return Measured("hanging_frequency", run)


def element_convergence(system: System, counts: Sequence[int], truth: tuple[float, ...]) -> Measured:
    """Error of ANCF's bending frequencies against the closed form, over the number of elements; drawn, not judged."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        if ANCF not in bench.models:
            return
        from harness.engines.exudyn_ancf import Ancf

        errors = np.empty((len(counts), len(truth)))
        for k, count in enumerate(counts):
            found = Ancf(elements=count).build(system).frequencies(np.zeros(len(system.coordinate_names)))
            errors[k] = np.abs(found[: len(truth)] / np.array(truth) - 1.0)
        for mode in range(len(truth)):
            yield Series(
                bench.case.name,
                "convergence",
                f"{ANCF}: frequency of mode {mode + 1}",
                tuple(float(count) for count in counts),
                tuple(errors[:, mode].tolist()),
                "elements",
                "relative error",
                title=bench.case.title,
                style="points",
                log="xy",
            )

    return Measured("element_convergence", run)


def decaying_swing(damping: float, amplitude: float, duration: float) -> Measured:
    """Frequency of each half-swing of the damped pendulum against its amplitude, on the elliptic integral's curve."""

    def run(bench: Bench) -> Iterable[Row | Series]:
        if NATIVE not in bench.models:
            return
        pivot = replace(bench.system.joint("pivot"), damping=damping)
        model = bench.build(NATIVE, bench.system.replace_joint(pivot))
        n = len(bench.system.coordinate_names)
        start = np.zeros(n)
        start[0] = amplitude
        time = np.linspace(0.0, duration, round(duration * 500.0) + 1)
        run = model.simulate(start, np.zeros(n), time)
        small = float(bench.models[NATIVE].frequencies(np.zeros(n))[0])
        slow, _ = parted(time, run.position[:, 0], math.sqrt(small * 35.0))
        found = swing(time, slow)
        true = small / np.array([period_ratio(a) for a in found.amplitude])
        apart = np.abs(found.frequency / true - 1.0)
        worst = int(np.argmax(apart))
        yield bench.row(
            "swing_frequency",
            (NATIVE, "analytic"),
            float(apart[worst]),
            1e-3,
            why="the elliptic integral is of an undamped rigid pendulum; amplitude falls within a half-swing, and the "
            "beam bends",
            note=f"{found.frequency[0]:.4f} Hz at {math.degrees(found.amplitude[0]):.0f}°, {found.frequency[-1]:.4f} Hz "
            f"at {math.degrees(found.amplitude[-1]):.0f}°; worst at {math.degrees(found.amplitude[worst]):.0f}°",
            source=CITES,
        )
        fine = np.radians(np.linspace(1.0, math.degrees(amplitude), 100))
        for label, x, y, style in (
            (f"{NATIVE}, half-swing by half-swing", found.amplitude, found.frequency, "points"),
            ("elliptic integral", fine, small / np.array([period_ratio(a) for a in fine]), "line"),
        ):
            yield Series(
                bench.case.name,
                "frequency_amplitude",
                label,
                tuple(np.degrees(x).tolist()),
                tuple(y.tolist()),
                "amplitude [°]",
                "frequency [Hz]",
                title=bench.case.title,
                style=style,
            )

    return Measured("swing_frequency", run)


def _paper(modes: int = 1, stiffening: bool = True) -> System:
    return flexible_pendulum(strip(mass=PAPER_MASS, modes=modes, stiffening=stiffening))


def _printed() -> System:
    return flexible_pendulum(strip(mass=PRINTED_MASS, thickness=PRINTED_THICKNESS))


def _cases() -> tuple[Case, ...]:
    paper = strip(mass=PAPER_MASS, modes=3)
    printed = strip(mass=PRINTED_MASS, thickness=PRINTED_THICKNESS, modes=3)
    exact = "exact shapes and quadrature: rounding, and central differences in the linearization"
    return (
        Case(
            name="flexible_pendulum",
            title="The paper's flexible pendulum, 1 mm and 0.060 kg, falling from the horizontal",
            source="Table 1 of the paper with 1 mm and 0.060 kg, which alone fit its hammer test of 37 Hz; roots of "
            "cos z sinh z - sin z cosh z = h z³ (1 + cos z cosh z)",
            system=_paper,
            checks=(
                weightless(
                    BeamFrequencyTruth(
                        _closed_forms(paper, 3), 1e-6, exact, (ANCF_LEAVES,), "Blevins, table 8-1, with hub inertia"
                    ),
                    flexible_pendulum(paper, gravity=0.0),
                ),
                hanging_frequencies(0.01, 2, "sixteen cables leave 1e-4 Hz; one mode takes up gravity's tension"),
                DeflectionAgreement(
                    peer=ANCF,
                    position=HORIZONTAL,
                    accuracies=(
                        Accuracy(
                            1,
                            0.02,
                            1.5e-4,
                            "a single hub-consistent mode leaves out what the second one moves",
                            frequency=0.01,
                        ),
                        Accuracy(
                            5,
                            0.003,
                            1e-5,
                            "sixteen cables at 20 µs are themselves certain to 0.1 % of the peak",
                            frequency=0.01,
                        ),
                    ),
                    also_modes=(2, 3, 4),
                ),
                element_convergence(flexible_pendulum(paper, gravity=0.0), (2, 4, 8, 16), _closed_forms(paper, 3)),
                decaying_swing(damping=4e-4, amplitude=math.pi / 2.0, duration=15.0),
                EnergyKept(
                    allowed=1e-6,
                    why="the integrator's tolerance over 60 s of undamped motion",
                    position=HORIZONTAL,
                ),
            ),
            group="flexible",
            engines=(NATIVE, ANCF),
            cost=25.0,
        ),
        Case(
            name="flexible_pendulum_as_printed",
            title="The paper's flexible pendulum with the table as printed, 2 mm and 0.60 kg",
            source="Table 1 of the paper as printed (a density of 40 000 kg/m³): 35.0 Hz, as the paper states",
            system=_printed,
            checks=(
                weightless(
                    BeamFrequencyTruth(_closed_forms(printed, 3), 1e-6, exact, (ANCF_LEAVES,)),
                    flexible_pendulum(printed, gravity=0.0),
                ),
                hanging_frequencies(0.01, 2, "sixteen cables leave 1e-4 Hz; one mode takes up gravity's tension"),
            ),
            group="flexible",
            engines=(NATIVE, ANCF),
            cost=2.0,
        ),
        Case(
            name="flexible_pendulum_unstiffened",
            title="The flexible pendulum without geometric stiffening, against a floating frame",
            source="A. Zwölfer and J. Gerstmayr, Acta Mechanica 232 (2021) 835-851",
            system=lambda: _paper(3, stiffening=False),
            checks=(
                weightless(
                    BeamFrequencyTruth(_closed_forms(paper, 3), 1e-6, exact, (FFRF_LEAVES,)),
                    flexible_pendulum(strip(mass=PAPER_MASS, modes=3, stiffening=False), gravity=0.0),
                ),
                DeflectionAgreement(
                    peer="exudyn_ffrf",
                    position=HORIZONTAL,
                    step=5e-5,
                    accuracies=(
                        Accuracy(
                            None,
                            0.02,
                            1e-4,
                            "five Craig-Bampton modes of bricks at 50 µs, certain to about 0.5 % of the peak",
                            frequency=0.02,
                        ),
                    ),
                ),
            ),
            group="flexible",
            engines=(NATIVE, "exudyn_ffrf"),
            cost=10.0,
        ),
    )


CASES = _cases
