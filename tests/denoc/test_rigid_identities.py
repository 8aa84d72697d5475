"""Physical identities that hold on any mechanism, on random chains and trees of rigid links."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.denoc import Denoc
from harness.denoc.matrices import denoc_matrices
from harness.system import Joint, JointType, System, random_chain, random_tree

SYSTEMS = [
    random_chain(1, 1, prismatic=0.0),
    random_chain(4, 2, armature=True, damping=True),
    random_chain(9, 3, fixed=0.4, prismatic=0.3, armature=True),
    random_tree(12, 4, fixed=0.3, damping=True),
    random_tree(40, 5, prismatic=0.1),
]


def state(model: Denoc, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-3.0, 3.0, model.n), rng.normal(size=model.n), rng.normal(size=model.n)


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_kinetic_energy_is_the_quadratic_form_of_the_mass_matrix(system: System) -> None:
    model = Denoc(system)
    q, qd, _ = state(model, 0)
    mass = model.mass_matrix(q)
    assert np.array_equal(mass, mass.T)
    assert model.energy(q, qd)[0] == pytest.approx(0.5 * qd @ mass @ qd, rel=1e-13)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_mass_matrix_bias_and_passive_forces_make_up_the_equations_of_motion(system: System) -> None:
    model = Denoc(system)
    q, qd, tau = state(model, 1)
    qdd = model.forward_dynamics(q, qd, tau)
    made_up = model.mass_matrix(q) @ qdd + model.bias(q, qd) - model.passive(q, qd)
    scale = np.abs(model.mass_matrix(q)) @ np.abs(qdd)
    assert np.abs(made_up - tau).max() < 1e-13 * scale.max()
    assert relative(model.inverse_dynamics(q, qd, qdd), made_up) < 1e-11


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_coriolis_matrix_gives_the_bias_and_makes_a_skew_matrix(system: System) -> None:
    model = Denoc(system)
    q, qd, _ = state(model, 2)
    coriolis = model.coriolis_matrix(q, qd)
    assert relative(coriolis @ qd + model.gravity(q), model.bias(q, qd)) < 1e-13
    # Central difference of order 4; its error falls with the fourth power of the step, to 1e-9 here.
    h = 1e-3
    near, far = (model.mass_matrix(q + k * h * qd) - model.mass_matrix(q - k * h * qd) for k in (1, 2))
    rate = (8.0 * near - far) / (12.0 * h)
    passive = rate - 2.0 * coriolis
    scale = np.abs(model.mass_matrix(q)).max() * np.abs(qd).max()
    assert np.abs(passive + passive.T).max() < 1e-8 * scale


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_power_of_forces_and_dampers_is_the_rate_of_energy(system: System) -> None:
    model = Denoc(system)
    q, qd, tau = state(model, 3)
    qdd = model.forward_dynamics(q, qd, tau)
    lost = model.passive(q, qd) - model.passive(q, np.zeros(model.n))
    # d/dt (T + V) along the motion, from its parts: q̇ᵀ(M q̈ + C q̇ + g).
    rate = qd @ (model.mass_matrix(q) @ qdd + model.coriolis_matrix(q, qd) @ qd + model.gravity(q))
    power = qd @ (tau + lost)
    scale = np.abs(qd) @ (np.abs(model.mass_matrix(q)) @ np.abs(qdd))
    assert abs(rate - power) < 1e-12 * scale


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_gravity_is_the_gradient_of_the_potential(system: System) -> None:
    model = Denoc(system)
    q, _, _ = state(model, 4)
    rest = np.zeros(model.n)
    h = 1e-4
    gradient = np.array(
        [(model.energy(q + h * e, rest)[1] - model.energy(q - h * e, rest)[1]) for e in np.eye(model.n)]
    )
    assert relative(gradient / (2.0 * h), model.gravity(q)) < 1e-7


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: s.name)
def test_wrenches_on_links_are_generalized_forces_by_virtual_power(system: System) -> None:
    model = Denoc(system)
    rng = np.random.default_rng(5)
    q, qd, tau = state(model, 5)
    wrenches = rng.normal(size=(len(system.links), 6))
    # Virtual power by moving the link frames a little, both ways.
    h = 1e-6
    forces = np.zeros(model.n)
    for k, e in enumerate(np.eye(model.n)):
        for link, wrench in zip(system.links, wrenches, strict=True):
            turn1, at1 = model.link_pose(q + h * e, link.name)
            turn0, at0 = model.link_pose(q - h * e, link.name)
            spin = (turn1 - turn0) @ (turn1 + turn0).T / 4.0 / h
            omega = np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1]]) / 2.0
            forces[k] += omega @ wrench[:3] + (at1 - at0) / (2.0 * h) @ wrench[3:]
    pushed = model.forward_dynamics(q, qd, tau, wrenches=wrenches)
    assert relative(pushed, model.forward_dynamics(q, qd, tau + forces)) < 1e-7
    # They act in the call that names them only.
    assert relative(model.inverse_dynamics(q, qd, pushed, wrenches=wrenches), tau) < 1e-8
    assert relative(model.inverse_dynamics(q, qd, model.forward_dynamics(q, qd, tau)), tau) < 1e-10


def test_momentum_that_nothing_can_change_is_kept() -> None:
    """Without gravity the base of a z-revolute takes no moment about z, that of an x-slide no force along x."""
    chain = random_chain(3, 7, prismatic=0.0)
    for kind, axis, component in ((JointType.REVOLUTE, (0, 0, 1), 2), (JointType.PRISMATIC, (1, 0, 0), 3)):
        first = Joint("first", kind, "base", chain.links[0].name, axis=np.array(axis, dtype=float))
        system = replace(chain, joints=(first, *chain.joints[1:]), gravity=np.zeros(3))
        model = Denoc(system)
        start, speed = np.array([0.3, -0.4, 1.0]), np.array([0.5, -1.0, 2.0])
        motion = model.simulate(start, speed, np.linspace(0.0, 2.0, 21))
        kept = np.array(
            [model.momentum(q, v)[component] for q, v in zip(motion.position, motion.velocity, strict=True)]
        )
        assert np.abs(kept - kept[0]).max() < 1e-9 * np.abs(kept[0])
        assert np.ptp(motion.velocity[:, 1]) > 0.1


def test_linear_momentum_is_mass_times_the_velocity_of_the_centre_of_mass() -> None:
    system = random_tree(8, 9, fixed=0.3)
    model = Denoc(system)
    q, qd, _ = state(model, 6)
    mass = sum(link.mass for link in system.links)

    def centre(at: np.ndarray) -> np.ndarray:
        total = np.zeros(3)
        for link in system.links:
            turn, place = model.link_pose(at, link.name)
            total += link.mass * (place + turn @ link.com)
        return total / mass

    h = 1e-5
    velocity = (centre(q + h * qd) - centre(q - h * qd)) / (2.0 * h)
    assert relative(model.momentum(q, qd)[3:], mass * velocity) < 1e-8


def test_batches_are_their_rows() -> None:
    model = Denoc(random_tree(6, 2, damping=True))
    rng = np.random.default_rng(8)
    Q, Qd, Tau = rng.normal(size=(3, 11, model.n))
    rows = zip(Q, Qd, Tau, strict=True)
    assert np.allclose(
        model.forward_dynamics_batch(Q, Qd, Tau), [model.forward_dynamics(*row) for row in rows], rtol=1e-12
    )
    rows = zip(Q, Qd, Tau, strict=True)
    assert np.allclose(
        model.inverse_dynamics_batch(Q, Qd, Tau), [model.inverse_dynamics(*row) for row in rows], rtol=1e-12
    )
    assert np.allclose(model.mass_matrix_batch(Q), [model.mass_matrix(q) for q in Q], rtol=1e-12)


@pytest.mark.parametrize("count", [1, 8, 9, 17, 40])
@pytest.mark.parametrize("make", [random_chain, random_tree])
def test_mass_matrix_run_by_run_is_that_of_the_textbook(make: Callable[..., System], count: int) -> None:
    # Runs of eight bodies, and what is left of them at branches and tips.
    system = make(count, 5, prismatic=0.3)
    model = Denoc(system)
    q = np.random.default_rng(count).normal(size=model.n)
    mass, wanted = model.mass_matrix(q), denoc_matrices(system, q).inertia
    size = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    assert (np.abs(mass - wanted) <= 1e-13 * size).all()
    assert np.array_equal(mass, mass.T)
    assert np.array_equal(model.mass_matrix_batch(q[None])[0], mass)


@pytest.mark.parametrize("make", [random_chain, random_tree])
def test_large_mass_matrices_of_many_states_are_those_of_one(make: Callable[..., System]) -> None:
    model = Denoc(make(130, 3, prismatic=0.2))
    q = np.random.default_rng(3).normal(size=(9, 130))
    for mass, row in zip(model.mass_matrix_batch(q), q, strict=True):
        wanted = model.mass_matrix(row)
        size = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
        assert (np.abs(mass - wanted) <= 1e-13 * size).all()
