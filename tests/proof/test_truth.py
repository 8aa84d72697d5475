"""The concealing engine against closed forms and against MuJoCo's own integrator."""

from dataclasses import replace
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from scipy.special import ellipk

from harness.proof.concealments import CONCEALMENTS, HINGES, filtered
from harness.proof.rigs import Rig, Segment
from harness.proof.scene import Run, Scene, Sensor
from harness.proof.truth import DryFriction, Hidden, NoSolutionError, Truth, mechanism_xml

LENGTH, MASS = 0.5, 0.8


def rod(**changes: float) -> Rig:
    """A uniform rod on a frictionless pivot."""
    data = {
        "length": LENGTH, "mass": MASS, "com": LENGTH / 2, "inertia": MASS * LENGTH**2 / 12, "damping": 0.0, "armature": 0.0,
    }  # fmt: skip
    return Rig((Segment("pivot", "rod", **(data | changes)),), (0.0, 1.0, 0.0), tolerance=0.01)


def small_rate() -> float:
    return float(np.sqrt(1.5 * 9.81 / LENGTH))


@pytest.mark.parametrize("degrees", [30, 90, 150])
def test_period_is_the_elliptic_integral(degrees: float) -> None:
    # Physical pendulum: T/T0 = (2/π) K(sin²(θ0/2)).
    start = np.radians(degrees)
    period = 2 * np.pi / small_rate() * 2 / np.pi * ellipk(np.sin(start / 2) ** 2)
    q, v = Truth(mechanism_xml(rod()), Hidden()).release(
        np.array([start]), np.zeros(1), np.array([0.0, period, 3 * period])
    )
    assert q[1:, 0] == pytest.approx(start, abs=1e-7)
    assert np.abs(v[1:]).max() < 1e-5


def test_dry_friction_takes_the_same_energy_from_every_half_swing_and_then_holds() -> None:
    # Energy theorem: between two rests, m g c (cos q1 - cos q2) is the work of the friction, torque · |q2 - q1|.
    torque = 0.03
    hidden = Hidden(dry=[DryFriction(0, lambda v, n, q: torque, lambda n, q: torque)])
    time = np.arange(0.0, 30.0, 1e-3)
    q, v = Truth(mechanism_xml(rod()), hidden).release(np.array([1.0]), np.zeros(1), time)
    turns = np.flatnonzero(np.diff(np.sign(v[:, 0])) != 0)
    moment = MASS * 9.81 * LENGTH / 2
    peaks = [1.0]
    for i in turns:
        if abs(v[i, 0]) < 0.02 and abs(q[i, 0] - peaks[-1]) > 0.01:
            peaks.append(float(q[i, 0]))
    assert len(peaks) > 8
    for a, b in pairwise(peaks):
        # The peak is read off a 1 ms grid, where cos q is known to about (1 ms · acceleration)² · tan q.
        assert moment * (np.cos(b) - np.cos(a)) == pytest.approx(torque * abs(b - a), abs=2e-5)
    # It rests where gravity is within the friction, and stays exactly there.
    assert abs(moment * np.sin(q[-1, 0])) <= torque
    assert np.ptp(q[-3000:, 0]) == 0.0


def test_drag_polynomial_agrees_with_mujocos_own() -> None:
    linear, square = 0.002, 0.004
    xml = mechanism_xml(rod())
    planted = Truth(xml, Hidden(torques=[lambda t, q, v: -linear * v, lambda t, q, v: -square * v * np.abs(v)]))
    time = np.arange(0.0, 5.0, 0.01)
    q, _ = planted.release(np.array([2.0]), np.zeros(1), time)
    model = mujoco.MjModel.from_xml_string(
        xml.replace('damping="0.0"', f'damping="{linear} {square}"').replace(
            "<option ", '<option integrator="RK4" timestep="0.0005" '
        )
    )
    data = mujoco.MjData(model)
    data.qpos[0] = 2.0
    path = []
    for k in range(len(time)):
        while data.time < time[k] - 1e-9:
            mujoco.mj_step(model, data)
        path.append(data.qpos[0])
    assert q[:, 0] == pytest.approx(np.array(path), abs=1e-7)


