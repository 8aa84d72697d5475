"""Second encoders behind the gear: an elastic joint integrated by SciPy (Spong 1987) is the truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.diagnose import diagnose
from harness.diagnose.transmission.second_encoders import parted
from harness.diagnose.transmission.transmission import links_apart, with_second_encoders
from harness.errors import InputError
from harness.recording import read_recordings
from harness.recording.recording import QualityNote
from harness.system import load

MASS, LENGTH, ROTOR, GRAVITY = 2.0, 0.5, 0.05, 9.81
RATE, DURATION, NOISE, TORQUE_NOISE = 250.0, 12.0, 1e-5, 0.01
MODEL = f"""
name = "arm"
gravity = [0.0, 0.0, -{GRAVITY}]
tolerance = 0.01
[[joint]]
name = "shoulder"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
armature = {ROTOR}
{{friction}}
[[link]]
name = "arm"
mass = {MASS}
com = [0.0, 0.0, -{LENGTH}]
inertia = [1e-9, 1e-9, 1e-9]
"""


def recorded(
    seed: int, *, stiffness: float = 900.0, gap: float = 0.0, late: float = 0.0, gain: float = 1.0, damping: float = 0.8
) -> np.ndarray:
    """Columns time, position, link position and effort of a driven arm; rigid where the stiffness is infinite.

    Drive: J q̈ = u − d q̇ − τ; link: m l² θ̈ = τ − m g l sin θ; τ = k (q − θ) beyond half the gap, with a little damping.
    """
    rng = np.random.default_rng(seed)
    phase, share = rng.uniform(0.0, 2.0 * np.pi, 5), rng.uniform(0.3, 1.0, 5)
    inertia, weight = MASS * LENGTH**2, MASS * GRAVITY * LENGTH
    omega = 2.0 * np.pi * np.array([0.15, 0.35, 0.6, 0.9, 1.4])
    rigid = not np.isfinite(stiffness)

    def wanted(t: Any) -> Any:
        return 0.25 * np.sin(np.multiply.outer(t, omega) + phase) @ share

    def wanted_rate(t: Any) -> Any:
        return 0.25 * np.cos(np.multiply.outer(t, omega) + phase) @ (share * omega)

    def drive(t: Any, q: Any, v: Any) -> Any:
        return 60.0 * (wanted(t) - q) + 8.0 * (wanted_rate(t) - v) + weight * np.sin(wanted(t))

    def coupling(q: Any, v: Any, theta: Any, rate: Any) -> Any:
        twist = q - theta
        beyond = twist - np.clip(twist, -0.5 * gap, 0.5 * gap)
        return stiffness * beyond + np.where(beyond != 0.0, 1.5 * (v - rate), 0.0)

    def slope(t: float, x: np.ndarray) -> list[float]:
        q, v, theta, rate = x
        u = drive(t, q, v)
        if rigid:
            a = (u - damping * v - weight * np.sin(q)) / (inertia + ROTOR)
            return [v, a, v, a]
        torque = coupling(q, v, theta, rate)
        return [v, (u - damping * v - torque) / ROTOR, rate, (torque - weight * np.sin(theta)) / inertia]

    time = np.arange(0.0, DURATION, 1.0 / RATE)
    begun = [float(wanted(0.0)), float(wanted_rate(0.0))] * 2
    found = solve_ivp(slope, (0.0, DURATION), begun, method="LSODA", t_eval=time, rtol=1e-9, atol=1e-11)
    q, v, theta, _ = found.y
    seen = gain * CubicSpline(time, theta)(time - late) + 0.02
    effort = drive(time, q, v) + TORQUE_NOISE * rng.standard_normal(len(time))
    noise = NOISE * rng.standard_normal((2, len(time)))
    return np.column_stack([time, q + noise[0], seen + noise[1], effort])


def written(folder: Path, *, effort: bool = True, **truth: float) -> list[Path]:
    out = []
    for seed in range(3):
        table = recorded(seed, **truth)
        file = folder / f"run{seed}.csv"
        heads = ["time", "shoulder.position", "shoulder.link_position", "shoulder.effort"]
        count = 4 if effort else 3
        np.savetxt(file, table[:, :count], delimiter=",", header=",".join(heads[:count]), comments="", fmt="%.9g")
        out.append(file)
    return out


def model(folder: Path, friction: str = "damping = 0.8") -> Path:
    file = folder / "model.toml"
    file.write_text(MODEL.format(friction=friction), encoding="utf-8")
    return file


def few(files: list[Path], system: Path) -> Any:
    """The diagnosis by few effects of the drive, which saves time."""
    return diagnose(files, system, fit_effort=True, only=("viscous_damping", "coulomb_friction", "payload_mass"))


def told(found: Any) -> dict[tuple[str, str], dict[str, Any]]:
    rows = [
        f for f in found.findings if f["effect"] in ("joint_flexibility", "backlash") or "link_position" in f["site"]
    ]
    return {(row["effect"], row["site"]): row for row in rows}


def holds(row: dict[str, Any], name: str, truth: float) -> bool:
    low, high = row["parameters"][name]["ci95"]
    return bool(low <= truth <= high)


def test_a_flexible_joint_and_a_late_second_encoder_are_both_told(tmp_path: Path) -> None:
    files = written(tmp_path, stiffness=900.0, late=0.002)
    found = diagnose(files, model(tmp_path), fit_effort=True)
    rows = told(found)
    assert set(rows) == {("joint_flexibility", "shoulder"), ("sensor_delay", "shoulder.link_position")}
    spring, late = rows["joint_flexibility", "shoulder"], rows["sensor_delay", "shoulder.link_position"]
    assert holds(spring, "stiffness", 900.0) and spring["parameters"]["stiffness"]["std"] < 45.0
    # The drive's reading and the link's are both exact to 0.01 mrad; interpolation of a late reading costs a little more.
    assert holds(late, "delay", 0.002) and late["parameters"]["delay"]["std"] < 1e-4
    assert [row["grade"] for row in rows.values()] == ["established"] * 2
    assert {r["recording"] for r in spring["repeatability"]} == {"run0", "run1", "run2"}
    assert "By the encoders behind the gears" in found.summary
    fit = {row["channel"]: row for row in found.fit}["shoulder.link_position"]
    assert fit["augmented"]["heldout_rmse"] < 0.05 * fit["refitted"]["heldout_rmse"]
    assert found.augmented is not None
    assert [a.effect for a in found.augmented.attachments if a.site == "shoulder"] == ["joint_flexibility"]


def test_a_stiff_joint_has_nothing_told_of_it(tmp_path: Path) -> None:
    found = few(written(tmp_path, stiffness=np.inf), model(tmp_path))
    assert not told(found)
    assert found.verdict == "consistent"
    assert "read what those of the drives do" in found.summary


def test_play_is_told_from_a_spring(tmp_path: Path) -> None:
    # Teeth of 2·10⁴ N·m/rad give by half a milliradian under the arm's weight, beside 4 of play.
    rows = told(few(written(tmp_path, stiffness=2e4, gap=0.004), model(tmp_path)))
    assert ("backlash", "shoulder") in rows
    assert rows["backlash", "shoulder"]["parameters"]["gap"]["value"] == pytest.approx(0.004, rel=0.05)


def test_a_gain_of_the_second_encoder_is_no_spring(tmp_path: Path) -> None:
    rows = told(few(written(tmp_path, stiffness=np.inf, gain=0.99), model(tmp_path)))
    assert set(rows) == {("sensor_gain", "shoulder.link_position")}
    assert holds(rows["sensor_gain", "shoulder.link_position"], "gain", 0.99)


def test_a_load_that_efforts_correct_is_the_one_that_twists(tmp_path: Path) -> None:
    # The model's arm is a fifth too light; the payload that the efforts show makes up for it.
    files, light = written(tmp_path, stiffness=900.0), model(tmp_path)
    light.write_text(light.read_text(encoding="utf-8").replace(f"mass = {MASS}", "mass = 1.6"), encoding="utf-8")
    rows = told(few(files, light))
    assert holds(rows["joint_flexibility", "shoulder"], "stiffness", 900.0)


def test_a_second_encoder_alone_is_refused_in_one_line(tmp_path: Path) -> None:
    files = written(tmp_path)
    for file in files:
        file.write_text(file.read_text(encoding="utf-8").replace("shoulder.position", "other"), encoding="utf-8")
    with pytest.raises(InputError, match=r"shoulder.link_position is read behind the gear.*name it shoulder\.position"):
        diagnose(files, model(tmp_path), fit_effort=True)


def test_recordings_too_short_for_it_are_told(tmp_path: Path) -> None:
    system = load(model(tmp_path))
    read = read_recordings(written(tmp_path), system=system)
    note = QualityNote("carried_start", "shoulder", "", "left out")
    short, second = parted([r.only(r.time < 0.5, note) for r in read])
    nothing = Diagnosis("consistent", "", [], [], [], [], [], {}, {})
    found = with_second_encoders(nothing, system, short, None, links_apart(system, short, None, second))
    assert [q["kind"] for q in found.quality] == ["ignored_column"] * 3
    assert "too little is recorded" in found.quality[0]["what"]


def test_a_mechanism_that_is_no_tree_says_that_it_is_left_out(tmp_path: Path) -> None:
    system = load(model(tmp_path))
    read, second = parted(read_recordings(written(tmp_path), system=system))
    nothing = Diagnosis("consistent", "", [], [], [], [], [], {}, {})
    gimbals: Any = (None,)
    looped = replace(system, gimbals=gimbals)
    found = with_second_encoders(nothing, looped, read, None, second)
    assert [(q["kind"], q["channel"]) for q in found.quality] == [("ignored_column", "shoulder.link_position")] * 3
    assert not found.findings
