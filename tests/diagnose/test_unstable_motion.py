"""Mechanisms that fall over without their motors: errors grow fast, and windows are as short as that asks for.

Truths by closed form, recordings by MuJoCo.
"""

from __future__ import annotations

import mujoco
import numpy as np
from simulated_recordings import nominal, recording

from harness import diagnose
from harness.cases.pendulums import hinge
from harness.diagnose.estimation.constants import FORETOLD_GROWTH_AT_FIRST, PIECES_A_SWING
from harness.diagnose.estimation.horizon import Horizon, transitions
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.effects.scale import references
from harness.recording import Recording
from harness.system import Link, System
from harness.system.description import constant

INTERVAL = 0.01
SAMPLES = 801
RATE = references(nominal(), "pivot").frequency


def at_rest(angle: float) -> tuple[Problem, Predictor]:
    """A recording of a pendulum that stands still, hanging (0) or upside down (π)."""
    values = np.full((1, SAMPLES), angle)
    run = Run("run", INTERVAL * np.arange(SAMPLES), values, None, INTERVAL)
    problem = Problem(nominal(), (ChannelInfo("pivot.position", "pivot", "position", "rad"),), (run,), (run,))
    return problem, Predictor(problem)


def seconds(window: Window) -> float:
    return INTERVAL * (window.size - 1)


def test_an_error_of_what_stands_upside_down_grows_as_the_exponential() -> None:
    # θ'' = ω² θ, in units of 1 and ω: ((cosh, sinh), (sinh, cosh)) of ω t, symmetric; its largest eigenvalue is exp(ω t).
    _, predictor = at_rest(np.pi)
    window = Window(0, 0, 81)
    (found,) = transitions(predictor, np.zeros(len(predictor.nominal)), [window], [np.array([np.pi, 0.0])], float(RATE))
    turn = RATE * seconds(window)
    wanted = np.array([[np.cosh(turn), np.sinh(turn)], [np.sinh(turn), np.cosh(turn)]])
    assert np.abs(found - wanted).max() < 1e-4 * wanted.max()


def test_windows_of_what_stands_upside_down_are_halved_until_errors_stay_small() -> None:
    problem, predictor = at_rest(np.pi)
    whole = Window(0, 0, SAMPLES)
    found = Horizon(problem, predictor, float(RATE)).calm((whole,))
    assert [w.first for w in found[1:]] == [w.last for w in found[:-1]]
    assert (found[0].first, found[-1].last) == (0, SAMPLES)
    lengths = np.array([seconds(w) for w in found])
    longest = np.log(FORETOLD_GROWTH_AT_FIRST) / RATE
    # Growth is counted in pieces, which may reach beyond a window at either end.
    beyond = 2.0 * (2.0 * np.pi / RATE / PIECES_A_SWING)
    assert lengths.max() < longest < 2.0 * (lengths.min() + beyond)


def test_windows_of_what_hangs_are_left_whole() -> None:
    problem, predictor = at_rest(0.0)
    whole = Window(0, 0, SAMPLES)
    assert Horizon(problem, predictor, float(RATE)).calm((whole,)) == (whole,)


# --- an arm that stands up, held by its motors -----------------------------------------------------------------------

PERIOD, SUBSTEPS = 0.01, 20
NOISE = 3e-4
DAMPING = 0.4  # N·m·s/rad
# joint, link, height of the joint [m], mass [kg], centre [m], inertia [kg·m²]
LINKS = (("shoulder", "upper", 0.0, 3.0, 0.2, 0.05), ("elbow", "lower", 0.4, 2.0, 0.15, 0.02))
# How much heavier and how much harder to turn the links are than stated, in a tolerance of a hundredth.
OFF = ((1.012, 0.99), (0.985, 1.008))
RIVALS = (
    "viscous_damping", "coulomb_friction", "quadratic_drag", "joint_stiffness", "payload_mass", "constant_torque",
    "actuator_gain", "actuator_delay", "sensor_offset", "sensor_delay",
)  # fmt: skip


def arm() -> System:
    joints, links = [], []
    parent = "base"
    for name, link, height, mass, com, inertia in LINKS:
        joints.append(hinge(name, parent, link, -height))
        links.append(Link(link, mass, constant([0.0, 0.0, com]), constant(np.diag([inertia, inertia, 4e-3]))))
        parent = link
    return System("arm", tuple(joints), tuple(links), tolerance=0.01)


def held_up(damping: float, seed: int) -> list[Recording]:
    """Three recordings of the arm that follows sines, by feedback of its angles at 100 Hz."""
    bodies, ends = "", ""
    for (name, _, height, mass, com, inertia), (heavier, harder) in zip(LINKS, OFF, strict=True):
        own = damping if name == "shoulder" else 0.0
        turn = inertia * heavier * harder
        bodies += (
            f'<body pos="0 0 {height}"><joint name="{name}" axis="0 1 0" damping="{own}"/>'
            f'<inertial pos="0 0 {com}" mass="{mass * heavier}" diaginertia="{turn} {turn} 4e-3"/>'
        )
        ends += "</body>"
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{PERIOD / SUBSTEPS}" integrator="RK4"/><worldbody>{bodies}{ends}</worldbody></mujoco>'
    )
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 6.0, PERIOD)
    found = []
    for k in range(3):
        size, rate, phase = rng.uniform(0.15, 0.4, (2, 3)), rng.uniform(1.0, 5.0, (2, 3)), rng.uniform(0.0, 6.0, (2, 3))
        data = mujoco.MjData(model)

        def wanted(t: float, size=size, rate=rate, phase=phase) -> tuple[np.ndarray, np.ndarray]:
            turn = rate * t + phase
            return (size * np.sin(turn)).sum(axis=1), (size * rate * np.cos(turn)).sum(axis=1)

        data.qpos[:], data.qvel[:] = wanted(0.0)
        angles, torques = [], []
        for t in time:
            mujoco.mj_forward(model, data)
            q, v = wanted(float(t))
            tau = data.qfrc_bias + np.array([30.0, 8.0]) * (q - data.qpos) + np.array([4.0, 1.0]) * (v - data.qvel)
            angles.append(data.qpos.copy())
            torques.append(tau)
            data.qfrc_applied[:] = tau
            for _ in range(SUBSTEPS):
                mujoco.mj_step(model, data)
        columns = {}
        for j, link in enumerate(LINKS):
            columns[f"{link[0]}.position"] = np.array(angles)[:, j] + NOISE * rng.standard_normal(len(time))
            columns[f"{link[0]}.effort"] = np.array(torques)[:, j]
        found.append(recording(f"run{k}", time, columns))
    return found


def test_an_arm_within_its_tolerance_is_consistent_though_it_would_fall_over() -> None:
    found = diagnose(held_up(0.0, 21), model=arm(), only=RIVALS)
    assert found.verdict == "consistent"
    assert max(row["nominal"]["heldout_rmse"] / row["noise_floor"] for row in found.fit) > 3.0  # as stated it is off


def test_damping_of_an_arm_that_would_fall_over_is_found() -> None:
    found = diagnose(held_up(DAMPING, 22), model=arm(), only=RIVALS)
    assert found.verdict == "explained"
    (told,) = found.findings
    assert (told["effect"], told["site"]) == ("viscous_damping", "shoulder")
    low, high = told["parameters"]["coefficient"]["ci95"]
    # An interval of 95 % is four standard deviations wide; within three of them the truth is but once in four hundred not.
    assert low - 0.25 * (high - low) < DAMPING < high + 0.25 * (high - low)
