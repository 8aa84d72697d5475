"""Motion in time against exact solutions: pendulum, dry friction that sticks, stiff beams, events."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from harness.denoc import Denoc
from harness.errors import InputError, UnsupportedError
from harness.system import Attachment, Beam, Joint, JointType, Link, System, random_chain
from harness.system.flexible_link import flexible_link

GRAVITY = 9.81


def pendulum(**joint: float) -> System:
    """A point mass of 1 kg on a massless rod of 1 m, at rest hanging down."""
    hinge = Joint("pivot", JointType.REVOLUTE, "base", "bob", axis=np.array([0.0, 1.0, 0.0]), **joint)
    return System("pendulum", (hinge,), (Link("bob", 1.0, np.array([0.0, 0.0, -1.0])),))


def slider(count: int = 1, **joint: float) -> System:
    """Masses of 1 kg one on another on parallel slides, without gravity."""
    joints = tuple(
        Joint(
            f"slide{k}", JointType.PRISMATIC, f"block{k - 1}" if k else "base", f"block{k}", axis=np.eye(3)[0], **joint
        )
        for k in range(count)
    )
    return System("slider", joints, tuple(Link(f"block{k}", 1.0) for k in range(count)), gravity=np.zeros(3))


def exact_pendulum(amplitude: float, time: np.ndarray) -> np.ndarray:
    """Released from rest: sin(θ/2) = k sn(ω t + K, k), k = sin(amplitude / 2) (Whittaker, Analytical Dynamics, § 44)."""
    k = np.sin(amplitude / 2)
    sn = ellipj(np.sqrt(GRAVITY) * time + ellipk(k * k), k * k)[0]
    return 2 * np.arcsin(k * sn)


@pytest.mark.parametrize(("method", "allowed"), [("dop853", 1e-8), ("gauss", 1e-12), ("rk4", 1e-9)])
def test_large_swing_is_the_elliptic_function(method: str, allowed: float) -> None:
    # Uneven samples, so that dense output has its part.
    time = np.concatenate([[0.0], np.sort(np.random.default_rng(0).uniform(0.0, 10.0, 200)), [10.0]])
    motion = Denoc(pendulum()).simulate([2.0], [0.0], time, method=method)
    assert np.abs(motion.position[:, 0] - exact_pendulum(2.0, time)).max() < allowed
    assert method == "dop853" or "fixed step" in motion.method


@pytest.mark.parametrize(("method", "order", "step"), [("rk4", 4, 0.02), ("gauss", 6, 0.2)])
def test_fixed_steps_have_their_order(method: str, order: int, step: float) -> None:
    model = Denoc(pendulum())
    time = np.array([0.0, 2.0])
    errors = [
        abs(model.simulate([1.5], [0.0], time, method=method, step=h).position[1, 0] - exact_pendulum(1.5, time)[1])
        for h in (step, step / 2)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


def test_tolerance_rules_the_adaptive_method() -> None:
    model = Denoc(pendulum())
    time = np.linspace(0.0, 10.0, 50)
    exact = exact_pendulum(2.0, time)
    loose, tight = (
        np.abs(model.simulate([2.0], [0.0], time, rtol=r, atol=r).position[:, 0] - exact).max() for r in (1e-6, 1e-12)
    )
    assert 1e-9 < loose < 1e-3
    assert tight < 1e-10


def test_block_slides_to_a_stop_and_stays() -> None:
    """Constant deceleration F/m: stop after v²/2a, and no creep whatever the time."""
    model = Denoc(slider(friction=0.3))
    motion = model.simulate([0.0], [1.0], np.linspace(0.0, 1000.0, 11))
    assert motion.position[-1, 0] == pytest.approx(1.0 / (2 * 0.3), rel=1e-12)
    assert np.abs(motion.velocity[1:]).max() < 1e-20
    assert np.ptp(motion.position[1:]) < 1e-20


def test_spring_with_dry_friction_loses_the_same_every_half_swing() -> None:
    """Each half cycle is a cosine about ±F/k: amplitude falls by 2F/k, until the block rests within F/k (Den Hartog)."""
    stiffness, friction, start = 50.0, 2.0, 1.0
    model = Denoc(slider(friction=friction, stiffness=stiffness))
    half = np.pi / np.sqrt(stiffness)
    time = np.arange(0.0, 30.0) * half
    motion = model.simulate([start], [0.0], time)
    amplitude, sign, expected = start, 1.0, [start]
    for _ in time[1:]:
        if stiffness * amplitude > friction:
            amplitude, sign = amplitude - 2 * friction / stiffness, -sign
        expected.append(sign * amplitude)
    assert np.abs(motion.position[:, 0] - expected).max() < 1e-9
    assert abs(motion.position[-1, 0]) <= friction / stiffness


def test_driven_block_breaks_loose_when_the_force_exceeds_the_limit() -> None:
    """Force a t against friction F: at rest until t = F/a, then x = a (t - F/a)³ / 6m."""
    model = Denoc(slider(friction=1.0))
    time = np.linspace(0.0, 4.0, 81)
    motion = model.simulate([0.0], [0.0], time, tau=(0.5 * time)[:, None], hold="linear")
    expected = 0.5 * np.maximum(time - 2.0, 0.0) ** 3 / 6
    assert np.abs(motion.position[:, 0] - expected).max() < 1e-8
    assert np.array_equal(motion.position[time < 1.99, 0], np.zeros((time < 1.99).sum()))


def test_two_blocks_stick_to_each_other_and_slide_together() -> None:
    """Lower block pushed with P < what tears them apart: both move with (P - F1)/2m; the joint between them holds."""
    system = slider(2)
    lower, upper = system.joints
    system = replace(system, joints=(replace(lower, friction=1.0), replace(upper, friction=0.9)))
    model = Denoc(system)
    # The upper block needs m a = 0.75 from the joint between, which holds up to 0.9.
    motion = model.simulate([0.0, 0.0], [0.0, 0.0], [0.0, 2.0], tau=[2.5, 0.0])
    assert motion.position[-1] == pytest.approx([0.75 * 2.0, 0.0], abs=1e-12)
    # Pushed harder the upper one is dragged along by 0.9 only: a1 = P - F1 - 0.9 = 2.1, a2 (absolute) = 0.9.
    motion = model.simulate([0.0, 0.0], [0.0, 0.0], [0.0, 2.0], tau=[4.0, 0.0])
    assert motion.position[-1] == pytest.approx([2.1 * 2.0, (0.9 - 2.1) * 2.0], rel=1e-12)


def test_pendulum_rests_off_its_lowest_point() -> None:
    """Energy lost is friction times path; at rest gravity's torque is within the limit."""
    friction = 1.0
    motion = Denoc(pendulum(friction=friction)).simulate([2.0], [0.0], np.linspace(0.0, 20.0, 2001))
    at = motion.position[-1, 0]
    assert np.all(motion.position[-500:, 0] == at)
    assert abs(GRAVITY * np.sin(at)) < friction
    assert abs(at) > 1e-3
    assert motion.energy is not None
    path = np.abs(np.diff(motion.position[:, 0])).sum()
    # The path between samples is longer than the sum by the turning points: one sample each, 1e-4 of it.
    assert motion.energy[0] - motion.energy[-1] == pytest.approx(friction * path, rel=1e-3)
    assert "friction" in motion.method