def test_load_dependent_friction_holds_against_the_weight() -> None:
    # At rest the bearing carries m g: friction torque up to mu_radius · m g holds the rod at asin(mu_radius / c).
    mu_radius = 0.05
    hidden = Hidden(dry=[DryFriction(0, lambda v, n, q: mu_radius * n, lambda n, q: mu_radius * n, loaded=True)])
    truth = Truth(mechanism_xml(rod()), hidden)
    limit = float(np.arcsin(mu_radius / (LENGTH / 2)))
    held, _ = truth.release(np.array([limit * 0.98]), np.zeros(1), np.linspace(0, 2, 21))
    slipped, _ = truth.release(np.array([limit * 1.05]), np.zeros(1), np.linspace(0, 2, 21))
    assert np.ptp(held) == 0.0
    assert np.ptp(slipped) > 1e-3


def test_a_concealed_link_bends_like_a_beam() -> None:
    """A rod that is clamped and held level sinks by m g l³ / (8 EI) (Gere and Goodno, table G-1).

    EI from its first frequency on a free hinge, ω = 3.926602² sqrt(EI / (m l³)) (Blevins 1979, table 8-1).
    """
    frequency = 12.0
    scene = Scene(rod(), (Run((0.0,), (0.0,), 1.0),), Sensor(500.0, 1e-3))
    CONCEALMENTS["link_flexibility"].plant(scene, 0, {"frequency": frequency, "damping_ratio": 0.01})
    truth = scene.truth()
    model, data = truth.model, truth.data
    clamped = [d for name, d in truth.dof.items() if name != "pivot"]
    # Level: the gravity of a hanging rod turned across it. Small angles, so that the springs stay linear.
    model.opt.gravity[:] = [1e-3 * 9.81, 0.0, 0.0]
    data.qpos[:], data.qvel[:] = 0.0, 0.0
    mujoco.mj_forward(model, data)
    stiffness = np.diag(model.jnt_stiffness)[np.ix_(clamped, clamped)]
    angles = np.linalg.solve(stiffness, -data.qfrc_bias[clamped])
    data.qpos[clamped] = angles
    mujoco.mj_forward(model, data)
    tip = data.xpos[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "rod_3")] + data.xmat[
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "rod_3")
    ].reshape(3, 3) @ [0.0, 0.0, -(1.0 - HINGES[-1]) * LENGTH]
    rigidity = (2 * np.pi * frequency) ** 2 * MASS * LENGTH**3 / 3.926602312**4
    # Three hinges stand for the beam: its frequency within half a hundredth, so its rigidity within one.
    assert abs(tip[0]) == pytest.approx(1e-3 * MASS * 9.81 * LENGTH**3 / (8 * rigidity), rel=0.015)
    assert data.subtree_com[0][2] == pytest.approx(-LENGTH / 2, rel=1e-5)
    assert sum(model.body_mass) == pytest.approx(MASS, rel=1e-6)


@pytest.mark.parametrize("cutoff", [0.5, 165.0, 8e4])
def test_filters_answer_a_ramp_as_theory_has_it(cutoff: float) -> None:
    # y' = ω (x − y), x = 1 + t from rest at x(0), or at zero for what is high-passed.
    time = np.linspace(0.0, 3.0, 700)
    rate = 2.0 * np.pi * cutoff
    low = filtered(lambda t: 1.0 + t, cutoff, high=False)(time)
    high = filtered(lambda t: t, cutoff, high=True)(time)
    lag = -np.expm1(-rate * time) / rate
    # Between the points of a grid of 1 ms the answer is a straight line.
    bound = 1e-6 + min(rate, 1e3) * 1e-3**2 / 4.0
    assert np.abs(low - (1.0 + time - lag)).max() < bound
    assert np.abs(high - lag).max() < bound


def test_springs_alone_move_as_with_error_control() -> None:
    # A driven rod that bends at three hinges: MuJoCo's Runge-Kutta against SciPy's, which an effect of no size calls for.
    rig = rod(armature=1e-3)
    drive = ((0.3, 0.9, 0.4), (0.1, 2.3, -1.0))
    runs = (Run((0.8,), (0.0,), 3.0, drive),)

    def scene() -> Scene:
        found = Scene(rig, runs, Sensor(250.0, 1e-3))
        CONCEALMENTS["link_flexibility"].plant(found, 0, {"frequency": 12.0, "damping_ratio": 0.01})
        return found

    controlled = scene()
    controlled.torques.append(lambda t, q, v: np.zeros(len(v)))
    one, other = (s.record(0)["pivot.position"] for s in (scene(), controlled))
    still = Scene(rig, runs, Sensor(250.0, 1e-3)).record(0)["pivot.position"]
    assert np.abs(one - still).max() > 1e-3
    assert np.abs(one - other).max() < 1e-7


