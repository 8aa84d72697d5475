"""Free, ball, planar, universal, helical and mimicking joints: identities, closed forms, conservation laws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from harness.denoc import Denoc
from harness.denoc.matrices import denoc_matrices
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, JointType, Link, Mimic, System, load, write
from harness.system.description import constant
from harness.system.random_joints import (
    floating_tree,
    following,
    free_of_a_link,
    in_space,
    joint,
    link,
    random_position,
    spinning_freely,
)
from harness.system.rotation import from_quaternion

Build = Callable[[], System]
BOTH = pytest.mark.parametrize("build", [in_space, following])


def test_positions_and_velocities_are_told_apart() -> None:
    system = in_space()
    assert (system.nq, system.nv) == (17, 15)
    assert system.position_names[:7] == ("root.x", "root.y", "root.z", "root.qw", "root.qx", "root.qy", "root.qz")
    assert system.coordinate_names[6:9] == ("hip.wx", "hip.wy", "hip.wz")
    # Mimics have neither: a ball, a screw, a thumb are left.
    assert (following().nq, following().nv) == (6, 5)
    assert Denoc(system).nq == 17 and Denoc(system).n == 15


@BOTH
def test_forward_undoes_inverse_dynamics(build: Build) -> None:
    model, rng = Denoc(build()), np.random.default_rng(3)
    q, v, tau = random_position(build(), rng), rng.standard_normal(model.n), rng.standard_normal(model.n)
    a = model.forward_dynamics(q, v, tau)
    np.testing.assert_allclose(model.inverse_dynamics(q, v, a), tau, atol=1e-12)
    np.testing.assert_allclose(model.mass_matrix(q) @ a + model.bias(q, v) - model.passive(q, v), tau, atol=1e-12)
    # Batches say the same, row by row.
    many = model.forward_dynamics_batch(np.tile(q, (9, 1)), np.tile(v, (9, 1)), np.tile(tau, (9, 1)))
    np.testing.assert_allclose(many, np.tile(a, (9, 1)), atol=1e-12)


def spun_freely() -> System:
    return spinning_freely(in_space())


def hanging_ball() -> System:
    """A ball on the base, whose weight acts whichever way it is turned, with a damper and a slide on it."""
    rng = np.random.default_rng(21)
    joints = (
        joint("ball", JointType.BALL, "base", "a", rng, damping=0.4),
        joint("slide", JointType.PRISMATIC, "a", "b", rng, damping=0.1),
    )
    return System("hanging", joints, (link("a", rng), link("b", rng)))


def askew() -> System:
    """What floats from a place that is turned, with a ball on it."""
    turned = constant(from_quaternion(np.array([0.6, 0.2, -0.5, 0.3])))
    joints = (replace(spun_freely().joints[0], rotation=turned), *spun_freely().joints[1:])
    return replace(spun_freely(), joints=joints)


@pytest.mark.parametrize(
    "build", [in_space, spun_freely, free_of_a_link, hanging_ball, following, floating_tree, askew]
)
def test_many_states_at_once_are_one_after_another(build: Build) -> None:
    system, rng = build(), np.random.default_rng(22)
    model = Denoc(system)
    q = np.array([random_position(system, rng) for _ in range(37)])
    v, a, tau = rng.standard_normal((3, 37, model.n))
    # A third of a turn about y and a quarter: where turns about x, y and z lose a direction.
    for row, angle in ((3, 0.5 * np.pi), (4, 0.5 * np.pi + 1e-9), (5, -0.5 * np.pi)):
        for at in [k for k, name in enumerate(system.position_names) if name.endswith(".qw")]:
            q[row, at : at + 4] = np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0
    for many, one, others in (
        (model.forward_dynamics_batch, model.forward_dynamics, (v, tau)),
        (model.inverse_dynamics_batch, model.inverse_dynamics, (v, a)),
        (model.mass_matrix_batch, model.mass_matrix, ()),
    ):
        expected = np.array([one(*row) for row in zip(q, *others, strict=True)])
        found = many(q, *others)
        # Near the singular place rounding grows by 1 / 0.15²; all else is rounding of double precision.
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
        out = np.full_like(expected, np.nan)
        assert many(q, *others, out=out) is out
        np.testing.assert_array_equal(out, found)


@pytest.mark.parametrize("build", [floating_tree, askew])
def test_what_floats_from_a_turned_place_falls_by_gravity_alone(build: Build) -> None:
    """At rest, without forces and springs, all of it falls by g, which its joint sees in the axes that it is placed in."""
    system = build()
    system = replace(system, joints=tuple(replace(one, stiffness=0.0) for one in system.joints))
    model, rng = Denoc(system), np.random.default_rng(24)
    q = np.array([random_position(system, rng) for _ in range(11)])
    found = model.forward_dynamics_batch(q, np.zeros((11, model.n)))
    fall = np.zeros(model.n)
    fall[:3] = np.asarray(system.joints[0].rotation).T @ np.asarray(system.gravity)
    np.testing.assert_allclose(found, np.tile(fall, (11, 1)), atol=1e-11)


@BOTH
def test_mass_matrix_rate_less_twice_coriolis_is_skew(build: Build) -> None:
    model, rng = Denoc(build()), np.random.default_rng(4)
    q, v = random_position(build(), rng), rng.standard_normal(model.n)
    coriolis = model.coriolis_matrix(q, v)
    np.testing.assert_allclose(coriolis @ v + model.gravity(q), model.bias(q, v), atol=1e-12)
    h = 1e-4
    ahead, behind = (model.mass_matrix(model.integrate(q, s * v)) for s in (h, -h))
    skew = (ahead - behind) / (2.0 * h) - 2.0 * coriolis
    # Central differences of order two: h² times third derivatives.
    np.testing.assert_allclose(skew, -skew.T, atol=1e-6)


def test_matrices_with_motion_subspaces_agree_with_the_recursions() -> None:
    rng = np.random.default_rng(5)
    screw = joint("screw", JointType.HELICAL, "e", "f", rng, pitch=0.2)
    system = in_space()
    system = System(system.name, (*system.joints, screw), (*system.links, link("f", rng)))
    model = Denoc(system)
    for _ in range(3):
        q = random_position(system, rng)
        matrices = denoc_matrices(system, q)
        np.testing.assert_allclose(matrices.inertia, model.mass_matrix(q), atol=1e-12)
        upper, diagonal = matrices.udu()
        np.testing.assert_allclose(upper @ np.diag(diagonal) @ upper.T, model.mass_matrix(q), atol=1e-12)
    with pytest.raises(UnsupportedError, match="'finger' mimics 'thumb'"):
        denoc_matrices(following(), np.zeros(6))


def test_step_and_difference_undo_one_another() -> None:
    system, rng = in_space(), np.random.default_rng(6)
    model = Denoc(system)
    q, step = random_position(system, rng), rng.standard_normal(model.n)
    np.testing.assert_allclose(model.difference(q, model.integrate(q, step)), step, atol=1e-12)
    # The rates of the positions are what a short step does: central difference, error h² over 6.
    h = 1e-4
    rate = (model.integrate(q, h * step) - model.integrate(q, -h * step)) / (2.0 * h)
    np.testing.assert_allclose(model.position_rates(q, step), rate, atol=1e-6)


def body(moments: tuple[float, float, float], gravity: float = 0.0) -> System:
    return System(
        "body",
        (Joint("root", JointType.FREE, "base", "body"),),
        (Link("body", mass=2.0, inertia=constant(np.diag(moments))),),
        gravity=constant([0.0, 0.0, -gravity]),
    )


def test_tumbling_body_against_jacobi_elliptic_functions() -> None:
    """Euler's equations without torque: Landau and Lifshitz, Mechanics, section 37, equations 37.8 to 37.10."""
    i1, i2, i3 = 1.0, 2.0, 3.0
    w = np.array([0.6, 0.0, 1.4])
    twice, square = i1 * w[0] ** 2 + i3 * w[2] ** 2, (i1 * w[0]) ** 2 + (i3 * w[2]) ** 2
    assert square > twice * i2
    rate = np.sqrt((i3 - i2) * (square - twice * i1) / (i1 * i2 * i3))
    parameter = (i2 - i1) * (twice * i3 - square) / ((i3 - i2) * (square - twice * i1))
    time = np.linspace(0.0, 4.0 * float(ellipk(parameter)) / rate, 41)
    sn, cn, dn, _ = ellipj(rate * time, parameter)
    expected = np.column_stack(
        [
            np.sqrt((twice * i3 - square) / (i1 * (i3 - i1))) * cn,
            np.sqrt((twice * i3 - square) / (i2 * (i3 - i2))) * sn,
            np.sqrt((square - twice * i1) / (i3 * (i3 - i1))) * dn,
        ]
    )
    model = Denoc(body((i1, i2, i3)))
    start = model.integrate(model.neutral, [0.1, 0.2, 0.3, 0.4, -1.0, 0.7])
    run = model.simulate(start, [0.0, 0.0, 0.0, *w], time, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(run.velocity[:, 3:], expected, atol=1e-10)
    # Angular momentum stands still in space, which no angle of the body does: the orientation is right too.
    turns = [from_quaternion(q[3:]) for q in run.position]
    momentum = np.array([turn @ (np.array([i1, i2, i3]) * v[3:]) for turn, v in zip(turns, run.velocity, strict=True)])
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(time), 1)), atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(run.position[:, 3:], axis=1), 1.0, atol=1e-15)


