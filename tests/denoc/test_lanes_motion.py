"""Lanes against closed forms, textbook equations integrated elsewhere, and MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from pinocchio_tree import pinocchio_tree
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from harness.denoc.lanes.model import LaneModel
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, JointType, Link, System, random_chain, random_tree
from harness.system.description import constant

G = 9.81
MASS, LENGTH = 0.18, 0.3
INERTIA = MASS * LENGTH**2 / 3.0


def pendulum() -> System:
    """A uniform rod that hangs from a pin along y."""
    flat = MASS * LENGTH**2 / 12.0
    rod = Link("rod", mass=MASS, com=constant([0, 0, -LENGTH / 2]), inertia=constant(np.diag([flat, flat, 0.0])))
    return System("pendulum", (Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0, 1, 0])),), (rod,))


def oscillator(inertia: float = 0.02, stiffness: float = 0.5) -> System:
    """A wheel about the vertical on a spring: linear, without gravity."""
    wheel = Link("wheel", mass=1.0, inertia=constant(np.diag([0.01, 0.01, inertia])))
    return System("oscillator", (Joint("hub", JointType.REVOLUTE, "base", "wheel", stiffness=stiffness),), (wheel,))


def rows_with(model: LaneModel, copies: int = 1, **parameters: object) -> np.ndarray:
    """Rows of the model's own system with some joint parameters set (first joint unless ``joint__name``)."""
    rows = np.tile(model.row(), (copies, 1))
    for name, value in parameters.items():
        joint, _, slot = name.rpartition("__")
        rows[:, model.slot(joint or model.names[0], slot)] = value
    return rows


def piecewise(right_hand_sides, gates, switch, y, time, mode):
    """Reference solution of a motion that changes its kind: one smooth piece after another, events located.

    right_hand_sides(mode) -> f(t, y); gates(mode) -> event functions; switch(mode, which, t, y) -> (mode, y).
    """
    out = np.full((len(time), len(y)), np.nan)
    t = time[0]
    for _ in range(400):
        events = gates(mode)
        for event in events:
            event.terminal = True
        piece = solve_ivp(
            right_hand_sides(mode), (t, time[-1]), y, "DOP853", rtol=1e-11, atol=1e-12, events=events,
            dense_output=True, max_step=0.02,
        )  # fmt: skip
        inside = (time >= t) & (time <= piece.t[-1])
        if inside.any():
            out[inside] = piece.sol(time[inside]).T
        t, y = piece.t[-1], piece.y[:, -1]
        if piece.status != 1:
            return out
        which = next(k for k, found in enumerate(piece.t_events) if len(found))
        mode, y = switch(mode, which, t, y)
    raise AssertionError("too many pieces")


def rising(function):
    function.direction = 1
    return function


def falling(function):
    function.direction = -1
    return function


def test_large_swing_is_the_elliptic_function():
    # sin(θ/2) = k sn(K − ω t, k), k = sin(θ0/2): the exact pendulum.
    model = LaneModel(pendulum())
    time = np.arange(0.0, 16.0, 0.004)
    start = np.array([[0.1], [1.2], [2.0943951], [3.0]])
    position, velocity, acceleration = model.simulate(model.row(), start, [0.0], time)
    for lane, amplitude in enumerate(start[:, 0]):
        k = np.sin(amplitude / 2)
        omega = np.sqrt(1.5 * G / LENGTH)
        sn, cn, _, _ = ellipj(ellipk(k * k) - omega * time, k * k)
        assert np.abs(position[lane, :, 0] - 2 * np.arcsin(k * sn)).max() < 1e-7
        assert np.abs(velocity[lane, :, 0] + 2 * k * omega * cn).max() < 1e-6
        exact = -(omega**2) * np.sin(position[lane, :, 0])
        assert np.abs(acceleration[lane, :, 0] - exact).max() < 1e-4


def test_a_finer_tolerance_reaches_nanoradians():
    model = LaneModel(pendulum())
    time = np.arange(0.0, 16.0, 0.004)
    k = np.sin(2.0 / 2)
    sn = ellipj(ellipk(k * k) - np.sqrt(1.5 * G / LENGTH) * time, k * k)[0]
    position = model.simulate(model.row(), [2.0], [0.0], time, tolerance=1e-12)[0]
    assert np.abs(position[0, :, 0] - 2 * np.arcsin(k * sn)).max() < 1e-9


def test_viscous_damping_of_the_linear_oscillator():
    # x = e^(−ζω t) (cos ω_d t + ζ/√(1−ζ²) sin ω_d t)
    model = LaneModel(oscillator())
    time = np.linspace(0.0, 16.0, 2001)
    zeta = 0.03
    damping = 2 * zeta * 5.0 * 0.02
    position = model.simulate(rows_with(model, damping=damping), [1.0], [0.0], time)[0][0, :, 0]
    rate = 5.0 * np.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * 5.0 * time) * (np.cos(rate * time) + zeta / np.sqrt(1 - zeta**2) * np.sin(rate * time))
    assert np.abs(position - exact).max() < 1e-8


