"""Dry friction at another level in every recording; the recordings are made by MuJoCo."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from harness.diagnose.levels.levels import fit_levels
from harness.errors import InputError
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import Attachment, System, load

MASS, COM, INERTIA = 0.15, 0.15, 1.1e-4
DRY = 6e-4  # N·m
NOISE = 1e-4  # rad

URDF = f"""<robot name="arm"><link name="base"/>
<joint name="pivot" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<link name="arm"><inertial><origin xyz="0 0 {-COM}"/><mass value="{MASS}"/>
<inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> System:
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(URDF, encoding="utf-8")
    return load(path)


def swing(name: str, level: float, angle: float, *, drag: float = 1.5e-5) -> Recording:
    """A free swing of 6 s at 200 Hz with dry friction DRY · level and drag over speed squared."""
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.0005" integrator="RK4"><flag contact="disable"/></option><worldbody><body>
        <joint type="hinge" axis="0 1 0" damping="0 {drag} 0" frictionloss="{DRY * level}" solreffriction="0.001 1"/>
        <inertial pos="0 0 {-COM}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-6"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qpos[0] = angle
    time, position = [], []
    for k in range(12000):
        if k % 10 == 0:
            time.append(data.time)
            position.append(float(data.qpos[0]))
        mujoco.mj_step(model, data)
    values = np.array(position) + NOISE * np.random.default_rng(round(1000 * angle)).standard_normal(len(position))
    return Recording(
        name, f"{name}.csv", np.array(time), (Channel("pivot.position", "pivot", "position", "rad", values),)
    )


def test_every_recording_has_its_level(system: System) -> None:
    runs = [swing("first", 1.15, 1.4), swing("second", 0.92, 1.1), swing("third", 1.0, 0.9)]
    start = replace(
        system,
        attachments=(
            Attachment("coulomb_friction", "pivot", {"torque": 4e-4}),
            Attachment("quadratic_drag", "pivot", {"coefficient": 1e-5}),
        ),
    )
    found = fit_levels(start, runs)
    # Levels and laws as they went into MuJoCo; the levels' scale is the last recording's.
    assert found.levels["third"] == 1.0
    assert found.levels["first"] == pytest.approx(1.15, abs=0.015)
    assert found.levels["second"] == pytest.approx(0.92, abs=0.015)
    dry, drag = found.system.attachments
    assert dry.parameters["torque"] == pytest.approx(DRY, rel=0.02)
    assert drag.parameters["coefficient"] == pytest.approx(1.5e-5, rel=0.05)
    assert abs(dry.parameters["torque"] - DRY) < 4.0 * dry.std["torque"]
    assert max(found.rmse.values()) < 1.3 * NOISE


def test_one_level_for_all_fits_worse(system: System) -> None:
    runs = [swing("first", 1.15, 1.4), swing("second", 0.92, 1.1)]
    start = replace(system, attachments=(Attachment("coulomb_friction", "pivot", {"torque": 5e-4}),))
    free, tied = fit_levels(start, runs), fit_levels(start, runs, spread=1e-6)
    assert tied.levels["first"] == pytest.approx(1.0, abs=1e-3)
    assert max(tied.rmse.values()) > 5.0 * max(free.rmse.values())


def test_driven_and_unmeasured_recordings_are_refused(system: System) -> None:
    run = swing("first", 1.0, 0.9)
    effort = Channel("pivot.effort", "pivot", "effort", "N*m", np.ones(run.samples))
    with pytest.raises(InputError, match="driven"):
        fit_levels(system, [replace(run, efforts=(effort,))])
    with pytest.raises(InputError, match="not measured"):
        fit_levels(system, [replace(run, channels=())])
    with pytest.raises(InputError, match="no recording"):
        fit_levels(system, [])