def chain() -> System:
    """Four links thrown as one: a free joint, a ball, a revolute and a universal joint; nothing damps or springs."""
    rng = np.random.default_rng(8)
    joints = (
        Joint("root", JointType.FREE, "base", "a"),
        joint("ball", JointType.BALL, "a", "b", rng),
        joint("knee", JointType.REVOLUTE, "b", "c", rng),
        joint("cardan", JointType.UNIVERSAL, "c", "d", rng),
    )
    return System("chain", joints, tuple(link(name, rng) for name in "abcd"))


def centre(model: Denoc, q: np.ndarray) -> np.ndarray:
    total, moment = 0.0, np.zeros(3)
    for part in model.system.links:
        turn, place = model.link_pose(q, part.name)
        total += part.mass
        moment += part.mass * (place + turn @ part.com)
    return moment / total


@pytest.mark.parametrize("method", ["dop853", "rk4"])
def test_centre_of_mass_of_a_thrown_chain_falls_on_a_parabola(method: str) -> None:
    system = chain()
    model, rng = Denoc(system), np.random.default_rng(9)
    q, v = random_position(system, rng), rng.standard_normal(model.n)
    time = np.linspace(0.0, 1.0, 6)
    run = model.simulate(q, v, time, method=method, rtol=1e-13, atol=1e-14)
    mass = sum(part.mass for part in system.links)
    speed = model.momentum(q, v)[3:] / mass
    allowed = 1e-11 if method == "dop853" else 1e-8
    for t, x in zip(time, run.position, strict=True):
        fall = centre(model, q) + speed * t + 0.5 * np.asarray(system.gravity) * t * t
        np.testing.assert_allclose(centre(model, x), fall, atol=allowed)
    assert run.energy is not None
    np.testing.assert_allclose(run.energy, run.energy[0], atol=100.0 * allowed)


