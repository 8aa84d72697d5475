"""What sensors on a mechanism read, held against closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness import effects
from harness.errors import InputError
from harness.recording.sensors import measure, observe
from harness.system import Attachment, Beam, Joint, JointType, Link, System, Trajectory
from harness.system.description import constant

LENGTH = 0.3


def rod(name, joint, parent, at=(0.0, 0.0, 0.0)):
    inertia = np.diag([0.2 * LENGTH**2 / 12.0] * 2 + [0.0])
    return (
        Joint(joint, JointType.REVOLUTE, parent, name, xyz=constant(at), axis=constant([0.0, 1.0, 0.0])),
        Link(name, 0.2, constant([0.0, 0.0, -LENGTH / 2.0]), constant(inertia)),
    )


@pytest.fixture
def pendulum():
    joint, link = rod("rod", "pivot", "base")
    return System("pendulum", (joint,), (link,))


@pytest.fixture
def double():
    (first, upper), (second, lower) = rod("rod", "pivot", "base"), rod("forearm", "elbow", "rod", (0, 0, -LENGTH))
    return System("double", (first, second), (upper, lower))


def states(*histories):
    """(B, T, n) arrays of one lane from (position, velocity, acceleration) of each coordinate."""
    return tuple(np.stack([h[k] for h in histories], axis=-1)[None] for k in range(3))


def wave(time, amplitude, rate, phase=0.0):
    s, c = np.sin(rate * time + phase), np.cos(rate * time + phase)
    return amplitude * s, amplitude * rate * c, -amplitude * rate**2 * s


def seen(system, site, quantity, moved, gravity=None):
    model = SimpleNamespace(system=system, names=system.coordinate_names, slot=lambda site, name: "xyz".index(name[-1]))
    rows = (system.gravity if gravity is None else gravity)[None]
    return observe(model, rows, site, quantity, moved)[0]


TIME = np.linspace(0.0, 2.0, 400)


def test_joint_channels(double):
    one, two = wave(TIME, 0.5, 3.0), wave(TIME, 0.2, 7.0)
    assert np.array_equal(seen(double, "elbow", "position", states(one, two)), two[0])
    assert np.array_equal(seen(double, "pivot", "velocity", states(one, two)), one[1])


def test_tip_acceleration_of_a_swinging_rod(pendulum):
    # Across the rod: l q̈ + g sin q.
    q, qd, qdd = wave(TIME, 0.9, 4.0)
    read = seen(pendulum, "rod", "tip_acceleration", states((q, qd, qdd)))
    assert np.allclose(read, LENGTH * qdd + 9.81 * np.sin(q), rtol=0, atol=1e-10)


def test_a_free_falling_pendulum_feels_a_third_less(pendulum):
    # A uniform rod swings with q̈ = −(3 g/2 l) sin q, so the accelerometer at its end reads −(g/2) sin q.
    q = 0.7 * np.cos(3 * TIME)
    read = seen(pendulum, "rod", "tip_acceleration", states((q, 0 * q, -1.5 * 9.81 / LENGTH * np.sin(q))))
    assert np.allclose(read, -0.5 * 9.81 * np.sin(q), rtol=0, atol=1e-10)


def test_tip_acceleration_of_the_second_link(double):
    # Along a2 = direction in which positive q1 + q2 moves the tip; elbow accelerates by l(q̈1 along, −q̇1² back).
    one, two = wave(TIME, 0.6, 3.0), wave(TIME, 0.4, 5.0, 0.3)
    read = seen(double, "forearm", "tip_acceleration", states(one, two))
    a, b = one[0], one[0] + two[0]
    expected = (
        LENGTH * (one[1] ** 2 * np.sin(b - a) + one[2] * np.cos(b - a)) + LENGTH * (one[2] + two[2]) + 9.81 * np.sin(b)
    )
    assert np.allclose(read, expected, rtol=0, atol=1e-10)


def test_tip_acceleration_on_a_sliding_base(pendulum):
    system = effects.apply(
        pendulum, Attachment("base_compliance", "base", {"stiffness": 1e3, "mass": 1.0, "damping": 1.0})
    )
    x, q = wave(TIME, 0.05, 6.0), wave(TIME, 0.5, 4.0)
    # x runs where a positive q moves the hanging tip.
    read = seen(system, "rod", "tip_acceleration", states(x, q))
    assert np.allclose(read, LENGTH * q[2] + x[2] * np.cos(q[0]) + 9.81 * np.sin(q[0]), rtol=0, atol=1e-10)


@pytest.fixture
def cantilever(pendulum):
    """A beam whose one mode is the static shape under a tip load: s = x²(3l − x)/2l³, s″(0) = 3/l², s′(l) = 3/2l."""
    x = np.linspace(0.0, 1.0, 401)
    beam = Beam(
        length=LENGTH,
        direction=constant([0.0, 0.0, -1.0]),
        bending=constant([-1.0, 0.0, 0.0]),
        mass=0.2,
        bending_stiffness=0.4,
        half_depth=5e-4,
        shapes="samples",
        shape_samples=constant(np.stack([x, x**2 * (3.0 - x) / 2.0], axis=1)),
        geometric_stiffening=False,
    )
    return pendulum.replace_link(replace(pendulum.link("rod"), beam=beam))


def test_deflection_and_strain_under_a_tip_load(cantilever):
    still, bent = (0 * TIME,) * 3, (1e-3 * np.ones_like(TIME), 0 * TIME, 0 * TIME)
    assert np.allclose(seen(cantilever, "rod", "tip_deflection", states(still, bent)), 1e-3, rtol=1e-6)
    # ε = h w″(0) = 3 h w/l²
    expected = 3 * 5e-4 * 1e-3 / LENGTH**2
    assert np.allclose(seen(cantilever, "rod", "root_strain", states(still, bent)), expected, rtol=2e-3)


def test_tip_acceleration_of_a_vibrating_beam_held_still(cantilever):
    still, ringing = (0 * TIME,) * 3, wave(TIME, 1e-3, 200.0)
    read = seen(cantilever, "rod", "tip_acceleration", states(still, ringing))
    # ü and gravity along the section, which turns by φ = s′(l) b, s′(l) = 3/2l.
    turned = 1.5 / LENGTH * ringing[0]
    expected = ringing[2] * np.cos(turned) + 9.81 * np.sin(turned)
    # The shape is given by 401 samples of a cubic; its slope at the end comes from a spline through them.
    assert np.abs(read - expected).max() < 1e-6 * np.abs(expected).max()


def test_strain_without_a_depth_is_refused(cantilever):
    link = cantilever.link("rod")
    system = cantilever.replace_link(replace(link, beam=replace(link.beam, half_depth=float("nan"))))
    still = (0 * TIME,) * 3
    with pytest.raises(InputError, match="how deep"):
        seen(system, "rod", "root_strain", states(still, still))


def test_unknown_channels_are_refused(pendulum):
    still = states((0 * TIME,) * 3)
    with pytest.raises(InputError, match="did you mean 'pivot'"):
        seen(pendulum, "pivott", "position", still)
    with pytest.raises(InputError, match="did you mean 'rod'"):
        seen(pendulum, "rodd", "tip_acceleration", still)
    with pytest.raises(InputError, match="did you mean 'position'"):
        seen(pendulum, "pivot", "positon", still)


def test_a_trajectory_is_measured(pendulum):
    time = np.linspace(0.0, 1.0, 4001)
    q, qd, qdd = wave(time, 0.9, 4.0)
    trajectory = Trajectory(time, ("pivot",), q[:, None], qd[:, None], {"rod.root_strain": 7.0 * time})
    found = measure(trajectory, pendulum, ("pivot.position", "rod.tip_acceleration", "rod.root_strain"))
    assert np.array_equal(found["pivot.position"], q)
    assert np.array_equal(found["rod.root_strain"], 7.0 * time)
    # Differences of the velocity: error (ω h)²/6 of the largest acceleration inside, somewhat more at the ends.
    assert np.allclose(found["rod.tip_acceleration"], LENGTH * qdd + 9.81 * np.sin(q), rtol=0, atol=1e-5)