def test_coulomb_friction_loses_the_same_amplitude_every_half_swing_and_sticks():
    # About the shifted rest ±F/k every half-swing is a cosine; 2 F / k of amplitude is lost in each; it stops inside F/k.
    model = LaneModel(oscillator())
    friction = np.array([0.013, 0.0065, 0.06, 0.0])
    time = np.linspace(0.0, 30.0, 3001)
    position, velocity, acceleration = model.simulate(rows_with(model, 4, coulomb_torque=friction), [1.0], [0.0], time)
    for lane, force in enumerate(friction):
        exact = np.empty_like(time)
        x, t = 1.0, 0.0
        shift = force / 0.5
        while t < 30.0:
            after = time >= t
            if abs(x) <= shift:
                exact[after] = x
                assert np.all(velocity[lane, after, 0] == 0.0)
                assert np.all(acceleration[lane, after, 0] == 0.0)
                assert np.ptp(position[lane, after, 0]) == 0.0
                break
            centre = np.sign(x) * shift
            exact[after] = centre + (x - centre) * np.cos(5.0 * (time[after] - t))
            x, t = 2 * centre - x, t + np.pi / 5.0
        assert np.abs(position[lane, :, 0] - exact).max() < 2e-8


def test_friction_holds_a_pendulum_on_the_slope_for_ever():
    model = LaneModel(pendulum())
    weight = MASS * G * LENGTH / 2 * np.sin(0.7)
    time = np.linspace(0.0, 1000.0, 101)
    rows = rows_with(model, 2, coulomb_torque=[weight * 1.000001, weight * 0.99])
    position = model.simulate(rows, [0.7], [0.0], time)[0][:, :, 0]
    assert np.all(position[0] == 0.7)
    assert np.abs(position[1] - 0.7).max() > 1e-3


def test_breaking_loose_under_a_growing_torque():
    # Held until r t = F; then I θ̈ = r t − F, so θ = r (t − F/r)³ / 6 I.
    model = LaneModel(oscillator(stiffness=0.0))
    time = np.linspace(0.0, 3.0, 301)
    rate, friction, inertia = 0.05, 0.0613, 0.02
    position = model.simulate(
        rows_with(model, coulomb_torque=friction), [0.2], [0.0], time, tau=(rate * time)[:, None]
    )[0][0, :, 0]
    later = np.maximum(time - friction / rate, 0.0)
    assert np.abs(position - 0.2 - rate * later**3 / (6 * inertia)).max() < 1e-9
    assert np.all(position[time < friction / rate] == 0.2)


def test_stribeck_viscous_and_drag_against_a_located_reference():
    model = LaneModel(pendulum())
    low, high, speed, viscous, drag = 0.006, 0.011, 0.3, 4e-4, 3e-4
    time = np.linspace(0.0, 16.0, 801)
    rows = rows_with(
        model, coulomb_torque=low, static_torque=high, stribeck_velocity=speed, damping=viscous, quadratic_drag=drag
    )
    ours = model.simulate(rows, [1.4], [0.0], time)[0][0, :, 0]

    def weight(q):
        return MASS * G * LENGTH / 2 * np.sin(q)

    def slide(sign):
        if sign == 0:
            return lambda t, y: [0.0, 0.0]

        def f(t, y):
            friction = low + (high - low) * np.exp(-((y[1] / speed) ** 2))
            return [y[1], (-weight(y[0]) - viscous * y[1] - sign * (friction + drag * y[1] ** 2)) / INERTIA]

        return f

    def switch(mode, which, t, y):
        held = abs(weight(y[0])) <= high
        return (0 if held else -np.sign(weight(y[0]))), np.array([y[0], 0.0])

    def gates(mode):
        return [falling(lambda t, y: mode * y[1])] if mode else []

    reference = piecewise(slide, gates, switch, np.array([1.4, 0.0]), time, -1.0)[:, 0]
    assert np.abs(ours - reference).max() < 1e-7


def test_load_dependent_friction_against_its_implicit_equation():
    # Reaction R = m |a_c − g| of the rod; the torque μr R and θ̈ are found together by bisection in the reference.
    model = LaneModel(pendulum())
    mu = 0.004
    time = np.linspace(0.0, 3.0, 151)
    ours = model.simulate(rows_with(model, mu_radius=mu), [2.0], [0.0], time)[0][0, :, 0]
    half = LENGTH / 2

    def acceleration(q, v, sign):
        def torque(qdd):
            radial = MASS * (half * v**2 + G * np.cos(q))
            tangential = MASS * (half * qdd + G * np.sin(q))
            return -MASS * G * half * np.sin(q) - sign * mu * np.hypot(radial, tangential)

        low, high = -500.0, 500.0
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if torque(middle) > INERTIA * middle else (low, middle)
        return (low + high) / 2

    reference = piecewise(
        lambda s: lambda t, y: [y[1], acceleration(y[0], y[1], s)],
        lambda s: [falling(lambda t, y: s * y[1])],
        lambda s, which, t, y: (-s, np.array([y[0], 0.0])),
        np.array([2.0, 0.0]),
        time,
        -1.0,
    )[:, 0]
    assert np.abs(ours - reference).max() < 1e-8