def test_momentum_of_a_chain_in_space_is_kept() -> None:
    system = chain()
    system = System(system.name, system.joints, system.links, gravity=constant(np.zeros(3)))
    model, rng = Denoc(system), np.random.default_rng(10)
    q, v = random_position(system, rng), rng.standard_normal(model.n)
    run = model.simulate(q, v, np.linspace(0.0, 1.0, 6), rtol=1e-13, atol=1e-15)
    momenta = np.array([model.momentum(x, w) for x, w in zip(run.position, run.velocity, strict=True)])
    np.testing.assert_allclose(momenta, np.tile(momenta[0], (6, 1)), atol=1e-12 * np.abs(momenta).max())


def test_screw_turns_weight_into_turning() -> None:
    """A nut on a vertical screw: (I + m p²) θ̈ = -m g p, a constant; the same by mimic of a slide."""
    mass, inertia, pitch, g = 2.0, 0.05, 0.1, 9.81
    nut = Link("nut", mass=mass, inertia=constant(np.diag([0.04, 0.04, inertia])))
    helical = System("screw", (Joint("screw", JointType.HELICAL, "base", "nut", pitch=pitch),), (nut,))
    turn = Joint("screw", JointType.REVOLUTE, "base", "sleeve")
    slide = Joint("slide", JointType.PRISMATIC, "sleeve", "nut", mimic=Mimic("screw", pitch))
    mimicking = System("screw", (turn, slide), (Link("sleeve"), nut))
    expected = -mass * g * pitch / (inertia + mass * pitch**2)
    for system in (helical, mimicking):
        model = Denoc(system)
        assert model.names == ("screw",)
        assert model.forward_dynamics([0.3], [2.0])[0] == pytest.approx(expected, rel=1e-13)
        time = np.linspace(0.0, 1.0, 5)
        run = model.simulate([0.0], [0.0], time)
        np.testing.assert_allclose(run.position[:, 0], 0.5 * expected * time**2, atol=1e-12)


