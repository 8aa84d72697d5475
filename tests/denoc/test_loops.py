"""Closed loops against the whole matrix of masses and conditions, identities, and motions known without loops."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.cases.loop_mechanisms import bricard, governor, slider_crank, squeezer, squeezer_start
from harness.compare.four_bars import four_bars
from harness.denoc.loops.closed import Closed
from harness.denoc.loops.tables import COLUMNS
from harness.errors import InputError, UnsupportedError
from harness.system import Coupling, Frame, Joint, JointType, Link, Loop, System
from harness.system.closure import closed_position, opening, rank, usual_rank
from harness.system.description import constant
from harness.system.kinematics import mass_matrix, poses
from harness.system.lowering import lower
from harness.system.manifold import integrate
from harness.system.random_joints import following, in_space

KINDS = {
    "ball": ("x", "y", "z"),
    "revolute": ("x", "y", "z", "rx", "rz"),
    "universal": ("x", "y", "z", "rz"),
    "slot": ("x", "y"),
    "slider": ("y", "z", "rx", "ry", "rz"),
    "weld": ("x", "y", "z", "rx", "ry", "rz"),
    "parallel": ("rx", "ry"),
}


def looped(system: System, closed: tuple[str, ...], first: str = "c", second: str = "e", seed: int = 0) -> System:
    """The system with a loop between two links that is closed at a random position."""
    rng = np.random.default_rng(seed)
    q = integrate(system, closed_position(system), rng.standard_normal(system.nv))
    at = poses(lower(system), q)
    one, other = at[first].at(0.2 * rng.standard_normal(3), np.eye(3)), at[second]
    place = other.rotation.T @ (one.origin - other.origin)
    frames = (
        Frame(first, constant(at[first].rotation.T @ (one.origin - at[first].origin)), constant(np.eye(3))),
        Frame(second, constant(place), constant(other.rotation.T @ one.rotation)),
    )
    return replace(system, loops=(Loop("ring", *frames, closed),))


def state(model, seed: int = 1):
    rng = np.random.default_rng(seed)
    q = model.assemble(model.integrate(model.neutral, rng.standard_normal(model.n)))
    return q, model.closed_velocity(q, rng.standard_normal(model.n)), rng.standard_normal(model.n)


def by_whole_matrix(model, q, qd, tau):
    """M a + bias = tau + passive + Jᵀ λ, J a = −J̇ q̇, J from NumPy's kinematics and J̇ by differences along the motion."""
    system = model.system
    tree = harness.Denoc(replace(system, loops=()))
    jacobian = opening(system, q).jacobian
    step = 1e-5
    ahead, behind = (opening(system, integrate(system, q, sign * step * qd)).jacobian for sign in (1.0, -1.0))
    asked = -(ahead - behind) @ qd / (2.0 * step)
    c, n = jacobian.shape
    whole = np.block([[tree.mass_matrix(q), -jacobian.T], [jacobian, np.zeros((c, c))]])
    forces = -tree.inverse_dynamics(q, qd, np.zeros(n)) + tau
    return np.linalg.lstsq(whole, np.concatenate([forces, asked]), rcond=1e-11)[0]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("make", [in_space, following])
def test_accelerations_are_those_of_the_whole_matrix(make, kind):
    """Free, ball, planar and universal joints by the factors of the recursion; helical and mimicking ones column by column."""
    tree = make()
    names = [link.name for link in tree.links]
    system = looped(tree, KINDS[kind], names[-2], names[-1] if make is following else "c")
    if system.nv <= usual_rank(system, closed_position(system)):
        pytest.skip("nothing is left to move")
    model = harness.Denoc(system)
    assert bool(model._places[COLUMNS]) == (make is following)
    q, qd, tau = state(model)
    np.testing.assert_allclose(model.open_by(q), 0.0, atol=1e-13)
    np.testing.assert_allclose(model.loop_jacobian(q) @ qd, 0.0, atol=1e-13)
    found = model.forward_dynamics(q, qd, tau)
    whole = by_whole_matrix(model, q, qd, tau)
    np.testing.assert_allclose(found, whole[: model.n], rtol=1e-7, atol=1e-7 * np.abs(found).max())
    # What the least generalized forces, and constraint forces, make of it.
    least = model.inverse_dynamics(q, qd, found)
    np.testing.assert_allclose(model.forward_dynamics(q, qd, least), found, rtol=1e-9, atol=1e-9 * np.abs(found).max())
    assert np.linalg.norm(least) <= np.linalg.norm(tau) * (1.0 + 1e-9)
    forces = model.constraint_forces(q, qd, tau)
    tree_model = harness.Denoc(replace(system, loops=()))
    driven = tau + model.loop_jacobian(q).T @ forces
    np.testing.assert_allclose(
        tree_model.forward_dynamics(q, qd, driven), found, rtol=1e-8, atol=1e-8 * np.abs(found).max()
    )


