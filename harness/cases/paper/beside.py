"""The published frequencies and damping beside what the paper's sensors would have shown, as pictures."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from harness.cases.beams import PRINTED_MASS, PRINTED_THICKNESS, flexible_pendulum, strip
from harness.cases.case import NATIVE, Array, Series
from harness.cases.paper.rig import Run, release_rigid, rigid
from harness.cases.pendulums import paper_inertia
from harness.compare.decay.oscillator import amplitudes
from harness.compare.decay.swings import half_swings
from harness.compare.spectrum import spectrum, swing
from harness.engines import registry

# Published: section 5.1, figures 6(a) and 7(a), 7(b); section 5.2 (`reference/paper.toml`).
SWING = {"6(a)": {"0.9 Hz, measured": 0.9, "0.88 Hz, theory": 0.88}, "7(a)": {"1.1 Hz, measured and simulated": 1.1}}
VIBRATION = {"35 Hz, measured": 35.0, "35.5 Hz, simulated": 35.5, "37 Hz, after a blow": 37.0}
PUBLISHED_XI = 1.9e-3
RELEASES = (7.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)


def swings(rigid_run: Run, flexible_run: Run, by_decrement: float) -> list[Series]:
    """Frequency of every half-swing of both pendulums beside the published ones, and amplitudes beside published damping.

    by_decrement: ξ as the logarithmic decrement reads it [N·m·s].
    """
    made = []
    for figure, run in (("6(a)", rigid_run), ("7(a)", flexible_run)):
        found = swing(run.time, run.read["potentiometer"])
        first = Series("paper", f"frequency of the swing {figure}", "half-swings by the potentiometer", tuple(found.time),
                       tuple(found.frequency), "time [s]", "frequency [Hz]", style="points")  # fmt: skip
        made.append(first)
        ends = (float(run.time[0]), float(run.time[-1]))
        made += [
            replace(first, label=f"published: {label}", x=ends, y=(hertz, hertz), style="dashed")
            for label, hertz in SWING[figure].items()
        ]
    found_swings = half_swings(rigid_run.time, rigid_run.read["potentiometer"], sine=True)
    time, circular = tuple(found_swings.time), 2.0 * math.pi * found_swings.small
    figure = "decay of 6(a)"
    made.append(Series("paper", figure, "half-swings by the potentiometer", time, tuple(np.degrees(found_swings.amplitude)),
                       "time [s]", "amplitude [°]", style="points", log="y"))  # fmt: skip
    for label, xi in (
        ("published ξ, 1.9e-3 N·m·s", PUBLISHED_XI),
        (f"decrement, {by_decrement:.3g} N·m·s", by_decrement),
    ):
        law = np.array([xi / paper_inertia(), 0.0, 0.0])
        predicted = amplitudes(float(found_swings.amplitude[0]), len(time), law, circular, sine=True)
        made.append(Series("paper", figure, label, time, tuple(np.degrees(predicted)), "time [s]", "amplitude [°]",
                           style="dashed", log="y"))  # fmt: skip
    return made


def vibrations(run: Run) -> list[Series]:
    """Spectrum of the tip's deflection about the vibration, as it must have been and as printed, with the published frequencies."""
    made = []
    printed = _released(PRINTED_MASS, PRINTED_THICKNESS)
    for label, (time, tip) in (
        ("1 mm and 0.060 kg", (run.time, np.asarray(run.true["tip"]))),
        ("as printed, 2 mm and 0.60 kg", printed),
    ):
        found = spectrum(time, tip)
        inside = (found.frequency > 30.0) & (found.frequency < 42.0)
        top = found.amplitude[inside] / found.amplitude[inside].max()
        made.append(Series("paper", "spectrum of the tip vibration", label, tuple(found.frequency[inside]), tuple(top),
                           "frequency [Hz]", "amplitude over its largest"))  # fmt: skip
    return made + [
        replace(made[0], label=f"published: {label}", x=(hertz, hertz), y=(0.0, 1.0), style="dashed")
        for label, hertz in VIBRATION.items()
    ]


def _released(mass: float, thickness: float) -> tuple[Array, Array]:
    """Time [s] and tip deflection [m] of a strip let go from the horizontal."""
    system = flexible_pendulum(strip(mass=mass, thickness=thickness, modes=2))
    time = np.arange(6001) / 1000.0
    start = np.array([-math.pi / 2.0, 0.0, 0.0])
    run = registry.engine(NATIVE).build(system).simulate(start, np.zeros(3), time)
    return time, np.asarray(run.channels["rod.tip_deflection"])


def accelerometer(numbers: dict[str, float]) -> list[Series]:
    """What the accelerometer's reading leaves of itself, by the best scale of each release and by that of 7°."""
    scale = numbers["accelerometer_scale_7"]
    own, by_7 = [], []
    for release in RELEASES:
        run = release_rigid(rigid(), -math.radians(release))
        own.append(100.0 * best_scale(run)[1])
        by_7.append(100.0 * wrong_by(run, scale))
        numbers[f"accelerometer_own_{release:g}"], numbers[f"accelerometer_by_7_{release:g}"] = own[-1], by_7[-1]
    first = Series("paper", "accelerometer against release", "by the best scale of that release", RELEASES, tuple(own),
                   "release from the vertical [°]", "error, RMS [% of the signal]", style="points")  # fmt: skip
    return [first, replace(first, label="by the scale of 7°", y=tuple(by_7))]


def wrong_by(run: Run, scale: float) -> float:
    """RMS error of the accelerometer's angle by a scale over that of the angle itself, a phase forgiven.

    The ends, where the moved angle is not known and the amplifier settles, are left out.
    """
    reading, inner = run.read["accelerometer"] / scale, slice(200, -200)
    miss = (reading - in_phase(run, reading))[inner]
    return float(np.sqrt(np.mean(miss**2)) / np.sqrt(np.mean(run.angle[inner] ** 2)))


def in_phase(run: Run, reading: Array) -> Array:
    """The true angle moved in time to where it fits the reading best: a phase is forgiven."""
    best, least = run.angle, math.inf
    for shift in range(-120, 121, 2):
        moved = np.interp(run.time + shift * (run.time[1] - run.time[0]), run.time, run.angle)
        miss = float(np.sum((reading - moved)[200:-200] ** 2))
        if miss < least:
            best, least = moved, miss
    return best


def best_scale(run: Run) -> tuple[float, float]:
    """The factor from angle to reading that leaves least, phase forgiven, and what it leaves relative to the reading."""
    reading, inner = run.read["accelerometer"], slice(200, -200)
    best, left = 0.0, math.inf
    for shift in range(-120, 121, 2):
        moved = np.interp(run.time + shift * (run.time[1] - run.time[0]), run.time, run.angle)[inner]
        scale = float(moved @ reading[inner] / (moved @ moved))
        rest = float(np.sqrt(np.mean((reading[inner] - scale * moved) ** 2) / np.mean(reading[inner] ** 2)))
        if rest < left and scale > 0.0:
            best, left = scale, rest
    return best, left