def test_several_joints_with_friction_only_ever_lose_energy() -> None:
    chain = random_chain(4, 5, prismatic=0.0)
    model = Denoc(replace(chain, joints=tuple(replace(joint, friction=0.4) for joint in chain.joints)))
    motion = model.simulate([1.0, 0.5, 0.3, -0.4], np.zeros(4), np.linspace(0.0, 100.0, 1000))
    assert motion.energy is not None
    assert np.diff(motion.energy).max() < 1e-10
    assert np.abs(motion.velocity[-1]).max() < 1e-15
    # What holds it is within the limits.
    held = model.inverse_dynamics(motion.position[-1], np.zeros(4), np.zeros(4))
    assert np.abs(held).max() <= 0.4 * (1 + 1e-8)
    # Simulating leaves the model as it was.
    q, qd, tau = np.random.default_rng(1).normal(size=(3, 4))
    assert np.array_equal(model.forward_dynamics(q, qd, tau), Denoc(model.system).forward_dynamics(q, qd, tau))


def flexible_pendulum(modes: int) -> System:
    beam = Beam(
        length=0.3,
        direction=np.array([0.0, 0.0, -1.0]),
        bending=np.array([1.0, 0.0, 0.0]),
        mass=7850.0 * 0.3 * 0.025 * 0.001,
        bending_stiffness=2.0e11 * 0.025 * 0.001**3 / 12,
        modes=modes,
    )
    hinge = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=np.array([0.0, 1.0, 0.0]), armature=2e-5)
    return System("flexible", (hinge,), (flexible_link("rod", beam),))


