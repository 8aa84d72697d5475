"""The native dynamics, MuJoCo and Exudyn, built from one description, say what Pinocchio says on general mechanisms.

Allowed differences are rounding: about ten times what the engines' authors' own algorithms differ by (1e-12 relative for
n ≤ 7, 1e-10 for n ≤ 50, 1e-9 above).
"""

from dataclasses import replace

import numpy as np
import pytest

from harness.engines import registry
from harness.engines.protocol import EngineModel
from harness.system import JointType, System
from harness.system.random_systems import random_chain, random_tree

PEERS = ("denoc", "mujoco", "exudyn")


def springy(system: System, seed: int) -> System:
    """Springs with rest positions at every joint, on top of what the random system has."""
    rng = np.random.default_rng(seed)
    joints = tuple(
        replace(joint, stiffness=float(rng.uniform(0.5, 2.0)), rest_position=float(rng.normal()))
        if joint.movable
        else joint
        for joint in system.joints
    )
    return replace(system, joints=joints, gravity=np.array([1.0, -2.0, -9.0]))


def general(n: int, seed: int, tree: bool) -> System:
    make = random_tree if tree else random_chain
    return springy(make(n, seed, armature=True, damping=True, fixed=0.2), seed)


def difference(a: object, b: object) -> float:
    first, second = np.asarray(a), np.asarray(b)
    assert first.shape == second.shape
    return float(np.max(np.abs(first - second)) / np.max(np.abs(first)))


def state(n: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(3, n))


@pytest.mark.parametrize("peer", PEERS)
@pytest.mark.parametrize("tree", [False, True])
@pytest.mark.parametrize(("n", "allowed"), [(1, 1e-12), (2, 1e-12), (7, 1e-12), (30, 1e-10)])
def test_every_quantity(n: int, allowed: float, tree: bool, peer: str) -> None:
    for seed in range(3):
        system = general(n, seed, tree)
        ours, theirs = (registry.engine(name).build(system) for name in ("pinocchio", peer))
        q, qd, qdd = state(n, seed)
        tau = ours.inverse_dynamics(q, qd, qdd)
        assert difference(ours.forward_dynamics(q, qd, tau), qdd) < allowed
        assert difference(qdd, theirs.forward_dynamics(q, qd, tau)) < allowed
        assert difference(tau, theirs.inverse_dynamics(q, qd, qdd)) < allowed
        assert difference(ours.mass_matrix(q), theirs.mass_matrix(q)) < allowed
        assert difference(ours.bias(q, qd), theirs.bias(q, qd)) < allowed
        assert difference(ours.gravity(q), theirs.gravity(q)) < allowed
        if peer != "exudyn":
            assert difference(ours.energy(q, qd), theirs.energy(q, qd)) < allowed


@pytest.mark.parametrize("peer", PEERS)
def test_frequencies(peer: str) -> None:
    # Central differences with one Richardson step leave about 1e-11; the reference is Pinocchio's analytic derivative.
    system = general(6, 3, True)
    q = np.zeros(6)
    ours, theirs = (registry.engine(name).build(system).frequencies(q) for name in ("pinocchio", peer))
    assert len(ours) > 0
    assert difference(ours, theirs) < 1e-9


@pytest.mark.parametrize("peer", PEERS)
def test_same_motion_under_held_forces_and_uneven_samples(peer: str) -> None:
    system = general(4, 5, True)
    rng = np.random.default_rng(5)
    time = np.sort(rng.uniform(0.0, 1.0, 40))
    tau = rng.normal(size=(40, 4))
    q0, qd0, _ = state(4, 6)
    ours, theirs = (
        registry.engine(name).build(system).simulate(q0, qd0, time, tau=tau, step=1e-3) for name in ("pinocchio", peer)
    )
    # The same RK4 with the same steps: only rounding is left.
    assert difference(ours.position, theirs.position) < 1e-11
    assert difference(ours.velocity, theirs.velocity) < 1e-11


def test_same_motion_when_the_step_is_left_to_the_engines() -> None:
    system = general(3, 8, False)
    time = np.linspace(0.0, 2.0, 101)
    q0, qd0, _ = state(3, 8)
    runs = [registry.engine(name).build(system).simulate(q0, qd0, time) for name in ("pinocchio", *PEERS)]
    # Pinocchio's run is DOP853 at 1e-12, the native one adaptive too, the others RK4 at 1 ms: under 1e-8 at a few rad/s.
    for run in runs[1:]:
        assert difference(runs[0].position, run.position) < 1e-8
        assert run.energy is None or difference(runs[0].energy, run.energy) < 1e-7


def test_energy_is_conserved_without_damping() -> None:
    system = springy(random_tree(4, 2, armature=True, fixed=0.3), 2)
    q0, qd0, _ = state(4, 2)
    for name, allowed in (("pinocchio", 1e-10), ("mujoco", 1e-7)):
        energy = registry.engine(name).build(system).simulate(q0, qd0, np.linspace(0.0, 2.0, 21)).energy
        assert energy is not None
        assert np.ptp(energy) < allowed * np.max(np.abs(energy))


def test_links_that_cannot_move_do_not_count_in_the_energy() -> None:
    chain = random_chain(1, 0, prismatic=0.0)
    joint, link = chain.joints[0], chain.links[0]
    place = np.array([0.0, 0.0, 2.0])
    post = replace(joint, name="post", type=JointType.FIXED, parent="base", child="block", xyz=place)
    block = replace(link, name="block", mass=1.0, com=np.zeros(3))
    with_post = replace(chain, joints=(*chain.joints, post), links=(*chain.links, block))
    for name in ("denoc", "pinocchio", "mujoco", "analytic"):
        plain, raised = (registry.engine(name).build(s).energy(np.ones(1), np.ones(1)) for s in (chain, with_post))
        assert raised == pytest.approx(plain, rel=1e-12)


def test_long_chain_in_mujoco_is_its_own_inverse() -> None:
    # XML nesting ends near 500; the identity inverse(forward) needs no other engine. Its error is counted against the
    # forces that cancel: at 1 rad/s a joint the tip moves at 30 m/s, and inertia forces of 1e6 N·m balance.
    n = 600
    model: EngineModel = registry.engine("mujoco").build(random_chain(n, 1, armature=True))
    q, qd, tau = state(n, 1)
    error = model.inverse_dynamics(q, qd, model.forward_dynamics(q, qd, tau)) - tau
    assert np.max(np.abs(error)) < 1e-9 * np.max(np.abs(model.bias(q, qd)))
