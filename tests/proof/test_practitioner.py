"""The practitioner's fit, held against another engine's equations and against numbers that were put in."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.engines.pinocchio import Pinocchio
from harness.proof.peers.afternoon_motion import Law, Motion, mass_and_bias, workspace
from harness.proof.peers.practitioner import Practitioner
from harness.proof.peers.runs import Run
from harness.system.random_systems import random_tree

PENDULUM = """
name = "pendulum"
[[joint]]
name = "pivot"
type = "continuous"
parent = "base"
child = "rod"
axis = [0, 1, 0]
damping = 0.001
[[link]]
name = "rod"
mass = 0.5
com = [0, 0, -0.2]
inertia = [0.004, 0.004, 1e-6]
"""


@pytest.mark.parametrize("seed", range(4))
def test_equations_are_those_of_pinocchio(seed: int) -> None:
    system = random_tree(4, seed, fixed=0.3, armature=True)
    rng = np.random.default_rng(seed)
    q, v = rng.normal(size=(2, 4))
    motion, other = Motion(system), Pinocchio().build(system)
    b = motion.bodies
    matrix, bias = np.empty((4, 4)), np.empty(4)
    mass_and_bias(
        q,
        v,
        b.parent,
        b.rotation,
        b.place,
        b.axis,
        b.slides,
        b.mass,
        b.com,
        b.inertia,
        b.gravity,
        *workspace(4),
        matrix,
        bias,
    )
    np.testing.assert_allclose(matrix + np.diag(b.armature), other.mass_matrix(q), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(bias, other.bias(q, v), rtol=1e-10, atol=1e-10)


def _pendulum(tmp_path) -> harness.System:
    (tmp_path / "model.toml").write_text(PENDULUM)
    return harness.load(tmp_path / "model.toml")


def _truth(time, q0: float, ratio: float, viscous: float, dry: float, drag: float):
    """SciPy's DOP853 along the pendulum's own equation, J = 0.024 kg·m², m g l = 0.981 N·m."""

    def rate(_, y):
        friction = viscous * y[1] + dry * np.tanh(y[1] / 0.01) + drag * y[1] * abs(y[1])
        return [y[1], (-0.5 * 9.81 * 0.2 * np.sin(y[0]) - friction) / (ratio * 0.024)]

    return solve_ivp(rate, (0, time[-1]), [q0, 0.0], "DOP853", time, rtol=1e-10, atol=1e-12).y[0]


def test_one_joint_runs_as_its_equation_says(tmp_path) -> None:
    motion = Motion(_pendulum(tmp_path))
    time = np.arange(0.0, 5.0, 0.01)
    one = np.ones(1)
    law = Law(1.1 * one, 1.0, 2e-3 * one, 5e-3 * one, 1e-3 * one, 0.0 * one, 0.0 * one, 0.01 * one)
    found = motion.run(law, np.array([1.2, 0.0]), time, None)[:, 0]
    # A step may hold the whole reversal of dry friction, 0.19 rad/s² for 2.5 ms at the most: 1e-4 rad over a quarter of a second.
    np.testing.assert_allclose(found, _truth(time, 1.2, 1.1, 2e-3, 5e-3, 1e-3), atol=1e-4)


def test_laws_that_act_are_chosen_and_found(tmp_path) -> None:
    system = _pendulum(tmp_path)
    time = np.arange(0.0, 5.0, 0.01)
    rng = np.random.default_rng(5)
    zero, std = 0.02, 1e-3
    runs = [
        Run(time, (_truth(time, a, 1.03, 0.0, 8e-3, 0.0) + zero + rng.normal(0.0, std, len(time)))[:, None])
        for a in (1.3, -0.9, 0.7)
    ]
    found = Practitioner(system, runs[:2]).choose(runs[2:])
    assert found.laws == ("dry",)
    assert found.heldout == pytest.approx(std, rel=0.1)
    for name, value in (("pivot:inertia", 1.03), ("pivot:dry", 8e-3), ("pivot:zero", zero)):
        assert found.values[name] == pytest.approx(value, abs=4.0 * found.std[name] + 0.01 * value)