@pytest.mark.slow
def test_five_modes_at_one_millisecond_keep_their_energy_for_a_minute() -> None:
    model = Denoc(flexible_pendulum(5))
    motion = model.simulate([np.pi / 2, *np.zeros(5)], np.zeros(6), np.linspace(0.0, 60.0, 601), method="gauss")
    assert motion.energy is not None
    swing = 7850.0 * 0.3 * 0.025 * 0.001 * GRAVITY * 0.15
    assert np.abs(motion.energy - motion.energy[0]).max() < 1e-6 * swing


def test_stiff_and_adaptive_integration_agree() -> None:
    model = Denoc(flexible_pendulum(2))
    time = np.linspace(0.0, 0.5, 51)
    start = np.array([np.pi / 2, 0.0, 0.0])
    adaptive = model.simulate(start, np.zeros(3), time, method="dop853")
    stiff = model.simulate(start, np.zeros(3), time, method="gauss", step=2.5e-4)
    assert np.abs(adaptive.position - stiff.position).max() < 1e-9
    tips = [motion.channels["rod.tip_deflection"] for motion in (adaptive, stiff)]
    assert np.abs(tips[0] - tips[1]).max() < 1e-6 * np.abs(tips[0]).max()


def test_tip_accelerometer_is_read_while_the_joint_sticks_and_slides() -> None:
    """Held by friction the hinge is a clamp: the tip reads what it does on a welded joint, until it breaks loose."""
    free = flexible_pendulum(1)
    shaped = replace(free, links=(replace(free.links[0], beam=replace(free.links[0].beam, shapes="clamped_free")),))
    start = np.array([1e-3, 1e-4])
    time = np.linspace(0.0, 0.5, 101)
    held = Denoc(shaped.replace_joint(replace(free.joints[0], friction=0.5))).simulate(start, np.zeros(2), time)
    assert not held.velocity[:, 0].any() or np.abs(held.velocity[:, 0]).max() < 1e-25
    turn = np.array([[np.cos(1e-3), 0.0, np.sin(1e-3)], [0.0, 1.0, 0.0], [-np.sin(1e-3), 0.0, np.cos(1e-3)]])
    weld = replace(free.joints[0], type=JointType.FIXED, rotation=turn)
    welded = Denoc(replace(shaped, joints=(weld,))).simulate(start[1:], np.zeros(1), time)
    ours, expected = (motion.channels["rod.tip_acceleration"] for motion in (held, welded))
    assert np.abs(ours - expected).max() < 1e-6 * np.abs(expected).max()
    # Sliding against a little friction, the tip's reading goes on, and jumps by no more than friction's torque makes.
    sliding = Denoc(shaped.replace_joint(replace(free.joints[0], friction=1e-3))).simulate(
        [1.0, 0.0], np.zeros(2), time
    )
    assert np.isfinite(sliding.channels["rod.tip_acceleration"]).all()
    assert np.ptp(sliding.position[:, 0]) > 0.5


