"""Short chains whose accelerations are computed all bodies at once: where that is done, and that it changes nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.denoc import Denoc
from harness.denoc.matrices import denoc_matrices
from harness.errors import InputError
from harness.system import System, random_chain, random_tree
from harness.system.description import constant

CHAINS = [random_chain(n, 40 + n, prismatic=0.0, fixed=0.3, armature=n % 2 == 0, damping=True) for n in range(4, 9)]


def at_once(model: Denoc) -> bool:
    """Whether a model's accelerations are computed all bodies at once."""
    return model.forward_address != model.recursion_address


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def sprung(system: System) -> System:
    """The same with springs, gravity askew, and far from the base."""
    joints = [replace(j, stiffness=0.7, rest_position=0.3) if j.movable else j for j in system.joints]
    joints[0] = replace(joints[0], xyz=constant([3e3, -1e3, 2e3]))
    return replace(system, joints=tuple(joints), gravity=constant([1.0, -3.0, -9.0]))


@pytest.mark.parametrize("system", CHAINS, ids=lambda s: s.name)
@pytest.mark.parametrize("size", [1.0, 9e3], ids=["near", "far turned"])
def test_accelerations_solve_the_equations_of_the_textbooks_matrices(system: System, size: float) -> None:
    model = Denoc(sprung(system))
    assert at_once(model)
    rng = np.random.default_rng([7, model.n])
    for _ in range(10):
        q, qd, tau = rng.uniform(-size, size, model.n), rng.normal(size=model.n), rng.normal(size=model.n)
        force = tau + model.passive(q, qd) - model.bias(q, qd)
        expected = np.linalg.solve(denoc_matrices(model.system, q).inertia, force)
        assert relative(model.forward_dynamics(q, qd, tau), expected) < 1e-11


def test_what_does_not_fit_is_left_to_the_recursion() -> None:
    few, many = random_chain(3, 1, prismatic=0.0), random_chain(9, 1, prismatic=0.0)
    tree, slide = random_tree(6, 5), random_chain(6, 2, prismatic=1.0)
    bends = random_chain(5, 3, prismatic=0.0, flexible=1.0)
    assert not any(at_once(Denoc(system)) for system in (few, many, tree, slide, bends))


def test_a_small_body_far_out_is_left_to_the_recursion() -> None:
    system = random_chain(5, 8, prismatic=0.0)
    small = replace(system.links[-1], inertia=constant(1e-7 * np.eye(3)), com=constant(np.zeros(3)))
    assert at_once(Denoc(system))
    assert not at_once(Denoc(system.replace_link(small)))


def test_beyond_the_angles_it_is_made_for_the_recursion_has_its_turn() -> None:
    model = Denoc(CHAINS[0])
    q, qd, tau = np.full(model.n, 0.3), np.full(model.n, 0.2), np.zeros(model.n)
    whole = 2.0 * np.pi * 1e5
    q[1] += whole
    found = model.forward_dynamics(q, qd, tau)
    q[1] -= whole
    # 6e5 rad are known to 1e-10.
    assert relative(found, model.forward_dynamics(q, qd, tau)) < 1e-8


def test_external_wrenches_act() -> None:
    model = Denoc(CHAINS[2])
    rng = np.random.default_rng(3)
    q, qd, qdd = rng.normal(size=(3, model.n))
    wrenches = rng.normal(size=(len(model.system.links), 6))
    tau = model.inverse_dynamics(q, qd, qdd, wrenches)
    assert relative(model.forward_dynamics(q, qd, tau, wrenches), qdd) < 1e-11
    assert at_once(model)
    assert relative(model.forward_dynamics(q, qd, model.inverse_dynamics(q, qd, qdd)), qdd) < 1e-11


@pytest.mark.parametrize("count", [3, 5], ids=["by the recursion", "at once"])
def test_the_joint_that_moves_no_inertia_is_named(count: int) -> None:
    system = random_chain(count, 9, prismatic=0.0)
    nothing = replace(system.links[-1], mass=0.0, inertia=constant(np.zeros((3, 3))))
    model = Denoc(system.replace_link(nothing))
    with pytest.raises(InputError, match=system.joints[-1].name):
        model.forward_dynamics(np.zeros(count), np.zeros(count))


def test_dry_friction_holds_a_chain_where_it_stands() -> None:
    """Joints that rest are locked while the motion is integrated."""
    system = random_chain(4, 6, prismatic=0.0, armature=True)
    needed = np.abs(Denoc(system).gravity(np.full(4, 0.4)))
    stiff = replace(
        system, joints=tuple(replace(j, friction=1.1 * f) for j, f in zip(system.joints, needed, strict=True))
    )
    model = Denoc(stiff)
    assert at_once(model)
    held = model.simulate(np.full(4, 0.4), np.zeros(4), np.linspace(0.0, 0.5, 6))
    assert np.array_equal(held.position, np.full((6, 4), 0.4))
    loose = Denoc(system).simulate(np.full(4, 0.4), np.zeros(4), np.linspace(0.0, 0.5, 6))
    assert np.abs(loose.position[-1] - 0.4).max() > 0.1
