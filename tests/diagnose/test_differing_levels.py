"""Friction, dry or viscous, that differs from recording to recording is told by a diagnosis, and only where it does."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from simulated_recordings import COM, GRAVITY, INERTIA, MASS, Rig, double_pendulum, nominal, recording, releases

import harness
from harness.recording import Recording
from harness.report.diagnosis import write_diagnosis

DRY = 6e-3  # N·m
NOISE = 5e-4  # rad
ANGLES = (1.4, 1.1, 0.9, 0.7)  # rad
ORDINARY = ("coulomb_friction", "viscous_damping", "quadratic_drag")


def mujoco_swing(name: str, level: float, angle: float, *, viscous: float = 0.0) -> Recording:
    """A free swing of 10 s at 100 Hz whose dry friction is DRY · level, or whose viscous damping is viscous · level instead."""
    dry = 0.0 if viscous else DRY * level
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.0005" integrator="RK4" gravity="0 0 -{GRAVITY}"><flag contact="disable"/></option>
        <compiler boundinertia="0"/><worldbody><body>
        <joint type="hinge" axis="0 1 0" damping="{viscous * level}" frictionloss="{dry}" solreffriction="0.001 1"/>
        <inertial pos="0 0 -{COM}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-4"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qpos[0] = angle
    position = []
    for k in range(20_000):
        if k % 20 == 0:
            position.append(float(data.qpos[0]))
        mujoco.mj_step(model, data)
    noise = NOISE * np.random.default_rng(round(1000 * angle)).standard_normal(len(position))
    return recording(name, 0.01 * np.arange(len(position)), {"pivot.position": np.array(position) + noise})


def test_damping_of_warm_grease_is_told_as_damping() -> None:
    """Dry friction at a level of its own in every recording would leave three times as much."""
    truth = (1.6, 1.3, 1.0, 1.1)
    runs = [mujoco_swing(f"run{k}", *one, viscous=4e-3) for k, one in enumerate(zip(truth, ANGLES, strict=True))]
    found = harness.diagnose(runs, model=nominal(), only=ORDINARY)
    levels = found.to_json()["levels"]
    assert levels["kind"] == "viscous damping"
    assert "Viscous damping differs from recording to recording" in found.summary
    for row, level in zip(levels["recordings"][:3], truth, strict=False):
        assert row["factor"] == pytest.approx(level, abs=0.02)
    assert max(row["levelled_rmse"] for row in levels["recordings"][:3]) < 1.1 * NOISE


def test_levels_that_differ_are_told_and_measured(tmp_path: Path) -> None:
    truth = (1.15, 0.92, 1.0, 1.05)
    runs = [mujoco_swing(f"run{k}", *one) for k, one in enumerate(zip(truth, ANGLES, strict=True))]
    found = harness.diagnose(runs, model=nominal(), only=ORDINARY)
    assert [f["effect"] for f in found.findings] == ["coulomb_friction"]
    levels = found.to_json()["levels"]
    assert levels["kind"] == "dry friction"
    assert levels["chance"] < 1e-5
    rows = levels["recordings"]
    # What went into MuJoCo, relative to the last training recording; the one held out was not fitted to and has no level.
    for row, level in zip(rows[:3], truth, strict=False):
        assert row["factor"] == pytest.approx(level, abs=0.015)
        assert row["factor"] == 1.0 or abs(row["factor"] - level) < 4.0 * row["std"]
    assert rows[3]["held_out"] and rows[3]["factor"] is None
    assert max(row["levelled_rmse"] for row in rows[:3]) < 1.1 * NOISE
    assert max(row["shared_rmse"] for row in rows[:3]) > 5.0 * NOISE
    assert "differs from recording to recording" in found.summary
    names = [path.name for path in write_diagnosis(found, tmp_path)]
    assert "levelled.toml" in names
    (law,) = harness.load(tmp_path / "levelled.toml").attachments
    assert law.parameters["torque"] == pytest.approx(DRY, rel=0.02)
    assert "recording by recording" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))["levels"] == levels


def different(torque: Callable[[float, float, float], float], dry: float, noise: float, seed: int) -> list[Recording]:
    """Swings from different heights under one law."""
    rig = Rig(dry=dry, torque=torque)
    every = [releases(rig, (angle,), noise, seed + k)[0] for k, angle in enumerate(ANGLES)]
    return [replace(run, name=f"run{k}") for k, run in enumerate(every)]


@pytest.mark.parametrize("noise", [1e-4, 1e-3, 4e-3])
def test_one_level_is_not_told_apart(noise: float) -> None:
    runs = different(lambda t, q, v: 0.0, DRY, noise, round(1e5 * noise))
    document = harness.diagnose(runs, model=nominal(), only=ORDINARY).to_json()
    assert document["verdict"] == "explained"
    assert "levels" not in document


@pytest.mark.parametrize(
    "law",
    [
        lambda t, q, v: -4e-3 * np.sign(v) * np.exp(-((v / 0.8) ** 2)),  # Stribeck's
        lambda t, q, v: -3e-3 * np.sign(v) * np.cos(3.0 * q),  # rubs more at some angles
        lambda t, q, v: -2e-3 * np.sign(v) * np.sqrt(abs(v)),
        lambda t, q, v: -4e-3 * np.sign(v) * (q * q + v * v / 30.0),  # more in wide swings
        lambda t, q, v: -3e-3 * np.sign(v) * np.exp(-t / 5.0),  # less as time goes on, alike in every recording
        lambda t, q, v: -0.02 * q**3,
    ],
    ids=["stribeck", "place", "root", "amplitude", "time", "spring"],
)
def test_a_law_that_is_wrong_alike_everywhere_is_not_taken_for_levels(law: Callable[..., float]) -> None:
    runs = different(law, 4e-3, 1e-3, 5)
    document = harness.diagnose(runs, model=nominal(), only=ORDINARY).to_json()
    assert document["verdict"] != "consistent"
    assert "levels" not in document


def mujoco_double_swing(name: str, level: float, start: tuple[float, float], seed: int) -> Recording:
    """A free swing of a double pendulum of 10 s at 100 Hz, dry friction of both joints times ``level``."""
    # As hard as MuJoCo's friction can be: a soft one creeps where it should hold.
    hard = 'solreffriction="0.001 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
    link = '<inertial pos="0 0 -0.15" mass="0.3" diaginertia="0.002 0.002 1e-4"/>'
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option integrator="RK4" timestep="0.0005" gravity="0 0 -{GRAVITY}"><flag contact="disable"/></option>
        <worldbody><body><joint axis="0 1 0" frictionloss="{4e-3 * level}" {hard}/>{link}
        <body pos="0 0 -0.3"><joint axis="0 1 0" frictionloss="{2e-3 * level}" {hard}/>{link}
        </body></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qpos[:] = start
    rows = []
    for k in range(20_000):
        if k % 20 == 0:
            rows.append(data.qpos.copy())
        mujoco.mj_step(model, data)
    q = np.array(rows) + 3e-4 * np.random.default_rng(seed).standard_normal((len(rows), 2))
    return recording(name, 0.01 * np.arange(len(q)), {"shoulder.position": q[:, 0], "elbow.position": q[:, 1]})


@pytest.mark.slow
@pytest.mark.parametrize("levels", [(1.2, 0.85, 1.0, 1.0), (1.0, 1.0, 1.0, 1.0)], ids=["differ", "equal"])
def test_levels_of_two_joints_together(levels: tuple[float, ...]) -> None:
    system, _ = double_pendulum(0.0, 1e-4, 0)
    starts = ((1.0, -0.5), (0.8, -0.9), (0.9, -0.2), (0.7, -0.6))
    runs = [
        mujoco_double_swing(f"run{k}", level, start, k)
        for k, (level, start) in enumerate(zip(levels, starts, strict=True))
    ]
    found = harness.diagnose(runs, model=system, only=("coulomb_friction", "viscous_damping")).to_json().get("levels")
    if levels[0] == 1.0:
        assert found is None
        return
    assert found["joints"] == ["shoulder", "elbow"]
    for row, level in zip(found["recordings"][:3], levels, strict=False):
        assert row["factor"] == pytest.approx(level, abs=0.02)
