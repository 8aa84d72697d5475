"""What the printed equations leave out, asked of a recording that finite elements made: term by term, by regression.

Units that do not match are mended from the page alone. Along a recording of angle and tip deflection equation (10) does not
balance even then: what is missing is a sum of the terms that would mend the other misprints, each with a factor, 1 where the
misprint is real, 0 where the print is right. The factors are found by least squares, and a term is named where the balance is
worse without it, by the Bayesian information criterion.

(Units have to be mended first: a vibration of one frequency has b̈ = −ω² b, so a wrong modal inertia and a missing stiffness look
alike along it.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_splrep

from harness.cases.beams import PAPER_MASS, flexible_pendulum, strip
from harness.cases.case import Array
from harness.cases.paper.study import Study
from harness.compare.spectrum import parted
from harness.engines.as_printed import AsPrinted
from harness.engines.exudyn_ancf import Ancf
from harness.engines.printed_terms import slips
from harness.system import System


@dataclass(frozen=True)
class Missing:
    """A term that the recording asks for: name, row of the equation, factor and its standard uncertainty, ΔBIC without it."""

    name: str
    row: str
    factor: float
    std: float
    delta_bic: float


def recorded(
    *, duration: float = 1.5, elements: int = 8, noise: tuple[float, float] = (1e-4, 1e-6)
) -> tuple[Array, ...]:
    """Time, angle [rad] and tip deflection [m] of a release from 60° in ANCF elements, with noise on both, each (T,)."""
    time = np.linspace(0.0, duration, round(duration * 2000.0) + 1)
    run = Ancf(elements=elements).build(_rod()).simulate(np.array([-math.pi / 3.0, 0.0]), np.zeros(2), time, step=5e-5)
    rng = np.random.default_rng(10)
    angle = run.position[:, 0] + noise[0] * rng.standard_normal(len(time))
    tip = np.asarray(run.channels["rod.tip_deflection"]) + noise[1] * rng.standard_normal(len(time))
    return time, angle, tip


def _rod() -> System:
    return flexible_pendulum(strip(mass=PAPER_MASS))


def missing(time: Array, angle: Array, tip: Array) -> tuple[Missing, ...]:
    """The terms that a recording asks for in the row of b, strongest first."""
    model = AsPrinted(("all",)).build(_rod())
    units = tuple(slip.name for slip in slips(10) if slip.consequence.startswith("units do not match"))
    printed = AsPrinted(units).build(_rod())
    q, qd, qdd = (np.column_stack(pair) for pair in zip(*(_derivatives(time, x) for x in (angle, tip)), strict=True))
    for part in (q, qd, qdd):
        part[:, 1] /= model.pendulum.S3
    inner = slice(len(time) // 20, -len(time) // 20, 2)
    states = list(zip(q[inner], qd[inner], qdd[inner], strict=True))
    lacking = -np.array([printed.inverse_dynamics(*at)[1] for at in states])
    mends = [model.mends(*at) for at in states]
    names = [s.name for s in slips(10) if s.name not in units and np.any([mend[s.name][1] for mend in mends])]
    table = np.array([[mend[name][1] for name in names] for mend in mends])
    scale = np.abs(table).max(axis=0)
    chosen = list(range(len(names)))
    # Backwards from all terms: what the balance can do without goes first.
    while len(chosen) > 1:
        whole = _bic(table[:, chosen] / scale[chosen], lacking)
        without = [
            _bic(table[:, [c for c in chosen if c != k]] / scale[[c for c in chosen if c != k]], lacking)
            for k in chosen
        ]
        if min(without) > whole:
            break
        chosen.pop(int(np.argmin(without)))
    basis = table[:, chosen] / scale[chosen]
    factors = np.linalg.lstsq(basis, lacking, rcond=None)[0]
    residual = lacking - basis @ factors
    memory = float(np.clip(residual[1:] @ residual[:-1] / (residual @ residual), 0.0, 0.99))
    variance = float(residual @ residual) / len(lacking) * (1.0 + memory) / (1.0 - memory)
    std = np.sqrt(np.diagonal(np.linalg.inv(basis.T @ basis)) * variance)
    whole = _bic(basis, lacking)
    found = [
        Missing(
            names[k],
            "b",
            float(factors[i] / scale[k]),
            float(std[i] / scale[k]),
            float(_bic(np.delete(basis, i, axis=1), lacking) - whole),
        )
        for i, k in enumerate(chosen)
    ]
    return tuple(sorted(found, key=lambda term: -term.delta_bic))


def _bic(basis: Array, wanted: Array) -> float:
    residual = wanted - (basis @ np.linalg.lstsq(basis, wanted, rcond=None)[0] if basis.shape[1] else 0.0)
    # The residual of a filtered recording has a memory: fewer samples are independent than there are.
    independent = len(wanted) / 10.0
    return float(independent * np.log(np.mean(residual**2)) + basis.shape[1] * np.log(independent))


def _derivatives(time: Array, signal: Array, cutoff: float = 120.0) -> tuple[Array, Array, Array]:
    """The signal without what is above ``cutoff`` [Hz], and its first two derivatives, each (T,)."""
    slow, _ = parted(time, signal, cutoff)
    spline = make_splrep(time, slow, k=5, s=0)
    return np.asarray(spline(time)), np.asarray(spline(time, 1)), np.asarray(spline(time, 2))


def equations() -> Study:
    """The table of what equation (10) as printed leaves out, by a recording of ANCF elements."""
    words = {slip.name: (slip.printed, slip.correct) for slip in slips(10)}
    found = missing(*recorded())
    rows = [
        (t.name.replace("_", " "), *words[t.name], f"{t.factor:.3f} ± {t.std:.1g}", f"{t.delta_bic:.0f}") for t in found
    ]
    heads = (
        "what the recording asks for",
        "printed",
        "should be",
        "factor (1: the misprint is real)",
        "ΔBIC without it",
    )
    return Study({"missing_terms": (heads, rows)}, (), {t.name: t.factor for t in found})