def test_dry_friction_of_a_follower_is_felt_where_it_is_led() -> None:
    """A slide with friction F that follows a wheel by r brakes it with F r: it stops after I w / (F r)."""
    turn = Joint("wheel", JointType.REVOLUTE, "base", "wheel", axis=constant([0.0, 0.0, 1.0]))
    slide = Joint("rack", JointType.PRISMATIC, "base", "rack", friction=3.0, mimic=Mimic("wheel", 0.1))
    links = (Link("wheel", mass=1.0, inertia=constant(0.2 * np.eye(3))), Link("rack"))
    axis = Joint("rack", slide.type, "base", "rack", axis=constant([1.0, 0.0, 0.0]), friction=3.0, mimic=slide.mimic)
    run = Denoc(System("rack", (turn, axis), links)).simulate([0.0], [1.5], np.linspace(0.0, 2.0, 201))
    stop = 0.2 * 1.5 / 0.3
    before = run.time < stop
    np.testing.assert_allclose(run.velocity[before, 0], 1.5 * (1.0 - run.time[before] / stop), atol=1e-9)
    assert np.all(run.velocity[~before, 0] == 0.0)


def test_unusable_positions_are_refused_in_one_line() -> None:
    model = Denoc(in_space())
    q = model.neutral
    q[3] = 0.0
    with pytest.raises(InputError, match=r"quaternion of joint 'root', q\[3\] to q\[6\], has length zero"):
        model.forward_dynamics(q, np.zeros(15))
    with pytest.raises(InputError, match=r"q has shape \(15,\), the system has 17 positions \(nq = 17 .* nv = 15"):
        model.forward_dynamics(np.zeros(15), np.zeros(15))
    with pytest.raises(InputError, match=r"qd has shape \(17,\), the system has 15 velocities"):
        model.forward_dynamics(model.neutral, np.zeros(17))
    with pytest.raises(InputError, match="joint 'finger' mimics 'thumb', which"):
        Denoc(System("x", (following().joint("finger"),), (following().link("c"),), base="a"))
    rng = np.random.default_rng(0)
    circle = tuple(joint(a, JointType.REVOLUTE, "base", b, rng, mimic=Mimic(b)) for a, b in (("p", "q"), ("q", "p")))
    with pytest.raises(InputError, match="p → q → p mimic one another in a circle"):
        Denoc(System("x", circle, (link("q", rng), link("p", rng))))


@pytest.mark.parametrize("ending", ["toml", "urdf", "xml"])
@BOTH
def test_written_and_read_again_it_is_the_same_mechanism(build: Build, ending: str, tmp_path: Path) -> None:
    system = build()
    path = tmp_path / f"model.{ending}"
    if ending == "urdf":
        with pytest.raises(UnsupportedError, match="is of type ball, which URDF has not"):
            write(system, path)
        ball = next(joint for joint in system.joints if joint.type is JointType.BALL)
        system = system.replace_joint(replace(ball, type=JointType.REVOLUTE))
    left_out = write(system, path)
    again = load(path)
    assert sorted(again.coordinate_names) == sorted(system.coordinate_names)
    if ending == "toml":
        assert [joint.type for joint in again.joints] == [joint.type for joint in system.joints]
    if any("armature" in line for line in left_out):
        system = replace(system, joints=tuple(replace(j, armature=0.0) for j in system.joints))
    q = random_position(system, np.random.default_rng(15))
    theirs = np.array([q[system.position_names.index(name)] for name in again.position_names])
    order = [again.coordinate_names.index(name) for name in system.coordinate_names]
    mass = Denoc(again).mass_matrix(theirs)[np.ix_(order, order)]
    np.testing.assert_allclose(mass, Denoc(system).mass_matrix(q), atol=1e-12)


def test_lanes_refuse_what_they_do_not_know() -> None:
    from harness.denoc.lanes.model import LaneModel

    with pytest.raises(UnsupportedError, match="joint 'root' is of type free, which a computation of many copies"):
        LaneModel(in_space())