def test_factors_and_columns_agree_and_the_jacobian_is_numpys():
    model = harness.Denoc(looped(in_space(), KINDS["revolute"], "c", "d"))
    q, qd, tau = state(model)
    by_factors = model.forward_dynamics(q, qd, tau).copy()
    np.testing.assert_allclose(model.loop_jacobian(q), opening(model.system, q).jacobian, rtol=1e-11, atol=1e-12)
    model._places[COLUMNS] = 1
    np.testing.assert_allclose(model.forward_dynamics(q, qd, tau), by_factors, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(
        mass_matrix(model.system, q), model.mass_matrix(q), rtol=1e-11, atol=1e-11 * np.abs(model.mass_matrix(q)).max()
    )


def test_a_floating_ring_keeps_momentum_and_energy():
    """In free flight constraint forces are inner forces: they change neither momentum, nor energy without damping."""
    tree = replace(in_space(), gravity=constant(np.zeros(3)))
    still = tuple(replace(joint, damping=0.0, armature=0.0) for joint in tree.joints)
    model = harness.Denoc(looped(replace(tree, joints=still), KINDS["ball"], "c", "d"))
    q, qd, _ = state(model)
    run = model.simulate(q, 0.5 * qd, np.linspace(0.0, 2.0, 21), rtol=1e-11, atol=1e-13)
    momenta = np.array([model.momentum(*pair) for pair in zip(run.position, run.velocity, strict=True)])
    np.testing.assert_allclose(momenta, np.tile(momenta[0], (21, 1)), atol=1e-8 * np.abs(momenta).max())
    assert np.ptp(run.energy) < 1e-8 * np.abs(run.energy).max()
    assert max(np.abs(model.open_by(x)).max() for x in run.position) < 1e-12


def test_a_parallelogram_rubs_as_the_pendulum_that_it_is():
    """Dry friction and damping at a passive joint of a loop: all turn as the crank does, so that damping adds up."""
    rubbing, damping = 1.8, 0.2
    window = four_bars(1)
    joints = (replace(j, friction=rubbing * (j.name == "knee0"), damping=damping) for j in window.joints)
    window = replace(window, joints=tuple(joints))
    body = Link(
        "body", mass=3.0, com=constant([0.0, 2.0 / 3.0, 0.0]), inertia=constant(np.eye(3) * (5.0 / 3.0 - 4.0 / 3.0))
    )
    # Inertia about the hinge (N+1)/3 + N = 5/3, moment of weight (N+1)/2 + N = 2 of 3 kg: 2/3 m away.
    hinge = Joint(
        "hinge", JointType.REVOLUTE, "base", "body", axis=constant([0, 0, 1]), friction=rubbing, damping=3 * damping
    )
    pendulum = harness.Denoc(System("one", (hinge,), (body,), gravity=window.gravity))
    model = harness.Denoc(window)
    q = model.assemble(np.array([2.2, 2.2, -2.2]), held=["crank0"])
    time = np.linspace(0.0, 8.0, 161)
    ours = model.simulate(q, np.zeros(3), time)
    theirs = pendulum.simulate([2.2], [0.0], time)
    np.testing.assert_allclose(ours.position[:, 0], theirs.position[:, 0], atol=2e-7)
    # They have come to rest, and stay where friction holds them.
    assert np.abs(theirs.velocity[-1]).max() < 1e-20
    np.testing.assert_allclose(ours.velocity[-1], 0.0, atol=1e-12)


@pytest.mark.parametrize("windows", [3, 40])
def test_four_bars_side_by_side_fall_as_the_pendulum_that_they_are(windows):
    """With inertia (N+1)/3 + N and moment of weight (N+1)/2 + N from upright; cuts of many loops have little in common."""
    model = harness.Denoc(four_bars(windows))
    q = np.array([0.7 if name.startswith("crank") else -0.7 for name in model.names])
    qd = np.array([0.9 if name.startswith("crank") else -0.9 for name in model.names])
    assert np.abs(model.open_by(q)).max() < 1e-14
    expected = 9.81 * np.sin(0.7) * ((windows + 1) / 2 + windows) / ((windows + 1) / 3 + windows)
    signs = np.array([1.0 if name.startswith("crank") else -1.0 for name in model.names])
    np.testing.assert_allclose(model.forward_dynamics(q, qd), expected * signs, rtol=1e-12)


def test_dry_friction_at_several_joints_is_refused():
    window = four_bars(1)
    model = harness.Denoc(replace(window, joints=tuple(replace(j, friction=0.1) for j in window.joints)))
    with pytest.raises(UnsupportedError, match=r"dry friction at several joints \(crank0, crank1, knee0\)"):
        model.simulate(np.zeros(3), np.zeros(3), [0.0, 1.0])


def test_squeezer_begins_as_published():
    """Accelerations in Hairer and Wanner's table to thirty digits; the spring is a massless strut."""
    model = harness.Denoc(squeezer())
    assert model._places[COLUMNS]
    tau = np.where(np.array(model.names) == "beta", 0.033, 0.0)
    found = dict(
        zip(model.names, model.forward_dynamics(squeezer_start(model.names), np.zeros(model.n), tau), strict=True)
    )
    assert found["beta"] == pytest.approx(14222.4439199541138705911625887, rel=1e-12)
    assert found["theta"] == pytest.approx(-10666.8329399655854029433719415, rel=1e-12)


def test_actuated_joints_alone_make_a_motion_or_are_refused():
    model = Closed(slider_crank())
    q = model.assemble(np.array([0.7, 0.0, 0.0]), held=["crank"])
    qd = model.closed_velocity(q, np.array([3.0, 0.0, 0.0]))
    moved = model.forward_dynamics(q, qd, np.array([0.4, 0.1, -0.2]))
    for name in model.names:
        tau = model.inverse_dynamics(q, qd, moved, actuated=[name])
        assert np.count_nonzero(tau) <= 1
        np.testing.assert_allclose(model.forward_dynamics(q, qd, tau), moved, rtol=1e-9, atol=1e-9)
    with pytest.raises(InputError, match="qdd opens loop 'wrist'"):
        model.inverse_dynamics(q, qd, moved + np.array([1.0, 0.0, 0.0]))
    weak = Closed(governor())
    q = weak.assemble(np.array([0.0, -0.5, -0.5, 1.0, 0.5, -1.0]), held=["right_arm"])
    moved = weak.forward_dynamics(q, np.zeros(6), np.array([0.3, 0.2, 0.1, 0.0, 0.0, 0.0]))
    with pytest.raises(InputError, match="spindle alone cannot make these accelerations"):
        weak.inverse_dynamics(q, np.zeros(6), moved, actuated=["spindle"])


def test_bricard_moves_though_it_counts_as_held():
    system = bricard()
    q = closed_position(system)
    assert (rank(system, q), opening(system, q).jacobian.shape) == (4, (5, 5))
    model = harness.Denoc(system)
    moved = model.forward_dynamics(q, np.zeros(5))
    whole = by_whole_matrix(model, q, np.zeros(5), np.zeros(5))
    np.testing.assert_allclose(moved, whole[:5], rtol=1e-9, atol=1e-9)
    # Of all constraint forces that make it, the least.
    assert np.linalg.norm(model.constraint_forces(q, np.zeros(5))) <= np.linalg.norm(whole[5:]) * (1.0 + 1e-9)


def test_couplings_hold_and_curve():
    """A joint as the square of another: one coordinate with an inertia that grows, whose energy is kept."""
    joints = tuple(Joint(name, JointType.REVOLUTE, "base", f"{name}_disc") for name in "ab")
    discs = tuple(Link(f"{name}_disc", 1.0, inertia=constant(np.eye(3) * 0.5)) for name in "ab")
    system = System("gear", joints, discs, loops=(Coupling("square", "b", "a", (0.1, 0.5, 1.5, 0.0, 0.0)),))
    model = harness.Denoc(system)
    q = model.assemble(np.array([0.4, 0.0]), held=["a"])
    assert q[1] == pytest.approx(0.1 + 0.2 + 0.24, rel=1e-14)
    qd = model.closed_velocity(q, np.array([1.0, 0.0]))
    slope, bend = 0.5 + 3.0 * 0.4, 3.0
    assert qd[1] == pytest.approx(slope * qd[0], rel=1e-14)
    # ½ (1 + s²) ȧ² of discs of 0.5 kg m²: ä (1 + s²) = −s s′ ȧ².
    expected = -slope * bend * qd[0] ** 2 / (1.0 + slope**2)
    assert model.forward_dynamics(q, qd)[0] == pytest.approx(expected, rel=1e-13)
    run = model.simulate(q, qd, np.linspace(0.0, 3.0, 31))
    assert np.ptp(run.energy) < 1e-10


def test_open_states_are_refused_in_one_line():
    model = harness.Denoc(slider_crank())
    with pytest.raises(InputError, match=r"q0 leaves loop 'wrist' open .*model\.assemble"):
        model.simulate([0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0])
    q = model.assemble(np.array([0.5, 0.0, 0.0]), held=["crank"])
    with pytest.raises(InputError, match=r"qd0 opens loop 'wrist' .*closed_velocity"):
        model.simulate(q, [1.0, 0.0, 0.0], [0.0, 1.0])
    with pytest.raises(InputError, match="with slider as given the loops cannot close"):
        model.assemble(np.array([0.0, 0.0, 9.0]), held=["slider"])