def test_very_stiff_modes_choose_the_implicit_method() -> None:
    assert "Gauss" in Denoc(flexible_pendulum(12)).simulate([0.1, *np.zeros(12)], np.zeros(13), [0.0, 0.01]).method
    assert "adaptive" in Denoc(flexible_pendulum(1)).simulate([0.1, 0.0], np.zeros(2), [0.0, 0.01]).method


def test_held_and_joined_forces() -> None:
    """A free mass under 0, 1, 0 N at 0, 1, 2 s: held, x = ½ at rest in the first second; joined, x(2) = ½·... by integration."""
    model = Denoc(slider())
    tau = np.array([[0.0], [1.0], [0.0]])
    for method in ("dop853", "rk4", "gauss"):
        held = model.simulate([0.0], [0.0], [0.0, 1.0, 2.0], tau=tau, method=method)
        assert held.position[:, 0] == pytest.approx([0.0, 0.0, 0.5], abs=1e-12)
        # Force t, then 2 - t: x(1) = 1/6, v(1) = 1/2; x(2) = 1/6 + 1/2 + 1/2 - 1/6 = 1.
        joined = model.simulate([0.0], [0.0], [0.0, 1.0, 2.0], tau=tau, method=method, hold="linear")
        assert joined.position[:, 0] == pytest.approx([0.0, 1 / 6, 1.0], abs=1e-12)


def test_events_are_located_and_can_end_the_run() -> None:
    def lowest(t: float, q: np.ndarray, qd: np.ndarray) -> float:
        return float(q[0])

    k = np.sin(0.5)
    quarter = ellipk(k * k) / np.sqrt(GRAVITY)
    model = Denoc(pendulum())
    motion = model.simulate([1.0], [0.0], np.linspace(0.0, 3.0, 31), events=[lowest])
    assert motion.events["lowest"][:2] == pytest.approx([quarter, 3 * quarter], rel=1e-9)
    lowest.terminal = True
    ended = model.simulate([1.0], [0.0], np.linspace(0.0, 3.0, 31), events=[lowest])
    assert ended.time[-1] <= quarter
    assert len(ended.time) == len(ended.position)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time": [0.0, 1.0, 1.0]}, "does not increase at sample 2"),
        ({"time": [0.0, np.nan]}, "time is not a vector"),
        ({"q0": [0.0, 0.0]}, "q0 has shape"),
        ({"qd0": [np.nan]}, r"qd0\[0\] \(pivot\) is nan"),
        ({"tau": np.zeros((3, 1))}, "tau has shape"),
        ({"method": "euler"}, "method 'euler' is unknown"),
        ({"hold": "cubic"}, "hold 'cubic' is unknown"),
        ({"step": 0.0, "method": "rk4"}, "step 0.0 is not positive"),
        ({"rtol": -1.0}, "must be positive"),
    ],
)
def test_unusable_runs_are_refused_in_one_line(changes: dict, message: str) -> None:
    arguments = {"q0": [0.1], "qd0": [0.0], "time": [0.0, 1.0]} | changes
    with pytest.raises(InputError, match=message):
        Denoc(pendulum()).simulate(**arguments)


def test_friction_needs_a_method_that_locates_it_and_attachments_another_way() -> None:
    with pytest.raises(InputError, match="does not locate"):
        Denoc(pendulum(friction=0.1)).simulate([1.0], [0.0], [0.0, 1.0], method="rk4")
    attached = replace(pendulum(), attachments=(Attachment("cogging_torque", "pivot"),))
    with pytest.raises(UnsupportedError, match="cogging_torque"):
        Denoc(attached).simulate([1.0], [0.0], [0.0, 1.0])
