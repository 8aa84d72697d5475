"""BAM's ladder of friction models as a peer: numbers that were put in by SciPy come out, and no step is climbed for nothing."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.compare.peers import servo_friction
from harness.compare.peers.runs import Run
from harness.compare.peers.servo_friction import LADDER, Arm, climb, fit_servo

pytest.importorskip("cmaes")

ARM = Arm(inertia=2.5e-2, cosine=0.0, sine=0.75)


def drop(angle: float, dry: float, viscous: float, noise: float, seed: int, load: float = 0.0) -> Run:
    """An arm let go at rest: J q̈ = −b sin q − viscous q̇ − (dry + load |b sin q|) sign q̇, stretch by stretch between reversals."""
    time = np.arange(0.0, 4.0, 5e-3)
    out = np.full(len(time), np.nan)
    t, q, filled = 0.0, angle, 0
    while filled < len(time):
        if abs(ARM.sine * np.sin(q)) * (1.0 - load) <= dry:
            out[filled:] = q
            break
        sense = -np.sign(np.sin(q))

        def rate(_, y, sense=sense):
            weight = ARM.sine * np.sin(y[0])
            return [y[1], (-weight - viscous * y[1] - (dry + load * abs(weight)) * sense) / ARM.inertia]

        def turn(s, y, sense=sense, t=t):
            return sense * y[1] if s > t + 1e-3 else 1.0

        turn.terminal, turn.direction = True, -1
        found = solve_ivp(rate, (t, 4.0), [q, 0.0], "DOP853", rtol=1e-9, atol=1e-11, dense_output=True, events=turn)
        upto = int(np.searchsorted(time, found.t[-1], side="right"))
        out[filled:upto] = found.sol(time[filled:upto])[0]
        filled, t, q = upto, float(found.t[-1]), float(found.y[0, -1])
        if t >= 4.0:
            break
    rng = np.random.default_rng(seed)
    return Run(time, (out + noise * rng.standard_normal(len(time)))[:, None])


@pytest.mark.slow
def test_the_step_that_made_the_motion_is_climbed_to() -> None:
    runs = [drop(angle, 0.03, 0.01, 1e-3, k) for k, angle in enumerate((1.4, 0.9, 1.2))]
    found, errors = climb(ARM, runs[:2], runs[2:])
    assert found.model == "m1"
    assert found.values["friction_base"] == pytest.approx(0.03, rel=0.05)
    assert found.values["friction_viscous"] == pytest.approx(0.01, rel=0.05)
    assert found.heldout == pytest.approx(1e-3, rel=0.3)
    assert errors["none"] > 10.0 * errors["m1"]
    assert set(LADDER) - set(errors) == {"m5", "m6"}


def test_load_dependent_friction_is_found() -> None:
    runs = [drop(angle, 0.01, 0.0, 1e-3, k, load=0.1) for k, angle in enumerate((1.4, 0.9))]
    found = fit_servo(ARM, runs, "m3")
    assert found.values["load_friction_base"] == pytest.approx(0.1, rel=0.1)
    assert found.mae < 2e-3


@pytest.mark.parametrize("model", ["m3", "m4", "m5"])
def test_a_step_is_no_worse_than_one_that_is_a_special_case_of_it(model: str, monkeypatch) -> None:
    # Forty tries are too few for the step's own search, which begins elsewhere; m3 is m5 with both loads alike.
    runs = [drop(angle, 0.03, 0.01, 1e-3, k, load=0.05) for k, angle in enumerate((1.4, 0.9))]
    runs = [Run(r.time, r.positions, np.zeros_like(r.positions)) for r in runs]
    below = fit_servo(ARM, runs, "m1" if model == "m3" else "m3")
    monkeypatch.setattr(servo_friction, "EVALUATIONS", 40)
    assert fit_servo(ARM, runs, model).mae > 1.5 * below.mae
    found = fit_servo(ARM, runs, model, below=[below])
    assert found.mae <= below.mae * (1.0 + 1e-9)
