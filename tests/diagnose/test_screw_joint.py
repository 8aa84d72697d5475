"""What a helical joint lacks is found from its recorded angle.

Recordings by SciPy: a nut that turns on an upright screw of pitch h a radian and falls by it, (J + m h²) q̈ = −m g h − c q̇ − k q.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

import harness
from harness.recording import Channel, Recording
from harness.system.description import constant

MASS, ABOUT, PITCH, SPRING, DAMPING = 2.0, 4e-3, 0.02, 0.5, 6e-3  # kg, kg·m², m/rad, N·m/rad, N·m·s/rad

MODEL = f"""
name = "nut"
gravity = [0.0, 0.0, -9.81]
tolerance = 0.01
[[joint]]
name = "screw"
type = "helical"
parent = "base"
child = "nut"
axis = [0, 0, 1]
pitch = {PITCH}
stiffness = {SPRING}
[[link]]
name = "nut"
mass = {MASS}
com = [0.0, 0.0, 0.0]
inertia = [3e-3, 3e-3, {ABOUT}, 0, 0, 0]
"""


def swung(start: float, seed: int) -> Recording:
    def slope(_: float, y: np.ndarray) -> tuple[float, float]:
        acting = -MASS * 9.81 * PITCH - DAMPING * y[1] - SPRING * y[0]
        return y[1], acting / (ABOUT + MASS * PITCH**2)

    time = np.arange(0.0, 5.0, 0.01)
    exact = solve_ivp(slope, (0.0, time[-1]), (start, 0.0), t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    read = exact + 1e-3 * np.random.default_rng(seed).normal(size=len(time))
    channel = Channel("screw.position", "screw", "position", "rad", constant(read))
    return Recording(f"run{seed}", f"run{seed}", constant(time), (channel,))


def test_damping_of_a_screw_is_told_with_its_size(tmp_path) -> None:
    model = tmp_path / "nut.toml"
    model.write_text(MODEL)
    recordings = [swung(start, k) for k, start in enumerate((1.2, -1.8, 0.4))]
    found = harness.diagnose(recordings, model, only=("viscous_damping", "coulomb_friction", "added_inertia"))
    assert found.verdict == "explained", found.summary
    (told,) = found.findings
    assert (told["effect"], told["site"]) == ("viscous_damping", "screw")
    low, high = told["parameters"]["coefficient"]["ci95"]
    assert low < DAMPING < high
