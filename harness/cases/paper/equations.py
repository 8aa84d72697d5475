"""What the printed equation (10) leaves out, asked of a recording that finite elements made: see ``compare.balance``.

Twice: of the equation to the letter, and with the units mended, which anyone can do from the page alone. A vibration of one
frequency has b̈ = −ω² b, so that the modal inertia without its density hides most of a missing stiffness; mended, it does not.
"""

from __future__ import annotations

import math

import numpy as np

from harness.cases.beams import PAPER_MASS, flexible_pendulum, strip
from harness.cases.case import NATIVE
from harness.cases.paper.study import Study, Table
from harness.compare.balance import Balance, balance
from harness.engines import registry
from harness.engines.as_printed import AsPrinted
from harness.engines.exudyn_ancf import Ancf
from harness.engines.printed_terms import slips
from harness.recording.recording import Channel, Recording
from harness.system import System

# Misprints that the page alone gives away.
UNITS = tuple(slip.name for slip in slips(10) if slip.consequence.startswith("units do not match"))


def rod() -> System:
    """The flexible pendulum of 1 mm and 0.060 kg in one mode, undamped."""
    return flexible_pendulum(strip(mass=PAPER_MASS))


def recorded(
    *, duration: float = 1.5, elements: int = 8, noise: tuple[float, float] = (1e-4, 1e-6), seed: int = 10
) -> Recording:
    """A release from 60° in ANCF elements, angle [rad] and tip deflection [m] with white noise of those deviations on them."""
    time = np.linspace(0.0, duration, round(duration * 2000.0) + 1)
    run = Ancf(elements=elements).build(rod()).simulate(np.array([-math.pi / 3.0, 0.0]), np.zeros(2), time, step=5e-5)
    rng = np.random.default_rng(seed)
    angle = run.position[:, 0] + noise[0] * rng.standard_normal(len(time))
    tip = np.asarray(run.channels["rod.tip_deflection"]) + noise[1] * rng.standard_normal(len(time))
    return Recording(
        "release",
        "",
        time,
        (
            Channel("pivot.position", "pivot", "position", "rad", angle),
            Channel("rod.tip_deflection", "rod", "tip_deflection", "m", tip),
        ),
    )


def doubted(recording: Recording, mended: tuple[str, ...]) -> Balance:
    """Equation (10) with some misprints mended, held against a recording."""
    system = rod()
    return balance(recording, system, AsPrinted(mended).build(system), registry.engine(NATIVE).build(system))


def equations() -> Study:
    """What equation (10) lacks by a recording of ANCF elements, to the letter and with the units mended."""
    recording = recorded()
    heads = ("equation of", "what the recording asks for", "factor (1: the corrected term)", "log Bayes factor")
    tables: dict[str, Table] = {}
    numbers: dict[str, float] = {}
    for name, mended in (("to_the_letter", ()), ("units_mended", UNITS)):
        found = doubted(recording, mended)
        tables[name] = (
            heads,
            [(m.row, m.words, f"{m.factor:.3f} ± {m.std:.2g}", f"{m.evidence:.0f}") for m in found.mends],
        )
        numbers |= {f"{name}: {m.words}": m.factor for m in found.mends}
    return Study(tables, (), numbers)
