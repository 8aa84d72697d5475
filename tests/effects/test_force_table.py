"""A force over a joint's state as a table: what it does to a motion, and the file that says the same.

Truth: SciPy's integration of a pendulum with a force that a bilinear table holds exactly, f = a + b q + c q̇ + d q q̇.
"""

import numpy as np
from scipy.integrate import solve_ivp

from harness import effects
from harness.effects.force_table import NAME, ForceTable
from harness.system import Attachment, Joint, JointType, Link, System
from harness.system.description import constant

MASS, LENGTH = 0.2, 0.3
A, B, C, D = 0.02, -0.05, -0.004, 0.003
POSITIONS, VELOCITIES = np.linspace(-2.0, 2.0, 9), np.linspace(-15.0, 15.0, 7)


def force(q, qd):
    return A + B * q + C * qd + D * q * qd


def table(*joints):
    values = force(POSITIONS[:, None], VELOCITIES[None])
    many = len(joints)
    first = np.tile([POSITIONS[0], VELOCITIES[0]], (many, 1))
    step = np.tile([POSITIONS[1] - POSITIONS[0], VELOCITIES[1] - VELOCITIES[0]], (many, 1))
    return ForceTable(joints, first, step, np.stack([values * (k + 1) for k in range(many)]))


def pendulum(attachment):
    inertia = constant(np.diag([MASS * LENGTH**2 / 12.0] * 2 + [0.0]))
    joint = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]))
    rod = Link("rod", MASS, constant([0, 0, -LENGTH / 2]), inertia)
    return System("p", (joint,), (rod,), attachments=(attachment,))


def exact(scale):
    def rate(t, y):
        pull = -MASS * 9.81 * LENGTH / 2 * np.sin(y[0])
        return [y[1], (pull + scale * force(*y)) / (MASS * LENGTH**2 / 3)]

    return solve_ivp(rate, (0, 2), [0.5, 0], t_eval=np.linspace(0, 2, 201), rtol=1e-11, atol=1e-12, method="DOP853").y[
        0
    ]


def run(effect, value):
    system = pendulum(Attachment(NAME, "pivot", {"table": value}))
    model = effects.lane_model(system, [effect])
    row = effects.lane_row(model, system, [effect])
    return model.simulate(row, [0.5], [0.0], np.linspace(0.0, 2.0, 201))[0][0, :, 0]


def test_every_joint_has_the_force_of_its_own_table():
    effect = table("pivot", "elbow").effect()
    for number in (0, 1):
        assert np.abs(run(effect, float(number)) - exact(number + 1.0)).max() < 1e-7


def test_the_file_says_the_same(tmp_path):
    """Its numbers are written with nine digits."""
    file = tmp_path / "force.py"
    file.write_text(table("pivot").text(file.name))
    (loaded,) = effects.load_user_effects(file)
    assert loaded.name == NAME
    # What has been loaded is understood wherever a model has it attached.
    system = pendulum(Attachment(NAME, "pivot", {"table": 0.0}))
    model = effects.lane_model(system)
    again = model.simulate(effects.lane_row(model, system), [0.5], [0.0], np.linspace(0.0, 2.0, 201))[0][0, :, 0]
    assert np.abs(again - exact(1.0)).max() < 1e-7
    assert np.abs(run(loaded, 0.0) - exact(1.0)).max() < 1e-7


def test_beyond_the_table_the_force_is_that_of_its_edge():
    law = table("pivot").effect().user.torque
    assert law(9.0, 0.0, 0.0, [0.0]) == force(2.0, 0.0)
    assert law(-9.0, 99.0, 0.0, [0.0]) == force(-2.0, 15.0)