def pushed(gravity: float, delay: float) -> Scene:
    """A rod in 25 Hz commands that act ``delay`` late."""
    drive = ((0.3, 0.9, 0.4), (0.1, 2.3, -1.0))
    scene = Scene(replace(rod(), gravity=gravity), (Run((0.0,), (0.0,), 2.0, drive, held=0.04),), Sensor(25.0, 1e-3))
    if delay:
        CONCEALMENTS["actuator_delay"].plant(scene, 0, {"delay": delay})
    return scene


@pytest.mark.parametrize("delay", [0.0, 0.0133, 0.04])
def test_held_commands_act_as_written_down_until_the_next_one(delay: float) -> None:
    # Without gravity a rod is a double integrator: between changes of the torque its angle is a parabola.
    scene = pushed(0.0, delay)
    found = scene.record(0)
    edges = np.concatenate([[0.0], found["time"] + delay])
    torques = np.concatenate([[0.0], found["pivot.effort"]])
    s = scene.rig.segments[0]
    inertia = s.inertia + s.mass * s.com**2 + s.armature
    wanted = np.zeros(len(found["time"]))
    for begin, end, torque in zip(edges, np.append(edges[1:], np.inf), torques, strict=True):
        # What a torque between two instants does to the angle at a later one.
        since, until = np.clip(found["time"] - begin, 0.0, None), np.clip(found["time"] - end, 0.0, None)
        wanted += torque * (since**2 - until**2) / (2.0 * inertia)
    assert np.ptp(wanted) > 1.0
    assert np.abs(found["pivot.position"] - wanted).max() < 1e-8 * np.ptp(wanted)


def test_held_commands_release_what_sticks() -> None:
    # At rest until a command exceeds what holds it; the changes are the only moments at which that happens here.
    scene = pushed(0.0, 0.0)
    limit = 0.2
    scene.dry.append(DryFriction(0, lambda speed, load, q: limit, lambda load, q: limit))
    found = scene.record(0)
    first = int(np.argmax(np.abs(found["pivot.effort"]) > limit))
    assert 0 < first < len(found["time"]) - 1
    assert np.abs(found["pivot.position"][: first + 1]).max() < 1e-15
    s = scene.rig.segments[0]
    inertia = s.inertia + s.mass * s.com**2 + s.armature
    torque = found["pivot.effort"][first]
    wanted = (torque - np.sign(torque) * limit) * 0.04**2 / (2.0 * inertia)
    assert found["pivot.position"][first + 1] == pytest.approx(wanted, rel=1e-6)


def test_springs_alone_follow_held_commands_too() -> None:
    def scene() -> Scene:
        found = pushed(9.81, 0.0133)
        CONCEALMENTS["link_flexibility"].plant(found, 0, {"frequency": 12.0, "damping_ratio": 0.01})
        return found

    controlled = scene()
    controlled.torques.append(lambda t, q, v: np.zeros(len(v)))
    one, other = (s.record(0)["pivot.position"] for s in (scene(), controlled))
    assert np.ptp(other) > 0.01
    # A command changes within a step of 0.1 ms, of which a sixteenth is told apart.
    assert np.abs(one - other).max() < 1e-4 * np.ptp(other)


def test_a_rod_that_bends_is_not_made_of_pieces_of_negative_mass() -> None:
    # All mass at four fifths of a rod without a bob to balance it; MuJoCo would refuse the pieces as an error of its own.
    splits = {0: [(at, f'<joint name="b{at}" type="hinge" axis="0 1 0" stiffness="1"/>') for at in HINGES]}
    Truth(mechanism_xml(rod(), splits=splits), Hidden())
    with pytest.raises(NoSolutionError, match="rod"):
        mechanism_xml(rod(com=0.83 * LENGTH, inertia=0.3 * MASS * LENGTH**2 / 12), splits=splits)
