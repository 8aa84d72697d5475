"""A support that moves up and down is not told as one that moves sideways, and what is left names it with its frequency.

Mathieu's pendulum, integrated by SciPy: I q̈ = −m l (g + a sin(ω t + φ)) sin q − c q̇, another phase in every recording.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import COM, MASS, Rig, nominal, recording

from harness import diagnose
from harness.diagnose.criticism.shaken_support import UP_AND_DOWN, _gravity
from harness.recording import Recording

RIG = Rig()
SHAKING, FREQUENCY, DAMPING, NOISE = 0.12, 1.37, 6e-4, 1e-3  # m/s², Hz, N·m·s/rad, rad


def _run(number: int, release: float, shaking: float = SHAKING, frequency: float = FREQUENCY) -> Recording:
    time = np.arange(0.0, 14.0, 0.01)
    rng = np.random.default_rng(number)
    phase = rng.uniform(0.0, 2.0 * np.pi)

    def rate(t: float, y: np.ndarray) -> list[float]:
        moment = RIG.moment + MASS * COM * shaking * np.sin(2.0 * np.pi * frequency * t + phase)
        return [y[1], (-moment * np.sin(y[0]) - DAMPING * y[1]) / RIG.about_joint]

    course = solve_ivp(rate, (0.0, 14.0), [release, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    return recording(f"run{number}", time, {"pivot.position": course + NOISE * rng.standard_normal(len(time))})


def test_gravity_along_a_motion_is_that_of_the_textbook() -> None:
    angles = np.linspace(-2.0, 2.0, 9)
    forces = _gravity(("pivot",), nominal(), angles[:, None])
    np.testing.assert_allclose(forces[:, 0], -RIG.moment * np.sin(angles), rtol=1e-12, atol=1e-14)


def test_it_is_not_told_as_shaking_sideways() -> None:
    found = diagnose([_run(k, release) for k, release in enumerate((0.5, -0.35, 0.65))], model=nominal())
    assert found.verdict in ("unexplained", "partly_explained")
    assert {finding["effect"] for finding in found.findings} <= {"viscous_damping"}
    (test,) = (t for t in found.remainder["tests"] if t["what"] == UP_AND_DOWN)
    # Beside a force that is left out few readings count as independent, and no chance is small; of all that was asked it is
    # what takes most of what is left.
    assert test["gain"] == max(t["gain"] for t in found.remainder["tests"])
    # Recordings of 14 s part frequencies a fourteenth of a hertz apart; half of that are the places tried.
    assert float(test["where"][0].split()[1]) == pytest.approx(FREQUENCY, abs=1.0 / 14.0)


def test_strong_pumping_of_a_single_recording_is_not_told_as_shaking_sideways() -> None:
    # The swing is changed by more than a linear view is good for, and a fit of a base that shakes sideways takes most of it.
    found = diagnose([_run(1, 1.2, 0.4, 1.5)], model=nominal())
    assert found.verdict in ("unexplained", "partly_explained")
    assert "base_excitation" not in {finding["effect"] for finding in found.findings}