@pytest.mark.parametrize("kind", ["coulomb", "stribeck", "load-dependent"])
def test_friction_that_creeps_against_its_equation_beside_copies_that_stick(kind):
    model = LaneModel(pendulum())
    creep, half = 0.02, LENGTH / 2
    laws = {
        "coulomb": {"coulomb_torque": 0.02},
        "stribeck": {"coulomb_torque": 0.02, "static_torque": 0.03, "stribeck_velocity": 0.3},
        "load-dependent": {"mu_radius": 0.01},
    }
    rows = rows_with(model, 3, **laws[kind])
    rows[1, model.slot("pivot", "creep_velocity")] = creep
    time = np.linspace(0.0, 6.0, 301)
    stuck, ours, again = model.simulate(rows, np.full((3, 1), 0.6), np.zeros((3, 1)), time)[0][:, :, 0]

    def slope(t, y):
        q, v = y
        share, pull = np.tanh(v / creep), -MASS * G * half * np.sin(q)
        if kind != "load-dependent":
            size = 0.02 + (0.01 * np.exp(-((v / 0.3) ** 2)) if kind == "stribeck" else 0.0)
            return [v, (pull - size * share) / INERTIA]
        # R depends on the acceleration that the friction allows: to a fixed point.
        qdd = pull / INERTIA
        for _ in range(60):
            load = MASS * np.hypot(half * v**2 + G * np.cos(q), half * qdd + G * np.sin(q))
            qdd = (pull - 0.01 * load * share) / INERTIA
        return [v, qdd]

    reference = solve_ivp(slope, (0.0, 6.0), [0.6, 0.0], "DOP853", t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    assert np.abs(ours - reference).max() < 1e-7
    # The others rest, and are what they are without it.
    alone = model.simulate(rows[:1], np.full((1, 1), 0.6), np.zeros((1, 1)), time)[0][0, :, 0]
    np.testing.assert_array_equal(stuck, alone)
    np.testing.assert_array_equal(again, alone)
    assert abs(ours[-1] - ours[-20]) > 1e-5 > np.ptp(stuck[-20:])


def test_soft_friction_against_mujocos_constraint():
    # MuJoCo's frictionloss at its default settings: d = 0.9, dmax = 0.95, timeconst = 0.02 s.
    loss, step = 0.02, 2e-4
    flat = MASS * LENGTH**2 / 12.0
    xml = f"""<mujoco><option timestep="{step}" integrator="RK4"/><worldbody><body>
      <joint name="pivot" axis="0 1 0" frictionloss="{loss}"/>
      <inertial pos="0 0 {-LENGTH / 2}" mass="{MASS}" diaginertia="{flat} {flat} 1e-9"/></body></worldbody></mujoco>"""
    theirs = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(theirs)
    data.qpos[0] = 0.6
    time = np.arange(0.0, 6.0, 0.02)
    reference = []
    for _ in time:
        reference.append(data.qpos[0])
        mujoco.mj_step(theirs, data, nstep=round(0.02 / step))
    lead = 0.95 * 0.02 / 2.0
    held = 0.9 / (1.0 - 0.9) / theirs.dof_invweight0[0]
    model = LaneModel(pendulum())
    rows = rows_with(model, 3, coulomb_torque=loss)
    rows[1, model.slot("pivot", "soft_time")] = lead
    rows[1, model.slot("pivot", "soft_inertia")] = held
    sticks, soft, again = model.simulate(rows, np.full((3, 1), 0.6), np.zeros((3, 1)), time)[0][:, :, 0]
    assert np.abs(soft - reference).max() < 1e-6
    assert np.abs(sticks - reference).max() > 1e-2
    np.testing.assert_array_equal(sticks, again)


def test_soft_friction_against_its_equation_located():
    # τ_f = J (v̇ + v / T), within ± L: it turns round within a ten thousandth of a second, between the stages of a step.
    model, copies = LaneModel(oscillator()), 16
    rng = np.random.default_rng(8)
    level, lead, held = (np.exp(0.1 * rng.normal(size=copies)) * typical for typical in (0.01, 0.006, 0.02))
    time = np.linspace(0.0, 6.0, 301)
    rows = rows_with(model, copies, coulomb_torque=level, soft_time=lead, soft_inertia=held)
    ours = model.simulate(rows, np.ones((copies, 1)), np.zeros((copies, 1)), time)[0][:, :, 0]
    errors = []
    for k in range(copies):
        L, T, J = level[k], lead[k], held[k]

        def acceleration(y, slips, L=L, T=T, J=J):
            return (-0.5 * y[0] - slips * L) / 0.02 if slips else (-0.5 * y[0] - J * y[1] / T) / (0.02 + J)

        def pull(y, slips, T=T, J=J, acceleration=acceleration):
            return J * (acceleration(y, slips) + y[1] / T)

        reference = piecewise(
            lambda slips, f=acceleration: lambda t, y: [y[1], f(y, slips)],
            lambda slips, p=pull, L=L: (
                [falling(lambda t, y: slips * p(y, slips) - L)]
                if slips
                else [rising(lambda t, y, s=s: s * p(y, 0) - L) for s in (1, -1)]
            ),
            lambda slips, which, t, y: (0 if slips else (1, -1)[which], y),
            np.array([1.0, 0.0]),
            time,
            0 if abs(pull(np.array([1.0, 0.0]), 0)) < L else -1,
        )
        errors.append(np.sqrt(np.mean((ours[k] - reference[:, 0]) ** 2)))
    # Estimated without regard to the kinks, errors were 5e-10 in the middle and 1e-8 at worst; with it they are 1e-11 and 1e-9.
    assert np.median(errors) < 1e-10
    assert np.max(errors) < 1e-8


def test_dahl_friction_against_its_equation():
    model = LaneModel(oscillator())
    torque, stiffness = 0.02, 1.3
    time = np.linspace(0.0, 8.0, 401)
    ours = model.simulate(rows_with(model, dahl_torque=torque, dahl_stiffness=stiffness), [1.0], [0.0], time)[0][
        0, :, 0
    ]

    def f(t, y):
        q, v, z = y
        return [v, (-0.5 * q - stiffness * z) / 0.02, v - abs(v) * stiffness * z / torque]

    reference = solve_ivp(f, (0, 8), [1.0, 0.0, 0.0], "DOP853", t_eval=time, rtol=1e-10, atol=1e-12, max_step=2e-3).y[0]
    assert np.abs(ours - reference).max() < 2e-7


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_end_stop_pushes_and_never_pulls(side):
    model = LaneModel(oscillator())
    angle, stiffness, damping = 0.4, 300.0, 0.2
    time = np.linspace(0.0, 8.0, 801)
    rows = rows_with(model, stop_angle=side * angle, stop_stiffness=stiffness, stop_damping=damping)
    ours = model.simulate(rows, [-0.9 * side], [0.0], time)[0][0, :, 0] * side

    def push(y):
        return stiffness * (y[0] - angle) + damping * y[1]

    reference = piecewise(
        lambda on: lambda t, y: [y[1], (-0.5 * y[0] - on * push(y)) / 0.02],
        lambda on: [
            (falling if on else rising)(lambda t, y: min(y[0] - angle, push(y))),
        ],
        lambda on, which, t, y: (1 - on, y + 1e-13 * np.array([y[1], 0.0])),
        np.array([-0.9, 0.0]),
        time,
        0,
    )[:, 0]
    assert np.abs(ours - reference).max() < 1e-7


@pytest.mark.parametrize("rest", [-0.6, 0.8], ids=["struck", "leant on"])
def test_a_stop_with_inertia_against_mujocos_joint_limit(rest):
    # MuJoCo's limits as they are by default, but for an impedance that does not depend on the depth.
    angle, impedance, step = 0.4, 0.95, 1e-5
    flat = MASS * LENGTH**2 / 12.0
    xml = f"""<mujoco><compiler angle="radian"/><option timestep="{step}" integrator="RK4"/><worldbody><body>
      <joint name="pivot" axis="0 1 0" range="-9 {angle}" limited="true" solimplimit="{impedance} {impedance} 0.001"
        stiffness="1" springref="{rest}"/>
      <inertial pos="0 0 {-LENGTH / 2}" mass="{MASS}" diaginertia="{flat} {flat} 1e-9"/></body></worldbody></mujoco>"""
    theirs = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(theirs)
    data.qpos[:] = -2.0
    time = np.arange(0.0, 2.0, 0.02)
    reference = np.empty(time.size)
    for k in range(time.size):
        reference[k] = data.qpos[0]
        mujoco.mj_step(theirs, data, nstep=round(0.02 / step))
    model = LaneModel(pendulum())
    # MuJoCo's documentation, solver parameters: b = 2 / (dmax timeconst), k = 1 / (dmax timeconst)^2, and its inertia.
    inertia = impedance / (1.0 - impedance) / theirs.dof_invweight0[0]
    rows = rows_with(
        model, stop_angle=angle, stop_inertia=inertia, stop_damping=inertia * 2.0 / (impedance * 0.02),
        stop_stiffness=inertia * impedance / (impedance * 0.02) ** 2, stiffness=1.0, rest_angle=rest,
    )  # fmt: skip
    ours = model.simulate(rows, [-2.0], [0.0], time)[0][0, :, 0]
    # MuJoCo steps over the blow, which is a jump of the force: an error of first order (4e-4 at steps of 0.04 ms).
    assert np.abs(ours - reference).max() < 2e-4
    # Without the inertia it is another stop.
    rows[:, model.slot("pivot", "stop_inertia")] = 0.0
    other = np.abs(model.simulate(rows, [-2.0], [0.0], time)[0][0, :, 0] - reference).max()
    assert other > 5e-3


def test_a_stop_without_damping_keeps_the_energy():
    model = LaneModel(oscillator())
    time = np.linspace(0.0, 16.0, 2001)
    position, velocity, _ = model.simulate(rows_with(model, stop_angle=0.4, stop_stiffness=300.0), [-0.9], [0.0], time)
    energy = 0.01 * velocity**2 + 0.25 * position**2 + 150.0 * np.maximum(position - 0.4, 0.0) ** 2
    assert np.abs(energy / energy[0, 0] - 1.0).max() < 1e-7


def test_springs_constant_torque_cogging_and_shaking_against_their_equation():
    model = LaneModel(pendulum())
    time = np.sort(np.random.default_rng(3).uniform(0.0, 10.0, 400))
    rows = rows_with(
        model, stiffness=0.05, rest_angle=0.3, cubic_stiffness=0.02, constant_torque=0.03, cogging_amplitude=0.01,
        cogging_periods=7.0, cogging_phase=0.4,
    )  # fmt: skip
    rows[:, model.slot("base", "excitation_amplitude")] = 1.7
    rows[:, model.slot("base", "excitation_frequency")] = 3.1
    rows[:, model.slot("base", "excitation_phase")] = 0.6
    ours, velocity, acceleration = (x[0, :, 0] for x in model.simulate(rows, [1.0], [0.5], time))

    def f(t, y):
        q, v = y
        base = 1.7 * np.sin(2 * np.pi * 3.1 * t + 0.6)
        # The centre of mass lies at (−sin q, 0, −cos q) l / 2; the pin moves along x.
        weight = -MASS * LENGTH / 2 * (G * np.sin(q) - base * np.cos(q))
        law = -0.05 * (q - 0.3) - 0.02 * q**3 + 0.03 + 0.01 * np.sin(7 * q + 0.4)
        return [v, (weight + law) / INERTIA]

    reference = solve_ivp(f, (time[0], time[-1]), [1.0, 0.5], "DOP853", t_eval=time, rtol=1e-12, atol=1e-12)
    assert np.abs(ours - reference.y[0]).max() < 1e-7
    assert np.abs(velocity - reference.y[1]).max() < 1e-6
    exact = np.array([f(t, y)[1] for t, y in zip(time, reference.y.T, strict=True)])
    assert np.abs(acceleration - exact).max() < 1e-4


def double_pendulum() -> System:
    """Two uniform rods in the x-z plane."""
    upper = Link("upper", mass=1.0, com=constant([0, 0, -0.15]), inertia=constant(np.diag([0.01, 0.01, 1e-4])))
    lower = Link("lower", mass=0.5, com=constant([0, 0, -0.2]), inertia=constant(np.diag([0.006, 0.006, 1e-4])))
    shoulder = Joint("shoulder", JointType.REVOLUTE, "base", "upper", axis=constant([0, 1, 0]))
    elbow = Joint("elbow", JointType.REVOLUTE, "upper", "lower", xyz=constant([0, 0, -0.3]), axis=constant([0, 1, 0]))
    return System("double pendulum", (shoulder, elbow), (upper, lower))


def double_pendulum_terms(q):
    """Mass matrix and gravity of the two rods, from the textbook."""
    a, b, l1 = 0.15, 0.2, 0.3
    c = np.cos(q[1])
    m22 = 0.006 + 0.5 * b * b
    m12 = m22 + 0.5 * l1 * b * c
    m11 = 0.01 + a * a + 0.5 * l1 * l1 + m22 + 2 * 0.5 * l1 * b * c
    gravity = np.array(
        [(1.0 * a + 0.5 * l1) * G * np.sin(q[0]) + 0.5 * b * G * np.sin(q[0] + q[1]), 0.5 * b * G * np.sin(q[0] + q[1])]
    )
    return np.array([[m11, m12], [m12, m22]]), gravity, 0.5 * l1 * b * np.sin(q[1])


def test_an_elbow_that_sticks_and_slips_while_the_shoulder_swings():
    friction = 0.35
    model = LaneModel(double_pendulum())
    time = np.linspace(0.0, 6.0, 301)
    ours = model.simulate(rows_with(model, elbow__coulomb_torque=friction), [1.3, 0.4], [0.0, 0.0], time)[0][0]

    def forces(y):
        m, g, h = double_pendulum_terms(y[:2])
        v1, v2 = y[2:]
        return m, -g - np.array([-h * (2 * v1 * v2 + v2 * v2), h * v1 * v1])

    def held(y):
        m, f = forces(y)
        return f[0] / m[0, 0], m[1, 0] * f[0] / m[0, 0] - f[1]

    def move(mode):
        def f(t, y):
            if mode == 0:
                return [y[2], 0.0, held(y)[0], 0.0]
            m, force = forces(y)
            force[1] -= mode * friction
            return [y[2], y[3], *np.linalg.solve(m, force)]

        return f

    def gates(mode):
        if mode == 0:
            return [rising(lambda t, y: abs(held(y)[1]) - friction * (1 + 1e-9))]
        return [falling(lambda t, y: mode * y[3])]

    def switch(mode, which, t, y):
        y = np.array([y[0], y[1], y[2], 0.0])
        need = held(y)[1]
        if mode != 0 and abs(need) <= friction:
            return 0, y
        return -np.sign(need), y

    reference = piecewise(move, gates, switch, np.array([1.3, 0.4, 0.0, 0.0]), time, 0 if abs(
        held(np.array([1.3, 0.4, 0, 0]))[1]) <= friction else -np.sign(held(np.array([1.3, 0.4, 0, 0]))[1]))  # fmt: skip
    assert np.ptp(reference[:, 1]) > 0.05  # it does slip
    assert np.mean(np.diff(reference[:, 1]) == 0.0) > 0.1  # and stick
    assert np.abs(ours - reference[:, :2]).max() < 1e-6


def test_joints_that_turn_round_one_just_before_the_other_lose_what_friction_takes():
    # Friction takes torque times way and nothing else; a turn that is overlooked would stop the joint and lose its energy.
    friction, starts = 0.02, np.random.default_rng(5).uniform(-1.2, 1.2, (48, 2))
    model = LaneModel(double_pendulum())
    rows = rows_with(model, len(starts), shoulder__coulomb_torque=friction, elbow__coulomb_torque=friction)
    time = np.linspace(0.0, 4.0, 4001)
    q, v, _ = model.simulate(rows, starts, np.zeros((len(starts), 2)), time)

    def energy(q, v):
        height = -(0.15 + 0.5 * 0.3) * np.cos(q[0]) - 0.5 * 0.2 * np.cos(q[0] + q[1])
        return 0.5 * v @ double_pendulum_terms(q)[0] @ v + G * height

    for lane in range(len(starts)):
        lost = energy(q[lane, 0], v[lane, 0]) - energy(q[lane, -1], v[lane, -1])
        # Between samples the way is a parabola; where it turns round within one, at most a quarter of a (dt)² is missed.
        way = np.abs(np.diff(q[lane], axis=0)).sum()
        assert lost == pytest.approx(friction * way, abs=2e-5), starts[lane]


def test_viscous_and_quadratic_damping_against_mujoco():
    # MuJoCo: damping="a b c" is −(a v + b v|v| + c v³), exact under RK4.
    xml = """<mujoco><option integrator="RK4" timestep="0.0002" gravity="0 0 -9.81"><flag contact="disable"/></option>
    <worldbody><body><joint name="shoulder" axis="0 1 0" damping="0.02 0.01 0"/>
    <inertial pos="0 0 -0.15" mass="1" diaginertia="0.01 0.01 0.0001"/>
    <body pos="0 0 -0.3"><joint name="elbow" axis="0 1 0" damping="0.01 0.02 0"/>
    <inertial pos="0 0 -0.2" mass="0.5" diaginertia="0.006 0.006 0.0001"/></body></body></worldbody></mujoco>"""
    theirs = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(theirs)
    data.qpos[:] = [1.6, -0.8]
    reference = []
    for k in range(15001):
        if k % 250 == 0:
            reference.append(data.qpos.copy())
        mujoco.mj_step(theirs, data)
    model = LaneModel(double_pendulum())
    rows = rows_with(
        model, shoulder__damping=0.02, shoulder__quadratic_drag=0.01, elbow__damping=0.01, elbow__quadratic_drag=0.02
    )
    ours = model.simulate(rows, [1.6, -0.8], [0.0, 0.0], np.arange(61) * 0.05)[0][0]
    assert np.abs(ours - np.array(reference)).max() < 1e-6


def test_energy_and_its_loss_balance_on_a_general_chain():
    from harness.denoc import Denoc

    system = random_chain(4, seed=11, prismatic=0.0)
    model = LaneModel(system)
    native = Denoc(system)
    time = np.linspace(0.0, 4.0, 81)
    start = np.array([0.3, -0.2, 0.4, 0.1])
    position, velocity, _ = model.simulate(model.row(), start, [0.0] * 4, time)
    energy = [sum(native.energy(q, v)) for q, v in zip(position[0], velocity[0], strict=True)]
    assert np.ptp(energy) < 1e-7 * max(1.0, abs(energy[0]))


@pytest.mark.parametrize("seed", range(6))
def test_accelerations_on_random_mechanisms_against_pinocchio(seed):
    import pinocchio as pin

    make = random_tree if seed % 2 else random_chain
    system = make(8, seed=seed, prismatic=0.3, armature=True, damping=True, fixed=0.3)
    theirs, _ = pinocchio_tree(system)
    data = theirs.createData()
    model = LaneModel(system)
    rng = np.random.default_rng(seed)
    q, v, tau = (rng.normal(size=(11, model.n)) for _ in range(3))
    effort = np.repeat(tau[:, None], 2, axis=1)
    ours = model.simulate(model.row(), q, v, np.array([0.0, 1e-9]), tau=effort)[2][:, 0]
    damping = np.array([joint.damping for joint in system.movable_joints])
    reference = np.array([pin.aba(theirs, data, *x[:2], x[2] - damping * x[1]) for x in zip(q, v, tau, strict=True)])
    assert np.abs(ours - reference).max() < 1e-11 * np.abs(reference).max()


def test_many_turns_away_the_motion_is_the_same():
    # 1591 whole turns, |q| ≈ 1e4 rad; the angle itself is only known to its own rounding, 2e-12.
    model = LaneModel(pendulum())
    far = 1591 * 2 * np.pi
    time = np.linspace(0.0, 5.0, 101)
    near = model.simulate(model.row(), [1.0], [0.0], time)[0]
    away = model.simulate(model.row(), [1.0 + far], [0.0], time)[0]
    assert np.abs(away - far - near).max() < 1e-8


def test_a_lane_does_not_depend_on_its_neighbours_or_threads():
    model = LaneModel(double_pendulum())
    rng = np.random.default_rng(5)
    copies = 27
    scales = {
        "damping": 0.02, "coulomb_torque": 0.1, "static_torque": 0.15, "stribeck_velocity": 0.1, "quadratic_drag": 0.02,
        "mu_radius": 0.01, "dahl_torque": 0.05, "dahl_stiffness": 2.0, "cogging_amplitude": 0.1, "cogging_periods": 7.0,
        "stop_angle": 1.5, "stop_stiffness": 100.0, "stop_damping": 0.5,
    }  # fmt: skip
    drawn = {
        f"{joint}__{name}": rng.uniform(0, scale, copies) * (rng.random(copies) < 0.5)
        for joint in model.names
        for name, scale in scales.items()
    }
    rows = rows_with(model, copies, **drawn)
    rows[::3, model.slot("base", "excitation_amplitude")] = 2.0
    rows[:, model.slot("base", "excitation_frequency")] = 3.0
    q0 = rng.uniform(-2, 2, (copies, 2))
    time = np.sort(rng.uniform(0, 2, 120))
    for tau in (None, np.sin(3 * time)[:, None] * [1.0, 0.3]):
        together = model.simulate(rows, q0, [0.0, 0.0], time, tau=tau)
        order = rng.permutation(copies)
        shuffled = model.simulate(rows[order], q0[order], [0.0, 0.0], time, tau=tau, threads=2)
        alone = model.simulate(rows[5], q0[5], [0.0, 0.0], time, tau=tau)
        for whole, mixed, single in zip(together, shuffled, alone, strict=True):
            assert np.all(np.isfinite(whole))
            assert np.array_equal(whole[order], mixed)
            assert np.array_equal(whole[5], single[0])


def test_sampling_does_not_change_the_motion():
    model = LaneModel(pendulum())
    rows = rows_with(model, coulomb_torque=0.01)
    fine = np.linspace(0.0, 10.0, 2001)
    some = np.sort(np.random.default_rng(1).choice(fine[1:-1], 60, replace=False))
    some = np.concatenate([[0.0], some, [10.0]])
    dense = model.simulate(rows, [1.2], [0.0], fine)
    sparse = model.simulate(rows, [1.2], [0.0], some)
    pick = np.searchsorted(fine, some)
    for a, b in zip(dense, sparse, strict=True):
        assert np.array_equal(a[:, pick], b)


def test_effort_held_and_straight_between_samples():
    # I θ̈ = τ(t), closed forms of a staircase and of a ramp.
    model = LaneModel(oscillator(stiffness=0.0))
    time = np.array([0.0, 0.5, 0.8, 1.6])
    tau = np.array([[0.02], [-0.04], [0.06], [0.0]])
    held = model.simulate(model.row(), [0.0], [0.0], time, tau=tau, hold="zero")
    straight = model.simulate(model.row(), [0.0], [0.0], time, tau=tau)
    v = q = w = p = 0.0
    for k, dt in enumerate(np.diff(time)):
        a, b = tau[k, 0] / 0.02, tau[k + 1, 0] / 0.02
        q, v = q + v * dt + a * dt**2 / 2, v + a * dt
        p, w = p + w * dt + a * dt**2 / 2 + (b - a) * dt**2 / 6, w + (a + b) / 2 * dt
        assert held[0][0, k + 1, 0] == pytest.approx(q, abs=1e-12)
        assert held[1][0, k + 1, 0] == pytest.approx(v, abs=1e-12)
        assert straight[0][0, k + 1, 0] == pytest.approx(p, abs=1e-12)
        assert straight[1][0, k + 1, 0] == pytest.approx(w, abs=1e-12)


def test_a_point_mass_adds_to_the_slots_linearly():
    plain, heavy = pendulum(), pendulum()
    tip, m = np.array([0.0, 0.0, -LENGTH]), 0.02
    model = LaneModel(plain)
    rod = heavy.links[0]
    total = rod.mass + m
    com = (rod.mass * rod.com + m * tip) / total

    def about_com(mass, r):
        d = r - com
        return mass * (d @ d * np.eye(3) - np.outer(d, d))

    inertia = rod.inertia + about_com(rod.mass, rod.com) + about_com(m, tip)
    heavy = heavy.replace_link(Link("rod", mass=total, com=constant(com), inertia=constant(inertia)))
    row = model.row()
    row[model.slot("rod", "mass")] += m
    row[model.slot("rod", "first_z")] += m * tip[2]
    row[model.slot("rod", "inertia_xx")] += m * tip[2] ** 2
    row[model.slot("rod", "inertia_yy")] += m * tip[2] ** 2
    assert np.allclose(row, model.row(heavy), rtol=0, atol=1e-15)


def test_the_users_own_law():
    from numba import njit

    @njit
    def law(q, qd, t, p):
        return -p[0] * qd**3 - p[1] * np.sin(q) + p[2] * t

    model = LaneModel(oscillator(), law=law)
    time = np.linspace(0.0, 5.0, 101)
    rows = rows_with(model, 2, user_scale=[1.0, 0.0], user_1=1e-3, user_2=0.3, user_3=0.01)
    ours = model.simulate(rows, [1.0], [0.0], time)[0]
    reference = solve_ivp(
        lambda t, y: [y[1], (-0.5 * y[0] - 1e-3 * y[1] ** 3 - 0.3 * np.sin(y[0]) + 0.01 * t) / 0.02],
        (0, 5), [1.0, 0.0], "DOP853", t_eval=time, rtol=1e-12, atol=1e-12,
    ).y[0]  # fmt: skip
    assert np.abs(ours[0, :, 0] - reference).max() < 1e-7
    assert np.abs(ours[1, :, 0] - np.cos(5 * time)).max() < 1e-7


def test_impossible_copies_are_nan_and_leave_the_others_alone():
    model = LaneModel(pendulum())
    rows = np.tile(model.row(), (3, 1))
    rows[1, model.slot("rod", "inertia_yy")] = np.nan
    time = np.linspace(0.0, 1.0, 11)
    position = model.simulate(rows, [1.0], [0.0], time)[0]
    assert np.all(np.isnan(position[1, 1:]))
    assert np.all(np.isfinite(position[[0, 2]]))
    assert np.array_equal(position[0], position[2])


def test_what_does_not_fit_is_named():
    model = LaneModel(pendulum())
    row, time = model.row(), np.linspace(0, 1, 5)
    with pytest.raises(InputError, match="no site 'elbow'"):
        model.slot("elbow", "damping")
    with pytest.raises(InputError, match="no parameter 'dampning'"):
        model.slot("pivot", "dampning")
    with pytest.raises(InputError, match="rows has shape"):
        model.simulate(row[:-1], [0.0], [0.0], time)
    with pytest.raises(InputError, match="do not increase"):
        model.simulate(row, [0.0], [0.0], time[::-1])
    with pytest.raises(InputError, match="tau has shape"):
        model.simulate(row, [0.0], [0.0], time, tau=np.zeros((4, 1)))
    with pytest.raises(InputError, match="not the joints"):
        model.row(double_pendulum())
    with pytest.raises(UnsupportedError, match="two planes"):
        LaneModel(random_chain(2, flexible=1.0, bending2=True))


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("threads", [1, 2])
def test_copies_followed_for_unequally_long_are_those_followed_alone(driven, threads):
    # Bit for bit: a copy depends on no other, and its last step ends at its own last time.
    model = LaneModel(random_chain(3, seed=4))
    copies, time = 19, np.linspace(0.0, 2.0, 201)
    rng = np.random.default_rng(3)
    rows = rows_with(model, copies, damping=0.02)
    rows[:, model.slot(model.names[1], "coulomb_torque")] = rng.uniform(0.0, 0.3, copies)
    q, qd = rng.uniform(-1.0, 1.0, (2, copies, 3))
    tau = np.cumsum(rng.normal(size=(copies, len(time), 3)), axis=1) * 0.1 if driven else None
    counts = rng.integers(1, len(time) + 1, copies)
    counts[:2] = 1, len(time)
    together = model.simulate(rows, q, qd, time, tau=tau, counts=counts, threads=threads)
    for k, count in enumerate(counts):
        forces = None if tau is None else tau[k, :count]
        alone = model.simulate(rows[k], q[k], qd[k], time[:count], tau=forces)
        for array, wanted in zip(together, alone, strict=True):
            assert np.array_equal(array[k, :count], wanted[0])
            assert np.isnan(array[k, count:]).all()


@pytest.mark.parametrize("counts", [[3, 4], [3, 4, 0], [3, 4, 12]])
def test_counts_that_do_not_fit_are_told(counts):
    model = LaneModel(pendulum())
    with pytest.raises(InputError, match="counts"):
        model.simulate(rows_with(model, 3), np.ones((3, 1)), np.zeros((3, 1)), np.arange(11.0), counts=np.array(counts))


def test_copies_may_share_forces():
    model = LaneModel(random_chain(2, seed=5))
    copies, time = 11, np.linspace(0.0, 0.5, 51)
    rng = np.random.default_rng(8)
    rows, (q, qd) = rows_with(model, copies, damping=0.05), rng.uniform(-1.0, 1.0, (2, copies, 2))
    tau, source = rng.normal(size=(3, len(time), 2)), rng.integers(0, 3, copies)
    for method in ("adaptive", "rk4"):
        shared = model.simulate(rows, q, qd, time, tau=tau, source=source, method=method)
        own = model.simulate(rows, q, qd, time, tau=tau[source], method=method)
        assert all(np.array_equal(a, b) for a, b in zip(shared, own, strict=True))
    for wrong in (source[:-1], np.full(copies, 3), np.full(copies, -1)):
        with pytest.raises(InputError, match="source"):
            model.simulate(rows, q, qd, time, tau=tau, source=wrong)
