"""Long free decays of a pendulum whose length is not the drawn one: swing for swing out of step with the model's, from the start.

Recordings by SciPy's integration of a point mass on a rod, with friction as stated, less damping, and a force that no law of the
catalogue is, of half a per cent of the weight's greatest moment.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.recording import Channel, Recording
from harness.system.description import constant

MASS, DRAWN, LENGTH, GRAVITY = 0.2, 0.32, 0.2, 9.81  # kg, m, m, m/s²
STATED, DAMPING, FRICTION = 5e-4, 3e-4, 1e-3  # N·m·s/rad, N·m·s/rad, N·m
LEFT_OUT = 2e-3  # N·m, standard deviation
STARTS = (2.3, 1.4, 0.8)  # rad

MODEL = f"""
name = "pendulum"
gravity = [0.0, 0.0, -{GRAVITY}]
tolerance = 0.01
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
armature = 1e-4
damping = {STATED}
friction = {FRICTION}
[[link]]
name = "rod"
mass = {MASS}
com = [0.0, 0.0, -{DRAWN}]
inertia = [1e-6, 1e-6, 1e-9, 0, 0, 0]
end = [0.0, 0.0, -{DRAWN}]
"""


def decays() -> list[Recording]:
    """Three decays of about ten swings each; the force over angle and speed is one draw of random waves for all of them."""
    random = np.random.default_rng(12)
    waves, phases = random.normal(size=(40, 2)) / [0.8, 5.0], random.uniform(0.0, 2.0 * np.pi, 40)
    about = 1e-4 + 1e-6 + MASS * LENGTH**2

    def slope(_: float, y: np.ndarray) -> tuple[float, float]:
        left_out = LEFT_OUT * np.sqrt(2.0 / 40) * float(np.sum(np.cos(waves @ y + phases)))
        rubbing = DAMPING * y[1] + FRICTION * np.tanh(y[1] / 1e-2)
        return y[1], (-MASS * GRAVITY * LENGTH * np.sin(y[0]) - rubbing + left_out) / about

    time, out = np.arange(0.0, 10.0, 0.02), []
    for k, start in enumerate(STARTS):
        exact = solve_ivp(slope, (0.0, time[-1]), (start, 0.0), t_eval=time, rtol=1e-9, atol=1e-11).y[0]
        read = exact + 1e-3 * random.normal(size=len(time))
        channel = Channel("pivot.position", "pivot", "position", "rad", constant(read))
        out.append(Recording(f"run{k}", f"run{k}", constant(time), (channel,)))
    return out


@pytest.mark.slow
def test_the_length_is_told_with_its_size_beside_a_force_that_nobody_has_named(tmp_path):
    model = tmp_path / "pendulum.toml"
    model.write_text(MODEL)
    found = harness.diagnose(decays(), model)
    told = {f["effect"]: f for f in found.findings if f["grade"] != "possible"}
    assert "com_offset" in told, found.summary
    low, high = told["com_offset"]["parameters"]["offset"]["ci95"]
    assert low < LENGTH - DRAWN < high
    assert high - low < 0.05
    # Nothing acts that is not there: damping is less than stated, dry friction as stated.
    assert set(told) <= {"com_offset", "viscous_damping"}
