"""Efforts that a controller held from sample to sample are taken as held, and no lateness of drive or sensor is told for it.

Recordings by MuJoCo, which keeps an applied force for a whole step; the drive is as rough as one that feeds back a noisy sensor.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from simulated_recordings import recording

from harness import diagnose
from harness.cases.pendulums import hinge
from harness.denoc.motion.hold import joined, kept
from harness.diagnose.problem.drive import Drive
from harness.diagnose.problem.problem import Run
from harness.recording import Recording
from harness.system import Link, System
from harness.system.description import constant

INTERVAL, SUBSTEPS = 0.004, 8
NOISE = 1e-3
DAMPING = 2e-3  # N·m·s/rad
# What rubs, and all that could be late in a drive's or a sensor's place.
RIVALS = (
    "viscous_damping", "coulomb_friction", "quadratic_drag", "actuator_gain", "actuator_delay", "sensor_delay", "sensor_lowpass",
)  # fmt: skip
LINKS = (("shoulder", "upper", 0.0, 0.5, 0.15, 4e-3), ("elbow", "lower", 0.3, 0.3, 0.12, 1.8e-3))


def _arm() -> System:
    joints, links = [], []
    parent = "base"
    for name, link, down, mass, com, inertia in LINKS:
        joints.append(hinge(name, parent, link, down))
        links.append(Link(link, mass, constant([0.0, 0.0, -com]), constant(np.diag([inertia, inertia, 4e-4]))))
        parent = link
    return System("arm", tuple(joints), tuple(links), tolerance=0.01)


def _mujoco(damping: float) -> mujoco.MjModel:
    bodies, ends = "", ""
    for name, _, down, mass, com, inertia in LINKS:
        own = damping if name == "elbow" else 0.0
        bodies += (
            f'<body pos="0 0 {-down}"><joint name="{name}" axis="0 1 0" damping="{own}"/>'
            f'<inertial pos="0 0 {-com}" mass="{mass}" diaginertia="{inertia} {inertia} 4e-4"/>'
        )
        ends += "</body>"
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{INTERVAL / SUBSTEPS}" integrator="RK4"/><worldbody>{bodies}{ends}</worldbody></mujoco>'
    )


def _driven(damping: float, seed: int) -> list[Recording]:
    model, rng = _mujoco(damping), np.random.default_rng(seed)
    time = np.arange(0.0, 10.0, INTERVAL)
    found = []
    for k in range(3):
        frequency, phase = rng.uniform(1.2, 4.0, (2, 8)), rng.uniform(0.0, 2.0 * np.pi, (2, 8))
        waves = np.sin(2.0 * np.pi * frequency[:, :, None] * time + phase[:, :, None]).sum(axis=1) / 2.0
        effort = np.array([[0.25], [0.03]]) * waves + np.array([[0.02], [0.01]]) * rng.standard_normal(waves.shape)
        data, angles = mujoco.MjData(model), []
        for tau in effort.T:
            angles.append(data.qpos.copy())
            data.qfrc_applied[:] = tau
            for _ in range(SUBSTEPS):
                mujoco.mj_step(model, data)
        seen = np.array(angles).T + NOISE * rng.standard_normal(waves.shape)
        columns = {f"{link[0]}.position": seen[j] for j, link in enumerate(LINKS)}
        columns |= {f"{link[0]}.effort": effort[j] for j, link in enumerate(LINKS)}
        found.append(recording(f"run{k}", time, columns))
    return found


def test_a_held_drive_is_no_finding() -> None:
    found = diagnose(_driven(0.0, 5), model=_arm())
    assert found.verdict == "consistent"
    assert {n["channel"] for n in found.quality if n["kind"] == "held_effort"} == {"shoulder.effort", "elbow.effort"}


def test_beside_a_held_drive_damping_alone_is_told() -> None:
    found = diagnose(_driven(DAMPING, 6), model=_arm(), only=RIVALS)
    assert found.verdict == "explained"
    (told,) = found.findings
    assert (told["effect"], told["site"]) == ("viscous_damping", "elbow")
    low, high = told["parameters"]["coefficient"]["ci95"]
    # An interval of 95 % is four standard deviations wide; within three of them the truth is but once in four hundred not.
    assert low - 0.25 * (high - low) < DAMPING < high + 0.25 * (high - low)
    assert any(n["kind"] == "held_effort" for n in found.quality)


def _run(count: int, averaged: int = 1) -> Run:
    return Run("run", 0.01 * np.arange(count), np.zeros((1, count)), np.zeros((count, 1)), 0.01, averaged)


def test_a_held_effort_keeps_each_sample_until_the_next() -> None:
    drive = Drive(_run(5), np.array([[1.0, -2.0, 3.0, 0.5, 4.0]]), held=True)
    finer = drive.at(0.0025 * np.arange(20))
    assert finer == pytest.approx(np.repeat([1.0, -2.0, 3.0, 0.5, 4.0], 4), abs=1e-12)


def _pushed(forces: np.ndarray, step: float) -> np.ndarray:
    """Where a free unit mass is at every point of a grid whose forces are held to the next one."""
    speed = np.concatenate([[0.0], np.cumsum(forces)]) * step
    return np.concatenate([[0.0], np.cumsum(speed[:-1] * step + 0.5 * forces * step**2)])


@pytest.mark.parametrize("late", [0.0, 0.0025, 0.0041])
def test_a_grid_out_of_step_moves_a_mass_as_the_held_samples_do(late: float) -> None:
    # The truth in steps that every change falls on the edge of.
    time = 0.01 * np.arange(300)
    samples = np.sin(9.0 * time) + 0.3 * np.sin(31.0 * time)
    fine, coarse = 1e-4, 0.01
    begin = 0.5 + late
    truth = np.repeat(samples, 100)[round(begin / fine) :][: 20000 + 1]
    grid = begin + coarse * np.arange(200)
    found = _pushed(Drive(_run(300), samples[None], held=True).at(grid), coarse)[:-1]
    wanted = _pushed(truth, fine)[:20000:100]
    line = np.stack([np.ones(200), grid], axis=1)  # where it begins and how fast is fitted
    left = wanted - found - line @ np.linalg.lstsq(line, wanted - found, rcond=None)[0]
    # The mean over steps alone is right to (ω h)²/8 at worst, a hundredth for the faster wave.
    assert np.std(left) < 2e-4 * np.std(wanted - line @ np.linalg.lstsq(line, wanted, rcond=None)[0])


@pytest.mark.parametrize("block", [2, 3, 5])
def test_samples_averaged_in_blocks_move_a_mass_as_the_held_ones_do(block: int) -> None:
    time = 0.002 * np.arange(3000)
    samples = np.sin(9.0 * time) + 0.3 * np.sin(21.0 * time)
    places = _pushed(samples, 0.002)[:-1]
    blocks = [values.reshape(-1, block).mean(axis=1) for values in (time, samples, places)]
    run = Run("run", blocks[0], blocks[2][None], blocks[1][:, None], 0.002 * block, block)
    fine = 0.001
    grid = np.arange(0.0, blocks[0][-1] - blocks[0][0], fine)
    forces = Drive(run, blocks[1][None], held=True).at(grid)
    found = _pushed(forces, fine)
    # Of the places of a block the mean is that of its middle and what the acceleration adds to second order.
    middle = np.round((blocks[0] - blocks[0][0]) / fine).astype(int)[10:-10]
    spread = 0.5 * np.var(0.002 * np.arange(block))
    read = found[middle] + spread * forces[middle]
    line = np.stack([np.ones(len(middle)), grid[middle]], axis=1)
    wanted = blocks[2][10:-10]
    left = wanted - read - line @ np.linalg.lstsq(line, wanted - read, rcond=None)[0]
    assert np.std(left) < 1e-4 * np.std(wanted - line @ np.linalg.lstsq(line, wanted, rcond=None)[0])


def test_blocks_of_held_samples_begin_with_their_first_one() -> None:
    # Two samples 5 ms apart in each, stamped with their middle: held from 2.5 ms before on.
    drive = Drive(_run(40, averaged=2), np.linspace(0.0, 39.0, 40)[None], held=True)
    (found,) = drive.at(np.array([0.1975, 0.2075]))[:1]
    assert found == pytest.approx(20.0, abs=1e-9)


def test_a_smooth_effort_passes_through_its_samples() -> None:
    time = 0.01 * np.arange(200)
    wave = np.sin(2.0 * np.pi * 3.0 * time)
    drive = Drive(_run(200), wave[None], held=False)
    fine = np.linspace(0.5, 1.5, 20001)
    # Its straight lines act on what is slow as the wave does: the part in phase with it is whole.
    whole = np.sin(2.0 * np.pi * 3.0 * fine)
    assert np.sum(drive.at(fine) * whole) / np.sum(whole**2) == pytest.approx(1.0, abs=1e-4)


def test_forces_change_between_held_and_joined_without_losing_impulse() -> None:
    # Exactly so for what changes evenly: then both ways give back what they were given, half a step apart.
    ramp = np.linspace(0.0, 9.0, 10)[None, :, None]
    assert kept(ramp)[0, :-1, 0] == pytest.approx(np.arange(9) + 0.5)
    assert joined(kept(ramp))[0, 1:-1, 0] == pytest.approx(ramp[0, 1:-1, 0])
