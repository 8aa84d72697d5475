"""A slider-crank of which the slide alone is recorded: where it stands stretched or folded no reading tells the crank's speed.

The truth is SciPy's, of the equation of motion in the crank's angle alone.
"""

from __future__ import annotations

import numpy as np
from mechanisms_by_mujoco import recording
from scipy.integrate import solve_ivp

from harness import diagnose
from harness.compare.four_bars import flat, hinge, pin, rod
from harness.recording import Recording
from harness.system import Joint, JointType, System
from harness.system.description import constant

# Crank 0.12 m, rod 0.35 m from the middle of the slide along x, stretched at zero; uniform rods, gravity along -y.
A, L, CRANK, ROD, PISTON, G = 0.12, 0.35, 0.5, 0.4, 0.7, 9.81
MODEL = System(
    "slider-crank",
    (
        hinge("crank", "base", "short"),
        hinge("pin", "short", "rod", (A, 0.0, 0.0)),
        Joint(
            "slide", JointType.PRISMATIC, "base", "piston", xyz=constant([A + L, 0.0, 0.0]), axis=constant([1, 0, 0])
        ),
    ),
    (rod("short", CRANK, (A, 0.0, 0.0)), rod("rod", ROD, (L, 0.0, 0.0)), flat("piston", PISTON, (0.0, 0.0), 1e-3)),
    gravity=constant([0.0, -G, 0.0]),
    loops=(pin("wrist", ("rod", (L, 0.0)), ("piston", (0.0, 0.0))),),
)


def _rod(q):
    """The rod's angle, and how it turns for the crank."""
    b = -np.arcsin(A * np.sin(q) / L)
    return b, -A * np.cos(q) / (L * np.cos(b))


def _inertia(q):
    b, turn = _rod(q)
    x, y = -A * np.sin(q) - L / 2 * np.sin(b) * turn, A * np.cos(q) + L / 2 * np.cos(b) * turn
    slide = -A * np.sin(q) - L * np.sin(b) * turn
    return CRANK * A**2 / 3 + ROD * (x**2 + y**2) + ROD * L**2 / 12 * turn**2 + PISTON * slide**2


def _potential(q):
    return G * (CRANK * A / 2 * np.sin(q) + ROD * (A * np.sin(q) + L / 2 * np.sin(_rod(q)[0])))


def _rate(function, q: float) -> float:
    """A derivative by a complex step, exact to rounding."""
    return float(np.imag(function(q + 1e-30j))) / 1e-30


def slides(seconds: float = 4.0, noise: float = 2e-5) -> list[Recording]:
    out = []
    time = np.arange(round(200 * seconds) + 1) / 200.0
    for k, start in enumerate(((0.8, 0.0), (2.2, 2.0), (-2.4, 1.0))):
        run = solve_ivp(
            lambda _, y: [y[1], -(0.5 * _rate(_inertia, y[0]) * y[1] ** 2 + _rate(_potential, y[0])) / _inertia(y[0])],
            (0.0, time[-1]), start, "DOP853", t_eval=time, rtol=1e-11, atol=1e-12,
        )  # fmt: skip
        place = A * np.cos(run.y[0]) + L * np.cos(_rod(run.y[0])[0]) - A - L
        out.append(recording(f"run{k}", time, {("slide", "position"): place}, noise, k))
    return out


def test_a_slide_that_passes_its_dead_points_lacks_nothing() -> None:
    """A quarter of the first recording begins 0.03 rad from where the crank is folded: a zero of the slide passed for what that
    cost."""
    found = diagnose(slides(), MODEL, only=("sensor_offset", "viscous_damping", "coulomb_friction"))
    assert found.verdict == "consistent"
    assert found.findings == []
