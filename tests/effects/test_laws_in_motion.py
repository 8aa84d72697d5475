"""Effects put into the lanes, held against equations of motion written down here and integrated by SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness import effects
from harness.errors import InputError
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant

MASS, LENGTH, GRAVITY = 0.2, 0.3, 9.81
INERTIA, MOMENT = MASS * LENGTH**2 / 3.0, MASS * GRAVITY * LENGTH / 2.0
TIME = np.linspace(0.0, 3.0, 301)


@pytest.fixture
def pendulum():
    inertia = np.diag([MASS * LENGTH**2 / 12.0] * 2 + [0.0])
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    return System("pendulum", (joint,), (Link("rod", MASS, constant([0, 0, -LENGTH / 2]), constant(inertia)),))


def released(system, start):
    model = effects.lane_model(system)
    states = np.zeros(model.n)
    states[model.names.index("pivot")] = start
    position, _, _ = model.simulate(effects.lane_row(model, system), states, np.zeros(model.n), TIME)
    return position[0]


def truth(torque, start, inertia=INERTIA, moment=MOMENT):
    def rate(t, y):
        return [y[1], (-moment * np.sin(y[0]) + torque(t, y[0], y[1])) / inertia]

    return solve_ivp(rate, (0.0, TIME[-1]), [start, 0.0], t_eval=TIME, rtol=1e-11, atol=1e-12, method="DOP853").y[0]


SMOOTH = {
    "viscous_damping": ({"coefficient": 2e-3}, lambda t, q, v: -2e-3 * v),
    "quadratic_drag": ({"coefficient": 3e-4}, lambda t, q, v: -3e-4 * v * abs(v)),
    "joint_stiffness": ({"stiffness": 0.05, "rest_angle": 0.3}, lambda t, q, v: -0.05 * (q - 0.3)),
    "cubic_stiffness": ({"stiffness": 0.02}, lambda t, q, v: -0.02 * q**3),
    "constant_torque": ({"torque": 0.01}, lambda t, q, v: 0.01),
    "cogging_torque": ({"amplitude": 0.01, "periods": 7.0, "phase": 0.4}, lambda t, q, v: 0.01 * np.sin(7 * q + 0.4)),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_joint_laws(pendulum, name):
    parameters, torque = SMOOTH[name]
    system = effects.apply(pendulum, Attachment(name, "pivot", parameters))
    assert np.abs(released(system, 1.2)[:, 0] - truth(torque, 1.2)).max() < 1e-7


def test_dry_friction_takes_the_same_from_every_half_swing(pendulum):
    # Energy between turning points a and b: m g r (cos b − cos a) = T (a + b), so b is known from a in closed form.
    friction = 0.004
    system = effects.apply(pendulum, Attachment("coulomb_friction", "pivot", {"torque": friction}))
    motion = released(system, 1.0)[:, 0]
    from scipy.optimize import brentq

    turn = brentq(lambda b: MOMENT * (np.cos(b) - 1.0 * np.cos(1.0)) - friction * (1.0 + b), 0.5, 1.0)
    # The lowest sample lies within half an interval of the turning point.
    reach = 0.5 * (MOMENT / INERTIA) * (0.5 * (TIME[1] - TIME[0])) ** 2
    assert -turn - 1e-7 <= motion.min() <= -turn + reach


def test_base_excitation_acts_sideways(pendulum):
    parameters = {"amplitude": 0.4, "frequency": 1.7, "phase": 0.6}
    system = effects.apply(pendulum, Attachment("base_excitation", "base", parameters))

    def torque(t, q, v):
        # axis × down = −x; a base that accelerates by −a along x acts on the mass as the force F = +m a along x;
        # its torque about y at r = (−sin q, 0, −cos q) l/2 is r_z F.
        a = 0.4 * np.sin(2 * np.pi * 1.7 * t + 0.6)
        return (-np.cos(q) * LENGTH / 2) * (MASS * a)

    assert np.abs(released(system, 0.5)[:, 0] - truth(torque, 0.5)).max() < 1e-7


@pytest.mark.parametrize(
    ("effect", "site", "parameters", "inertia", "moment"),
    [
        ("payload_mass", "rod", {"mass": 0.05}, INERTIA + 0.05 * LENGTH**2, MOMENT + 0.05 * GRAVITY * LENGTH),
        ("added_inertia", "pivot", {"inertia": 5e-4}, INERTIA + 5e-4, MOMENT),
        (
            "com_offset",
            "rod",
            {"offset": 0.01},
            MASS * LENGTH**2 / 12 + MASS * (LENGTH / 2 + 0.01) ** 2,
            MASS * GRAVITY * (LENGTH / 2 + 0.01),
        ),
    ],
)
def test_inertia_effects(pendulum, effect, site, parameters, inertia, moment):
    system = effects.apply(pendulum, Attachment(effect, site, parameters))
    expected = truth(lambda t, q, v: 0.0, 1.2, inertia, moment)
    assert np.abs(released(system, 1.2)[:, 0] - expected).max() < 1e-7


def test_tilt_shifts_the_whole_motion(pendulum):
    system = effects.apply(pendulum, Attachment("base_tilt", "base", {"angle": 0.1}))
    assert np.abs(released(system, 1.0)[:, 0] - (truth(lambda t, q, v: 0.0, 1.1) - 0.1)).max() < 1e-7


def test_compliant_base(pendulum):
    parameters = {"stiffness": 800.0, "mass": 0.5, "damping": 3.0}
    system = effects.apply(pendulum, Attachment("base_compliance", "base", parameters))
    motion = released(system, 1.0)
    c = LENGTH / 2.0

    def rate(t, y):
        # Lagrange: x along axis × down, centre of mass at x + c sin q; (M + m) ẍ + m c cos q q̈ − m c sin q q̇² + k x + d ẋ
        # = 0, J q̈ + m c cos q ẍ + m g c sin q = 0.
        x, q, v, w = y
        mass = np.array([[0.5 + MASS, MASS * c * np.cos(q)], [MASS * c * np.cos(q), INERTIA]])
        force = [MASS * c * np.sin(q) * w * w - 800.0 * x - 3.0 * v, -MOMENT * np.sin(q)]
        return [v, w, *np.linalg.solve(mass, force)]

    expected = solve_ivp(rate, (0, TIME[-1]), [0, 1.0, 0, 0], t_eval=TIME, rtol=1e-11, atol=1e-12, method="DOP853").y
    assert np.abs(motion[:, 0] - expected[0]).max() < 1e-7
    assert np.abs(motion[:, 1] - expected[1]).max() < 1e-7


def test_flexible_joint_and_backlash(pendulum):
    """Drive side of inertia I and link of inertia J on a coupling: two equations of motion."""
    from dataclasses import replace

    drive = 2e-4
    geared = pendulum.replace_joint(replace(pendulum.joint("pivot"), armature=drive, damping=1e-3))

    def expected(coupling):
        def rate(t, y):
            motor, twist, v, w = y
            torque = coupling(twist, w)  # on the link, against the drive side
            link = (-MOMENT * np.sin(motor + twist) + torque) / INERTIA
            first = (-torque - 1e-3 * v) / drive
            return [v, w, first, link - first]

        return solve_ivp(rate, (0, TIME[-1]), [0.7, 0, 0, 0], t_eval=TIME, rtol=1e-10, atol=1e-12, max_step=2e-3).y[0]

    soft = effects.apply(geared, Attachment("joint_flexibility", "pivot", {"stiffness": 2.0, "damping": 0.004}))
    motion = released(soft, 0.7)[:, 0]
    assert np.abs(motion - expected(lambda twist, w: -2.0 * twist - 0.004 * w)).max() < 1e-6

    def contact(stiffness, damping):
        def torque(twist, w):
            beyond = abs(twist) - 0.02
            if beyond <= 0:
                return 0.0
            side = np.sign(twist)
            # Damping sets in over half a hundredth of half the play.
            share = min(beyond / (0.005 * 0.02), 1.0)
            return -side * max(stiffness * beyond + damping * share * side * w, 0.0)

        return torque

    play = Attachment("backlash", "pivot", {"gap": 0.04})
    loose = effects.apply(geared, play)
    teeth = loose.attachments[0].parameters
    motion = released(loose, 0.7)[:, 0]
    # Blow upon blow of stiff teeth magnifies step errors somewhat.
    assert np.abs(motion - expected(contact(teeth["stiffness"], teeth["damping"]))).max() < 1e-7

    # Both at one joint, in either order: the spring takes over where the play ends.
    spring = Attachment("joint_flexibility", "pivot", {"stiffness": 2.0, "damping": 0.004})
    for both in (effects.apply(soft, play), effects.apply(loose, spring)):
        assert both.joint_names == soft.joint_names
        assert np.abs(released(both, 0.7)[:, 0] - expected(contact(2.0, 0.004))).max() < 1e-6


def test_a_link_made_flexible_rings_at_its_frequency(pendulum):
    """Free joint, no gravity, small bend: one damped oscillator of the stated frequency and ratio."""
    from dataclasses import replace

    weightless = replace(pendulum, gravity=constant([0.0, 0.0, 0.0]))
    parameters = {"frequency": 20.0, "damping_ratio": 0.01}
    system = effects.apply(weightless, Attachment("link_flexibility", "rod", parameters))
    model = effects.lane_model(system)
    mode = model.names.index("rod.mode1")
    start = np.zeros(model.n)
    start[mode] = 1e-5
    time = np.linspace(0.0, 1.0, 501)
    bend = model.simulate(effects.lane_row(model, system), start, np.zeros(model.n), time)[0][0, :, mode] / 1e-5
    # b̈ + 2 ζ ω ḃ + ω² b = 0 from rest.
    omega, ratio = 2 * np.pi * 20.0, 0.01
    damped = omega * np.sqrt(1 - ratio**2)
    expected = np.exp(-ratio * omega * time) * (np.cos(damped * time) + ratio * omega / damped * np.sin(damped * time))
    assert np.abs(bend - expected).max() < 1e-5


def test_an_added_mode_has_its_frequency(pendulum):
    from dataclasses import replace

    from harness.effects.bending import mounted_frequency

    bent = effects.apply(pendulum, Attachment("link_flexibility", "rod", {"frequency": 20.0, "damping_ratio": 0.01}))
    link = bent.link("rod")
    # One mode of beam theory; the two shapes of the effect itself are samples, which nothing can be added to.
    plain = replace(link.beam, shapes="auto", shape_samples=None, modes=1, modal_damping=(0.01,), material_damping=0.0)
    system = bent.replace_link(replace(link, beam=plain))
    with pytest.raises(InputError, match="samples"):
        effects.apply(bent, Attachment("higher_mode", "rod", {"frequency": 55.0, "damping_ratio": 0.02}))
    richer = effects.apply(system, Attachment("higher_mode", "rod", {"frequency": 55.0, "damping_ratio": 0.02}))
    assert mounted_frequency(richer, "rod", 0) == pytest.approx(20.0, rel=0.03)  # two shapes bend a little more freely
    assert mounted_frequency(richer, "rod", 1) == pytest.approx(55.0, rel=1e-3)
    assert richer.link("rod").beam.modal_damping == (0.01, 0.02)


def test_rigidity_scales_the_frequency_by_its_root(pendulum):
    from harness.effects.bending import mounted_frequency

    system = effects.apply(pendulum, Attachment("link_flexibility", "rod", {"frequency": 20.0, "damping_ratio": 0.01}))
    stiffer = effects.apply(system, Attachment("flexural_rigidity", "rod", {"factor": 1.44}))
    assert mounted_frequency(stiffer, "rod") == pytest.approx(24.0, rel=1e-9)
    assert effects.apply(system, Attachment("modal_damping", "rod", {"damping_ratio": 0.2})).link(
        "rod"
    ).beam.modal_damping == (0.2, 0.2)
