"""A wheel whose centre of mass is beside its axis, and one whose encoder errs once a turn; SciPy is the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.diagnose.diagnose import diagnose
from harness.effects.encoder_interpolation import EFFECT as ENCODER
from harness.effects.imbalance import EFFECT as IMBALANCE

MASS, INERTIA, DAMPING, GRAVITY, NOISE = 1.5, 0.004, 0.0004, 9.81, 2e-4
MODEL = f"""
name = "wheel"
tolerance = 0.01
[[joint]]
name = "shaft"
type = "revolute"
parent = "base"
child = "disc"
axis = [0, 1, 0]
damping = {DAMPING}
[[link]]
name = "disc"
mass = {MASS}
com = [0, 0, 0]
inertia = [0.002, {INERTIA}, 0.002]
"""
ONLY = ("imbalance", "encoder_interpolation", "cogging_torque", "coulomb_friction", "viscous_damping")


def runs(folder: Path, *, x: float = 0.0, z: float = 0.0, eccentric: float = 0.0) -> list[Path]:
    """Three wheels that run out.

    x, z: place of the centre of mass [m]. eccentric: error of the encoder [rad].
    """
    time, inertia = np.arange(0.0, 5.0, 0.005), INERTIA + MASS * (x**2 + z**2)
    rng, out = np.random.default_rng(4), []
    for k, speed in enumerate((9.0, 14.0, 11.0)):

        def slope(t: float, s: np.ndarray) -> list[float]:
            pull = MASS * GRAVITY * (x * np.cos(s[0]) + z * np.sin(s[0]))
            return [s[1], (pull - DAMPING * s[1]) / inertia]

        q = solve_ivp(slope, (0.0, 5.0), [0.4 * k, speed], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
        seen = q + eccentric * np.sin(q + 1.1) + NOISE * rng.standard_normal(len(q))
        out.append(folder / f"run{k}.csv")
        np.savetxt(out[-1], np.column_stack([time, seen]), delimiter=",", header="time,shaft.position", comments="")
    return out


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    file = tmp_path / "wheel.toml"
    file.write_text(MODEL, encoding="utf-8")
    return file


def test_a_wheel_beside_its_axis_is_named_with_its_offsets(tmp_path: Path, wheel: Path) -> None:
    found = diagnose(runs(tmp_path, x=0.0002, z=-0.00035), wheel, only=ONLY)
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["imbalance@disc"]
    told = found.findings[0]["parameters"]
    for name, true in (("u", -0.00035), ("v", 0.0002)):
        low, high = told[name]["ci95"]
        assert low <= true <= high
        assert high - low < 0.1 * abs(true)


def test_an_error_of_the_encoder_once_a_turn_is_no_imbalance(tmp_path: Path, wheel: Path) -> None:
    found = diagnose(runs(tmp_path, eccentric=0.004), wheel, only=ONLY)
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["encoder_interpolation@shaft.position"]


def test_each_is_known_to_be_mistaken_for_the_other() -> None:
    assert ENCODER.name in IMBALANCE.confusable_with
    assert IMBALANCE.name in ENCODER.confusable_with
